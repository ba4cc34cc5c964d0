// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMaxStep_s = 0.2;
constexpr double kAirspeedRateTau_s = 0.5;
constexpr double kSteepestBank_rad = 60.0 * kRadPerDeg;
constexpr double kMinGain = 0.4;
constexpr double kMaxGain = 2.5;
constexpr double kStallAngle_rad = 14.0 * kRadPerDeg;
constexpr double kRollSpeed = 0.6;  // of cruise, from which ailerons must have effect
constexpr double kShareByRudder = 0.4;
constexpr double kSideForceTau_s = 1.0;
constexpr double kBankByRudder_rad = 15.0 * kRadPerDeg;

bool finite(const StateEstimate& s) {
  return std::isfinite(s.p_W.sum() + s.v_W.sum() + s.q_WB.coeffs().sum() + s.w_B.sum() +
                       s.airspeed_m_s + s.course_rad + s.a_B.sum());
}

std::unique_ptr<LongitudinalLaw> make_law(const ControllerConfig& config) {
  if (config.longitudinal == LongitudinalKind::kSuccessiveLoops) {
    return std::make_unique<SuccessiveLoops>(config.successive_loops);
  }
  return std::make_unique<TotalEnergy>(config.total_energy);
}

}  // namespace

/// The state as the loops need it.
struct Controller::Motion {
  RollPitch attitude;
  double airspeed_m_s;
  double gain;  ///< (V0/V)^2
  double load;  ///< Load factor of the turn: 1/cos(roll).
  bool airspeed_known;
};

Controller::Controller(const ControllerConfig& config) : Controller(config, make_law(config)) {}

Controller::Controller(const ControllerConfig& config, std::unique_ptr<LongitudinalLaw> law)
    : config_(config),
      law_(std::move(law)),
      course_(config.course),
      roll_(config.roll),
      roll_by_rudder_(config.roll_by_rudder),
      pitch_(config.pitch),
      climb_rate_(config.climb_rate),
      glide_(config.glide) {}

void Controller::reset() {
  law_->reset();
  for (Pid* pid : {&course_, &roll_, &roll_by_rudder_, &pitch_, &climb_rate_, &glide_}) {
    pid->reset();
  }
  ailerons_.reset();
  roll_c_rad_ = airspeed_rate_m_s2_ = side_force_m_s2_ = washout_ = 0.0;
  fresh_ = true;
  had_command_ = false;
  out_ = {};
}

void Controller::configure(const ControllerConfig& config) {
  const bool same_law = config.longitudinal == config_.longitudinal &&
                        config.successive_loops == config_.successive_loops &&
                        config.total_energy == config_.total_energy;
  config_ = config;
  course_.set_gains(config.course);
  roll_.set_gains(config.roll);
  roll_by_rudder_.set_gains(config.roll_by_rudder);
  pitch_.set_gains(config.pitch);
  climb_rate_.set_gains(config.climb_rate);
  glide_.set_gains(config.glide);
  if (!same_law) law_ = make_law(config);
}

double Controller::angle_of_attack(double airspeed_m_s, double roll_rad) const {
  const Airframe& a = config_.airframe;
  if (!(a.lift_slope_1_rad > 0.0)) return a.pitch_trim_rad;
  const double pressure = 0.5 * a.density_kg_m3 * airspeed_m_s * airspeed_m_s;
  const double bank = std::clamp(roll_rad, -kSteepestBank_rad, kSteepestBank_rad);
  const double lift = a.mass_kg * a.gravity_m_s2 / (pressure * a.wing_area_m2 * std::cos(bank));
  return std::min((lift - a.lift_zero) / a.lift_slope_1_rad, kStallAngle_rad);
}

double Controller::bank(const Input& in, const Motion& m, const ControllerCommand& command,
                        bool lost) {
  double wanted = 0.0;
  if (in.direct.roll_rad) {
    wanted = *in.direct.roll_rad;
    course_.reset();
  } else if (lost) {
    wanted = config_.lost_roll_rad;
    course_.reset();
  } else {
    const double ff = std::clamp(command.roll_ff_rad, -config_.max_roll_rad, config_.max_roll_rad);
    course_.set_limits({-config_.max_roll_rad - ff, config_.max_roll_rad - ff});
    const double error = wrap_angle(command.course_rad - in.state.course_rad);
    wanted = ff + course_.step_with_rate(error, 0.0, 0.0, in.dt_s);
  }
  double most = std::min(config_.max_roll_rad, in.direct.max_roll_rad);
  side_force_m_s2_ += (in.state.a_B.y() - side_force_m_s2_) * in.dt_s / (kSideForceTau_s + in.dt_s);
  if (ailerons_.lost()) {
    // It flies in a sideslip, whose force turns it too.
    wanted = kShareByRudder * wanted - std::atan(side_force_m_s2_ / config_.airframe.gravity_m_s2);
    most = std::min(most, kBankByRudder_rad);
  }
  wanted = std::clamp(wanted, -most, most);
  if (fresh_) roll_c_rad_ = m.attitude.roll_rad;
  const double step = config_.max_roll_rate_rad_s * in.dt_s;
  roll_c_rad_ += std::clamp(wanted - roll_c_rad_, -step, step);
  return roll_c_rad_;
}

void Controller::longitudinal(const Input& in, const Motion& m, const ControllerCommand& command) {
  const Direct& direct = in.direct;
  const double v = m.airspeed_m_s;
  const double climb_m_s = -in.state.v_W.z();
  const double guard = config_.speed_guard_rad_s_m * (v - config_.min_airspeed_m_s);
  out_.speed_guard = m.airspeed_known && guard < 0.0;
  LongitudinalLaw::Input law;
  law.dt_s = in.dt_s;
  law.height_m = -in.state.p_W.z();
  law.climb_m_s = climb_m_s;
  law.airspeed_m_s = v;
  law.airspeed_rate_m_s2 = airspeed_rate_m_s2_;
  law.height_c_m = command.height_m;
  law.airspeed_c_m_s = command.airspeed_m_s;
  law.climb_ff_m_s = command.climb_ff_m_s;
  law.min_climb_rad = -config_.max_descent_rad;
  law.max_climb_rad = config_.max_climb_rad;
  if (m.airspeed_known) {
    law.max_climb_rad = std::clamp(guard, law.min_climb_rad, config_.max_climb_rad);
  }
  law.min_throttle = config_.min_throttle;
  law.max_throttle = std::min(config_.max_throttle, direct.max_throttle);
  law.speed_share = direct.speed_share;
  law.airspeed_known = m.airspeed_known;
  law.throttle_ff = config_.throttle_cruise +
                    config_.throttle_per_climb * command.climb_ff_m_s / v +
                    config_.throttle_per_speed_s_m * (command.airspeed_m_s - config_.cruise_m_s) +
                    config_.throttle_per_load * (m.load - 1.0);
  if (direct.climb_m_s) {
    climb_rate_.set_limits({-config_.max_descent_rad, config_.max_climb_rad});
    const double ff = std::asin(std::clamp(*direct.climb_m_s / v, -0.9, 0.9));
    out_.climb_angle_c_rad =
        ff + climb_rate_.step_with_rate(*direct.climb_m_s, climb_m_s, 0.0, in.dt_s);
    out_.surfaces.throttle = std::clamp(law.throttle_ff, law.min_throttle, law.max_throttle);
  } else if (direct.airspeed_by_pitch_m_s) {
    glide_.set_limits({config_.glide_rad, config_.max_descent_rad + config_.glide_rad});
    out_.climb_angle_c_rad =
        config_.glide_rad +
        (m.airspeed_known ? -glide_.step_with_rate(*direct.airspeed_by_pitch_m_s, v, 0.0, in.dt_s)
                          : 0.0);
    out_.surfaces.throttle = law.min_throttle;
  } else if (direct.pitch_rad && direct.throttle) {
    out_.climb_angle_c_rad = 0.0;
  } else {
    climb_rate_.reset();
    glide_.reset();
    const LongitudinalLaw::Output answer = law_->step(law);
    out_.climb_angle_c_rad = answer.climb_angle_rad;
    out_.surfaces.throttle = answer.throttle;
  }
  if (direct.throttle) {
    out_.surfaces.throttle = std::clamp(*direct.throttle, 0.0, law.max_throttle);
  }
  out_.throttle_full = out_.surfaces.throttle >= config_.max_throttle - 1e-3;
  const double pitch = out_.climb_angle_c_rad + angle_of_attack(v, m.attitude.roll_rad);
  const double path = std::asin(std::clamp(climb_m_s / v, -0.9, 0.9));
  const double stall = path + config_.max_alpha_rad * std::cos(m.attitude.roll_rad);
  const double high = std::min({config_.max_pitch_rad, direct.max_pitch_rad, stall});
  const double low = std::min(std::max(config_.min_pitch_rad, direct.min_pitch_rad), high);
  out_.pitch_c_rad = direct.pitch_rad ? *direct.pitch_rad : std::clamp(pitch, low, high);
}

void Controller::surfaces(const Input& in, const Motion& m) {
  const Vector3& w = in.state.w_B;
  Surfaces& out = out_.surfaces;
  const auto whole = [](double x) { return std::clamp(x, -1.0, 1.0); };
  roll_.set_limits({-1.0 / m.gain, 1.0 / m.gain});
  const auto roll_integral =
      in.direct.ground_course_rad ? Pid::Integrate::kNo : Pid::Integrate::kYes;
  out.aileron = whole(m.gain * roll_.step_with_rate(out_.roll_c_rad, m.attitude.roll_rad, w.x(),
                                                    in.dt_s, roll_integral));
  const Airframe& a = config_.airframe;
  const double turn_rad_s = a.gravity_m_s2 / m.airspeed_m_s * std::tan(m.attitude.roll_rad) *
                            std::sin(m.attitude.roll_rad);
  const double trim =
      a.elevator_trim + a.elevator_1_rad * angle_of_attack(m.airspeed_m_s, m.attitude.roll_rad);
  pitch_.set_limits({(-1.0 - trim) / m.gain, (1.0 - trim) / m.gain});
  out.elevator =
      whole(trim + m.gain * pitch_.step_with_rate(out_.pitch_c_rad, m.attitude.pitch_rad,
                                                  w.y() - turn_rad_s, in.dt_s, roll_integral));
  const double wo = config_.yaw_washout_rad_s;
  if (fresh_) yaw_rate_rad_s_ = w.z();
  const double d = 2.0 + in.dt_s * wo;
  washout_ = (2.0 - in.dt_s * wo) / d * washout_ + 2.0 / d * (w.z() - yaw_rate_rad_s_);
  yaw_rate_rad_s_ = w.z();
  double rudder = -config_.yaw_damper_s * washout_;
  const bool flies = !in.direct.ground_course_rad && !in.pilot.roll_pitch && m.airspeed_known &&
                     m.airspeed_m_s > kRollSpeed * config_.cruise_m_s;
  if (flies) {
    const double full_rad_s = config_.full_aileron_rad_s * m.airspeed_m_s / config_.cruise_m_s;
    ailerons_.step(out.aileron, out_.roll_c_rad - m.attitude.roll_rad, w.x(), full_rad_s, in.dt_s);
  }
  out_.aileron_lost = ailerons_.lost();
  if (ailerons_.lost()) {
    roll_by_rudder_.set_limits({-1.0 / m.gain, 1.0 / m.gain});
    rudder += roll_by_rudder_.step_with_rate(out_.roll_c_rad, m.attitude.roll_rad, w.x(), in.dt_s,
                                             roll_integral);
  }
  out.rudder = whole(m.gain * rudder);
  if (in.direct.ground_course_rad) {
    const double heading = heading_of(in.state.q_WB);
    out.rudder =
        whole(config_.ground_course.kp * wrap_angle(*in.direct.ground_course_rad - heading) -
              config_.ground_course.kd * w.z());
  }
}

const Controller::Output& Controller::step(const Input& in) {
  if (!(in.dt_s > 0.0) || !finite(in.state)) return out_;
  const double dt_s = std::min(in.dt_s, kMaxStep_s);
  if (in.pilot.roll_pitch) {
    course_.clear_integral();
    roll_.clear_integral();
    pitch_.clear_integral();
  }
  if (in.pilot.throttle || in.pilot.roll_pitch) law_->reset();
  Motion m{};
  m.attitude = RollPitch::of(in.state.q_WB);
  m.airspeed_known = in.state.air_valid;
  m.airspeed_m_s = m.airspeed_known ? std::max(in.state.airspeed_m_s, 0.3 * config_.cruise_m_s)
                                    : config_.cruise_m_s;
  m.gain = std::clamp(config_.cruise_m_s * config_.cruise_m_s / (m.airspeed_m_s * m.airspeed_m_s),
                      kMinGain, kMaxGain);
  m.load = 1.0 / std::cos(std::clamp(m.attitude.roll_rad, -kSteepestBank_rad, kSteepestBank_rad));
  // Along the nose and against the air: the specific force less the share of gravity.
  const double rate =
      in.state.a_B.x() - config_.airframe.gravity_m_s2 * std::sin(m.attitude.pitch_rad);
  airspeed_rate_m_s2_ += (rate - airspeed_rate_m_s2_) * dt_s / (kAirspeedRateTau_s + dt_s);

  const bool good = in.command.valid && in.command_age_s >= 0.0 &&
                    in.command_age_s <= config_.command_timeout_s && in.command.airspeed_m_s > 0.0;
  if (good || !had_command_) lost_height_m_ = good ? in.command.height_m : -in.state.p_W.z();
  had_command_ = true;
  ControllerCommand command = in.command;
  if (!good) {
    command = {};
    command.airspeed_m_s = config_.cruise_m_s;
    command.height_m = lost_height_m_;
  }
  out_.lost = !good;
  out_.height_c_m = command.height_m;
  out_.airspeed_c_m_s = command.airspeed_m_s;
  const Input limited{in.state, in.command, in.command_age_s, dt_s, in.pilot, in.direct};
  out_.roll_c_rad = bank(limited, m, command, !good);
  longitudinal(limited, m, command);
  surfaces(limited, m);
  fresh_ = false;
  return out_;
}

}  // namespace rosflight::autonomy::fixedwing
