// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <rosplane_msgs/msg/controller_commands.hpp>
#include <rosplane_msgs/msg/current_path.hpp>
#include <rosplane_msgs/msg/flight_phase.hpp>
#include <rosplane_msgs/msg/mission_settings.hpp>
#include <rosplane_msgs/msg/state.hpp>
#include <rosplane_msgs/msg/waypoint.hpp>

#include "autonomy/common/angles.hpp"
#include "autonomy/common/geodesy.hpp"
#include "autonomy/fixedwing/guidance.hpp"
#include "rosflight_common/time.hpp"

/// Messages of rosplane_msgs and the structs of autonomy/fixedwing. Messages are single precision,
/// body axes front-right-down, local axes north-east-down; a number that is not known is NaN.
namespace rosplane {

/// Vehicle of rosflight_sim that a node takes if it is given none, as the launch files do.
inline constexpr const char* kUsualVehicle = "anaconda";

namespace autonomy = rosflight::autonomy;

namespace fixedwing = autonomy::fixedwing;

inline constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

inline float single(double value) {
  return static_cast<float>(value);
}
inline double wide(float value) {
  return static_cast<double>(value);
}

/// A state whose attitude is known. The stamp is the caller's.
inline void put(const autonomy::StateEstimate& in, const std::optional<autonomy::Geodetic>& origin,
                rosplane_msgs::msg::State& out) {
  const bool placed = in.horizontal != autonomy::Quality::kNone;
  out.p_n = placed ? single(in.p_W.x()) : kUnknown;
  out.p_e = placed ? single(in.p_W.y()) : kUnknown;
  out.p_d = in.vertical != autonomy::Quality::kNone ? single(in.p_W.z()) : kUnknown;
  const autonomy::Vector3 v_B = in.q_WB.conjugate() * in.v_W;
  out.v_x = single(v_B.x());
  out.v_y = single(v_B.y());
  out.v_z = single(v_B.z());
  out.p = single(in.w_B.x());
  out.q = single(in.w_B.y());
  out.r = single(in.w_B.z());
  const autonomy::RollPitch attitude = autonomy::RollPitch::of(in.q_WB);
  out.phi = single(attitude.roll_rad);
  out.theta = single(attitude.pitch_rad);
  out.psi = single(autonomy::heading_of(in.q_WB));
  out.b_x = single(in.gyro_bias_B.x());
  out.b_y = single(in.gyro_bias_B.y());
  out.b_z = single(in.gyro_bias_B.z());
  out.quat.w = in.q_WB.w();
  out.quat.x = in.q_WB.x();
  out.quat.y = in.q_WB.y();
  out.quat.z = in.q_WB.z();
  if (origin) {
    out.initial_lat = origin->latitude_deg;
    out.initial_lon = origin->longitude_deg;
    out.initial_alt = origin->altitude_m;
  }
  out.w_n = in.wind_valid ? single(in.wind_W.x()) : kUnknown;
  out.w_e = in.wind_valid ? single(in.wind_W.y()) : kUnknown;
  out.va = single(in.airspeed_m_s);
  out.alpha = single(in.alpha_rad);
  out.beta = single(in.beta_rad);
  out.chi = single(in.course_rad);
}

/// The origin of a state; absent while all of it is zero.
inline std::optional<autonomy::Geodetic> origin_of(const rosplane_msgs::msg::State& in) {
  if (in.initial_lat == 0.0 && in.initial_lon == 0.0 && in.initial_alt == 0.0) return {};
  return autonomy::Geodetic{in.initial_lat, in.initial_lon, in.initial_alt};
}

/// States, one after the other. What a message does not carry is made up for: the specific force
/// along the nose follows from the change of the airspeed, and the place stays where it was while
/// it is not known.
class StateReader {
 public:
  /// @param min_airspeed_m_s  below, the airspeed counts as not known.
  StateReader(double min_airspeed_m_s, double gravity_m_s2)
      : min_airspeed_m_s_{min_airspeed_m_s}, gravity_m_s2_{gravity_m_s2} {}

  const autonomy::StateEstimate& read(const rosplane_msgs::msg::State& in) {
    using autonomy::Quality;
    const double t_s = rosflight_common::seconds(in.header);
    const double dt_s = t_s - state_.t_s;
    state_.t_s = t_s;
    const bool placed = std::isfinite(in.p_n) && std::isfinite(in.p_e);
    if (placed) state_.p_W.head<2>() << wide(in.p_n), wide(in.p_e);
    state_.horizontal = placed ? Quality::kGood : Quality::kNone;
    state_.vertical = std::isfinite(in.p_d) ? Quality::kGood : Quality::kNone;
    if (state_.vertical == Quality::kGood) state_.p_W.z() = wide(in.p_d);
    const autonomy::Quaternion q{in.quat.w, in.quat.x, in.quat.y, in.quat.z};
    constexpr double kOff = 0.05;
    const bool turned = std::abs(q.norm() - 1.0) < kOff;  // false for NaN
    state_.attitude = state_.heading = turned ? Quality::kGood : Quality::kNone;
    if (turned) state_.q_WB = q.normalized();
    state_.v_W = state_.q_WB * autonomy::Vector3(wide(in.v_x), wide(in.v_y), wide(in.v_z));
    state_.w_B << wide(in.p), wide(in.q), wide(in.r);
    state_.wind_valid = std::isfinite(in.w_n) && std::isfinite(in.w_e);
    state_.wind_W.setZero();
    if (state_.wind_valid) state_.wind_W.head<2>() << wide(in.w_n), wide(in.w_e);
    const double airspeed_m_s = wide(in.va);
    constexpr double kMaxStep_s = 0.5;
    const bool steady = dt_s > 0.0 && dt_s < kMaxStep_s;
    const double rate = steady ? (airspeed_m_s - state_.airspeed_m_s) / dt_s : 0.0;
    state_.air_valid = airspeed_m_s > min_airspeed_m_s_;
    state_.airspeed_m_s = std::isfinite(airspeed_m_s) ? airspeed_m_s : 0.0;
    state_.a_B.setZero();
    const double pitch_rad = autonomy::RollPitch::of(state_.q_WB).pitch_rad;
    state_.a_B.x() = (std::isfinite(rate) ? rate : 0.0) + gravity_m_s2_ * std::sin(pitch_rad);
    state_.alpha_rad = wide(in.alpha);
    state_.beta_rad = wide(in.beta);
    state_.course_rad = wide(in.chi);
    return state_;
  }
  const autonomy::StateEstimate& state() const { return state_; }

 private:
  double min_airspeed_m_s_;
  double gravity_m_s2_;
  autonomy::StateEstimate state_{};
};

/// Good enough to fly on.
inline bool flyable(const autonomy::StateEstimate& s) {
  return s.attitude != autonomy::Quality::kNone && s.vertical != autonomy::Quality::kNone &&
         std::isfinite(s.p_W.sum() + s.v_W.sum() + s.w_B.sum() + s.course_rad);
}

// ---- path ---------------------------------------------------------------------------------------

inline void put(const autonomy::Vector3& in, std::array<float, 3>& out) {
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = single(in[static_cast<Eigen::Index>(k)]);
}
inline autonomy::Vector3 vector(const std::array<float, 3>& in) {
  return {wide(in[0]), wide(in[1]), wide(in[2])};
}

/// A valid path. On an orbit r and q, which nobody else reads there, tell how it climbs.
inline void put(const fixedwing::CurrentPath& in, const autonomy::Vector3& p_W,
                rosplane_msgs::msg::CurrentPath& out) {
  using Message = rosplane_msgs::msg::CurrentPath;
  out.path_type = in.circle ? Message::ORBIT_PATH : Message::LINE_PATH;
  out.va_d = single(in.airspeed_m_s);
  out.lamda = in.turn > 0 ? Message::CLOCKWISE : Message::COUNT_CLOCKWISE;
  out.rho = single(in.radius_m);
  put(in.c_W, out.c);
  if (!in.circle) {
    put(in.r_W, out.r);
    put(in.q_W, out.q);
    return;
  }
  const fixedwing::Vector2 d = (p_W - in.c_W).head<2>();
  const double polar = fixedwing::course_of(d);
  const double turn = in.turn > 0 ? 1.0 : -1.0;
  autonomy::Vector3 beside = in.c_W;
  beside.head<2>() += in.radius_m * fixedwing::along(polar);
  put(beside, out.r);
  autonomy::Vector3 tangent;
  tangent << fixedwing::along(polar + turn * 0.5 * autonomy::kPi), -in.slope;
  put(tangent.normalized(), out.q);
}

/// Valid if all that its type needs is there.
inline fixedwing::CurrentPath path_of(const rosplane_msgs::msg::CurrentPath& in) {
  fixedwing::CurrentPath out;
  out.circle = in.path_type == rosplane_msgs::msg::CurrentPath::ORBIT_PATH;
  out.airspeed_m_s = wide(in.va_d);
  out.r_W = vector(in.r);
  out.q_W = vector(in.q);
  out.c_W = vector(in.c);
  out.radius_m = wide(in.rho);
  out.turn = in.lamda > 0 ? 1 : -1;
  const double level = out.q_W.head<2>().norm();
  constexpr double kUnit = 1e-3;
  if (out.circle && std::abs(out.q_W.norm() - 1.0) < kUnit && level > kUnit) {
    out.slope = -out.q_W.z() / level;
  }
  const bool known = out.circle || in.path_type == rosplane_msgs::msg::CurrentPath::LINE_PATH;
  const bool finite = out.circle ? out.c_W.allFinite() : out.r_W.allFinite() && out.q_W.allFinite();
  out.valid = known && finite && std::isfinite(out.airspeed_m_s);
  return out;
}

// ---- commands -----------------------------------------------------------------------------------

inline void put(const fixedwing::ControllerCommand& in,
                rosplane_msgs::msg::ControllerCommands& out) {
  out.va_c = single(in.airspeed_m_s);
  out.h_c = single(in.height_m);
  out.chi_c = single(in.course_rad);
  out.phi_ff = single(in.roll_ff_rad);
  out.aux[0] = single(in.climb_ff_m_s);
  out.aux_valid = true;
}

inline fixedwing::ControllerCommand command_of(const rosplane_msgs::msg::ControllerCommands& in) {
  fixedwing::ControllerCommand out;
  out.airspeed_m_s = wide(in.va_c);
  out.height_m = wide(in.h_c);
  out.course_rad = wide(in.chi_c);
  out.roll_ff_rad = wide(in.phi_ff);
  out.climb_ff_m_s = in.aux_valid && std::isfinite(in.aux[0]) ? wide(in.aux[0]) : 0.0;
  out.valid = std::isfinite(out.airspeed_m_s + out.height_m + out.course_rad + out.roll_ff_rad);
  return out;
}

// ---- phase --------------------------------------------------------------------------------------

inline float single(const std::optional<double>& value) {
  return value ? single(*value) : kUnknown;
}
inline std::optional<double> given(float value) {
  return std::isfinite(value) ? std::optional(wide(value)) : std::nullopt;
}

inline void put(const fixedwing::GuidanceOutput& in, rosplane_msgs::msg::FlightPhase& out) {
  out.phase = static_cast<std::uint8_t>(in.phase);
  out.idle = in.act == fixedwing::GuidanceAct::kIdle;
  out.waypoint = static_cast<std::uint16_t>(in.waypoint);
  out.mission_done = in.mission_done;
  out.height_above_ground = single(in.height_above_ground_m);
  out.roll = single(in.direct.roll_rad);
  out.pitch = single(in.direct.pitch_rad);
  out.climb_rate = single(in.direct.climb_m_s);
  out.throttle = single(in.direct.throttle);
  out.ground_course = single(in.direct.ground_course_rad);
  out.glide_airspeed = single(in.direct.airspeed_by_pitch_m_s);
  out.min_pitch = single(in.direct.min_pitch_rad);
  out.max_pitch = single(in.direct.max_pitch_rad);
  out.max_roll = single(in.direct.max_roll_rad);
  out.max_throttle = single(in.direct.max_throttle);
}

inline fixedwing::Controller::Direct direct_of(const rosplane_msgs::msg::FlightPhase& in) {
  fixedwing::Controller::Direct out;
  out.roll_rad = given(in.roll);
  out.pitch_rad = given(in.pitch);
  out.climb_m_s = given(in.climb_rate);
  out.throttle = given(in.throttle);
  out.ground_course_rad = given(in.ground_course);
  out.airspeed_by_pitch_m_s = given(in.glide_airspeed);
  out.min_pitch_rad = given(in.min_pitch).value_or(out.min_pitch_rad);
  out.max_pitch_rad = given(in.max_pitch).value_or(out.max_pitch_rad);
  out.max_roll_rad = given(in.max_roll).value_or(out.max_roll_rad);
  out.max_throttle = given(in.max_throttle).value_or(out.max_throttle);
  return out;
}

// ---- mission ------------------------------------------------------------------------------------

/// How ROSflight's waypoints say it: lines with corners and circles have no words there.
inline void put(const fixedwing::Waypoint& in, rosplane_msgs::msg::Waypoint& out) {
  put(in.p_W, out.w);
  out.lla = false;
  out.use_chi = in.passing == fixedwing::Passing::kDubins;
  out.chi_d = single(in.course_rad);
  out.va_d = single(in.airspeed_m_s);
}

inline fixedwing::Waypoint waypoint_of(const rosplane_msgs::msg::Waypoint& in,
                                       const std::optional<autonomy::Geodetic>& origin) {
  fixedwing::Waypoint out;
  out.p_W = vector(in.w);
  if (in.lla && origin)
    out.p_W = autonomy::ned_of({wide(in.w[0]), wide(in.w[1]), wide(in.w[2])}, *origin);
  out.passing = in.use_chi ? fixedwing::Passing::kDubins : fixedwing::Passing::kFillet;
  out.course_rad = in.use_chi ? wide(in.chi_d) : 0.0;
  out.airspeed_m_s = wide(in.va_d);
  return out;
}

inline void put(const fixedwing::Mission& in, rosplane_msgs::msg::MissionSettings& out) {
  out.at_end = static_cast<std::uint8_t>(in.at_end);
  out.takeoff_height = single(in.takeoff_height_m);
  out.turn_radius = single(in.radius_m);
  put(in.landing.aim_W, out.landing_aim);
  out.landing_course = single(in.landing.course_rad);
}

/// Everything but the waypoints.
inline void take(const rosplane_msgs::msg::MissionSettings& in, fixedwing::Mission& out) {
  constexpr std::uint8_t kLast = static_cast<std::uint8_t>(autonomy::AtEnd::kReturn);
  out.at_end = static_cast<autonomy::AtEnd>(std::min(in.at_end, kLast));
  out.takeoff_height_m = given(in.takeoff_height);
  out.radius_m = given(in.turn_radius);
  out.landing.aim_W = vector(in.landing_aim);
  out.landing.course_rad = given(in.landing_course);
}

}  // namespace rosplane
