// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/flight_manager.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/common/gap_watch.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using fixedwing::along;
using fixedwing::right_of;
using P = Conditions;

constexpr double kWindAverage_s = 3.0;
constexpr double kLead_s = 2.5;
constexpr double kNoWind_m_s = 2.0;    // slower air does not say where the nose belongs
constexpr double kNoseAway_rad = 1.0;  // with the nose further off the speed waits
constexpr double kMaxCorrection_m_s = 4.0;
constexpr double kArrived_m = 1.0;
constexpr double kArrivedSlow_m_s = 0.7;
constexpr double kSettle_s = 2.0;
constexpr double kEndGain_1_s = 0.4;
constexpr double kSpoolUp_s = 0.8;
constexpr double kRests_s = 1.5;

}  // namespace

FlightManager::FlightManager(const FlightConfig& config, const Mission& mission)
    : config_{config}, mission_{mission}, controller_{config}, landing_{config.landing} {
  hover_thrust_N_ = config.vehicle.mass_kg * config.vehicle.gravity_m_s2;
}

double FlightManager::cruise_over_ground(double course_rad) const {
  const double with = wind_W_.dot(along(course_rad));
  const double across = wind_W_.dot(right_of(course_rad));
  const double v = config_.cruise_m_s;
  return std::max(1.0, with + std::sqrt(std::max(v * v - across * across, 0.0)));
}

/// Against the air that a velocity over ground meets.
double FlightManager::heading_for(const Eigen::Vector2d& v_W) const {
  const Eigen::Vector2d air = v_W - wind_W_;
  return air.norm() < kNoWind_m_s ? controller_.heading_rad() : fixedwing::course_of(air);
}

void FlightManager::enter(Phase phase, const Input& in) {
  const Phase before = phase_;
  phase_ = phase;
  since_s_ = in.t_s;
  out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(phase));
  const Vector3& p_W = in.state.p_W;
  switch (phase) {
    case Phase::kTakeoff: {
      home_W_ = p_W;
      controller_.reset(heading_of(in.state.q_WB));
      wind_W_ = in.state.wind_W.head<2>();
      hold_W_ = home_W_ - mission_.takeoff_height_m * Vector3::UnitZ();
      std::vector<Vector3> points{hold_W_};
      points.insert(points.end(), mission_.waypoints_W.begin(), mission_.waypoints_W.end());
      static_cast<void>(path_.build(points, mission_.turn_radius_m));
      limits_.start(config_.battery, mission_.fence);
      break;
    }
    case Phase::kTransition:
    case Phase::kBack:
      if (before == Phase::kPilot) {
        controller_.reset(heading_of(in.state.q_WB));
        if (path_.empty()) break;
        path_.rejoin(p_W);
        out_.events.add(FlightEventType::kPilotGaveBack);
      }
      if (before == Phase::kPilot || before == Phase::kTakeoff) {
        const Path::Point& at = path_.follow(p_W);
        u_m_s_ = std::max(0.0, in.state.v_W.head<2>().dot(along(at.course_rad)));
        u_rate_m_s2_ = 0.0;
      }
      break;
    case Phase::kHover:
      hold_W_ = mission_.waypoints_W.back();
      out_.events.add(FlightEventType::kWaypointReached, mission_.waypoints_W.size() - 1,
                      (p_W - hold_W_).norm());
      out_.events.add(FlightEventType::kMissionDone);
      out_.mission_done = true;
      break;
    case Phase::kLanding:
      if (land_) hold_W_ = p_W;
      landing_.start();
      break;
    case Phase::kLanded:
      out_.landed = true;
      break;
    case Phase::kPilot:
      out_.events.add(FlightEventType::kPilotTookOver);
      break;
    case Phase::kDisarmed:
    case Phase::kCruise:
      break;
  }
}

PhaseConditions FlightManager::conditions(const Input& in) {
  const StateEstimate& state = in.state;
  const bool lost = !state.p_W.allFinite() || !state.v_W.allFinite();
  const bool pilot = overrides_.step(in.status.rc_override, dt_s_).any() || lost ||
                     in.status.failsafe || !GapWatch::linked(in.status.silent_s);
  PhaseConditions now;
  now.set(P::kArmed, in.status.armed);
  now.set(P::kPilot, pilot);
  now.set(P::kLandAsked, land_);
  if (lost) return now;
  const double height_m = home_W_.z() - state.p_W.z();
  now.set(P::kUp, height_m > mission_.takeoff_height_m - 1.0);
  const double wing_only_m_s = config_.wing_only_stalls * config_.vehicle.stall_speed_m_s();
  now.set(P::kWingborne, out_.airspeed_m_s > wing_only_m_s && out_.lift_force_N <= 0.0);
  const double left_m = path_.empty() ? kInfinity : path_.follow(state.p_W).left_m;
  const double stop_m = 0.5 * u_m_s_ * u_m_s_ / config_.deceleration_m_s2;
  now.set(P::kBraking, left_m < stop_m || left_m < kArrived_m);
  const Vector3 from_end = state.p_W - mission_.waypoints_W.back();
  const bool settled =
      from_end.head<2>().norm() < kArrived_m && state.v_W.head<2>().norm() < kArrivedSlow_m_s;
  now.set(P::kArrived, settled && (phase_ != Phase::kHover || in.t_s - since_s_ > kSettle_s));
  now.set(P::kTouched, touching_.touched);
  const bool low = height_m < 1.0 && state.v_W.norm() < 0.3;
  rests_s_ = phase_ == Phase::kPilot && low ? rests_s_ + dt_s_ : 0.0;
  now.set(P::kRests, rests_s_ > kRests_s);
  return now;
}

/// Holds hold_W_, or comes down below it.
Controller::Command FlightManager::hold(const Input& in, double down_m_s) const {
  Vector3 v_W = config_.position_1_s * (hold_W_ - in.state.p_W);
  const double speed = v_W.head<2>().norm();
  if (speed > kMaxCorrection_m_s) v_W.head<2>() *= kMaxCorrection_m_s / speed;
  v_W.z() = down_m_s;
  return {.v_W = v_W, .heading_rad = heading_for({0.0, 0.0})};
}

Controller::Command FlightManager::along_path(const Input& in, const Path::Point& at) {
  const Eigen::Vector2d t_W = along(at.course_rad);
  const double braking = std::sqrt(2.0 * config_.deceleration_m_s2 * std::max(at.left_m, 0.0));
  const double target = std::min(
      {cruise_over_ground(at.course_rad), braking, kEndGain_1_s * std::max(at.left_m, 0.0)});
  const double ahead = std::max(u_m_s_ + kLead_s * u_rate_m_s2_, 0.0);
  const double heading = heading_for(ahead * t_W);
  const double away = std::abs(wrap_angle(heading - heading_of(in.state.q_WB)));
  const double up = away > kNoseAway_rad ? 0.0 : config_.acceleration_m_s2;
  const double before = u_m_s_;
  u_m_s_ =
      std::clamp(target, u_m_s_ - 2.0 * config_.deceleration_m_s2 * dt_s_, u_m_s_ + up * dt_s_);
  const double rate = dt_s_ > 0.0 ? (u_m_s_ - before) / dt_s_ : 0.0;
  u_rate_m_s2_ += std::min(1.0, dt_s_ / 0.5) * (rate - u_rate_m_s2_);

  const Vector3 off_W = at.p_W - in.state.p_W;
  Eigen::Vector2d back = config_.position_1_s * off_W.head<2>();
  if (back.norm() > kMaxCorrection_m_s) back *= kMaxCorrection_m_s / back.norm();
  Controller::Command out{.heading_rad = heading};
  out.v_W.head<2>() = u_m_s_ * t_W + back;
  out.v_W.z() = std::clamp(config_.vertical_1_s * off_W.z(), -3.0, 3.0) - at.slope * u_m_s_;
  const double u = in.state.v_W.head<2>().dot(t_W);
  out.a_ff_W.head<2>() = rate * t_W + u * u * at.curvature_1_m * right_of(at.course_rad);
  return out;
}

void FlightManager::fly(const Input& in) {
  const StateEstimate& state = in.state;
  const double height_m = home_W_.z() - state.p_W.z();
  out_.tracking = false;
  out_.setpoint = {};
  Controller::Command command{.heading_rad = controller_.heading_rad()};
  switch (phase_) {
    case Phase::kDisarmed:
    case Phase::kLanded:
      out_.command = FirmwareCommand{};
      return;
    case Phase::kPilot:
      controller_.reset(heading_of(state.q_WB));
      out_.command = FirmwareCommand{};
      out_.command.ignore = kIgnoreAll;
      return;
    case Phase::kTakeoff: {
      if (in.t_s - since_s_ < kSpoolUp_s) {
        out_.command = FirmwareCommand{};
        return;
      }
      const double left_m = state.p_W.z() - hold_W_.z();
      command =
          hold(in, -std::clamp(config_.vertical_1_s * left_m, 0.3, config_.takeoff_speed_m_s));
      command.on_ground = height_m < 0.3;
      out_.setpoint.p_W = {home_W_.x(), home_W_.y(), state.p_W.z()};
      break;
    }
    case Phase::kTransition:
    case Phase::kCruise:
    case Phase::kBack: {
      const Path::Point& at = path_.follow(state.p_W);
      const std::size_t before = out_.waypoint;
      if (at.waypoint > before) {
        out_.events.add(FlightEventType::kWaypointReached, before,
                        (state.p_W - mission_.waypoints_W[before]).norm());
      }
      out_.waypoint = at.waypoint;
      command = along_path(in, at);
      out_.tracking = true;
      out_.setpoint.p_W = at.p_W;
      out_.setpoint.v_W << u_m_s_ * along(at.course_rad), -at.slope * u_m_s_;
      out_.setpoint.psi_rad = at.course_rad;
      break;
    }
    case Phase::kHover:
      command =
          hold(in, std::clamp(config_.vertical_1_s * (hold_W_.z() - state.p_W.z()), -2.0, 2.0));
      out_.setpoint.p_W = hold_W_;
      break;
    case Phase::kLanding: {
      hover_thrust_N_ += std::min(1.0, dt_s_ / 2.0) * (out_.lift_force_N - hover_thrust_N_) *
                         (touching_.unloading || height_m < 1.0 ? 0.0 : 1.0);
      touching_ = landing_.step({.dt_s = dt_s_,
                                 .down_speed_m_s = state.v_W.z(),
                                 .height_m = height_m,
                                 .thrust_N = out_.lift_force_N,
                                 .hover_thrust_N = hover_thrust_N_});
      command = hold(in, touching_.down_speed_m_s);
      if (touching_.unloading) command.lift_force_N = touching_.thrust_N, command.on_ground = true;
      out_.setpoint.p_W = {hold_W_.x(), hold_W_.y(), state.p_W.z()};
      break;
    }
  }
  const double voltage_V = in.status.battery_voltage_V;
  if (voltage_V > 0.0) command.supply = std::min(1.0, voltage_V / config_.vehicle.full_voltage_V);
  const Controller::Output& done = controller_.step(state, command, dt_s_);
  out_.command = done.command;
  out_.lift_force_N = done.lift_force_N;
  out_.airspeed_m_s = done.airspeed_m_s;
}

const FlightOutput& FlightManager::step(const Input& in) {
  dt_s_ = std::clamp(in.t_s - t_s_, 0.0, 0.1);
  t_s_ = in.t_s;
  out_.events = {};
  if (in.state.wind_W.allFinite()) {
    wind_W_ += std::min(1.0, dt_s_ / kWindAverage_s) * (in.state.wind_W.head<2>() - wind_W_);
  }
  const Phase next = phase_ == Phase::kDisarmed && out_.landed
                         ? phase_
                         : kPhaseTable.next(phase_, conditions(in).bits());
  if (next != phase_) enter(next, in);
  out_.phase = phase_;
  out_.request_disarm = phase_ == Phase::kLanded;
  if (phase_ != Phase::kDisarmed && phase_ != Phase::kLanded)
    limits_.step(in.status, in.state.p_W - home_W_, dt_s_, out_.events);
  if (limits_.asks_land()) land_ = true;
  fly(in);
  if (!mission_.waypoints_W.empty() && out_.waypoint < mission_.waypoints_W.size())
    out_.distance_m = (in.state.p_W - mission_.waypoints_W[out_.waypoint]).norm();
  return out_;
}

}  // namespace rosflight::autonomy::quadplane
