// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/trajectory_follower.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

bool finite(const Trajectory& s) {
  // A sum is finite only if every term is; overflow of honest numbers is out of reach.
  return std::isfinite(s.p_W.sum() + s.v_W.sum() + s.a_W.sum() + s.j_W.sum() + s.psi_rad +
                       s.psi_dot_rad_s);
}

bool finite(const State& s) {
  return std::isfinite(s.p_W.sum() + s.v_W.sum() + s.q_WB.coeffs().sum() + s.w_B.sum());
}

/// May this integral move? Not in the pilot's hands; when limited only back towards zero.
Pid::Integrate may_integrate(const Pid& pid, double error, bool pilot, bool limited) {
  const bool unwinds = error * pid.integral() < 0.0;
  return pilot || (limited && !unwinds) ? Pid::Integrate::kNo : Pid::Integrate::kYes;
}

}  // namespace

TrajectoryFollower::TrajectoryFollower(const FollowerConfig& config) {
  configure(config);
}

void TrajectoryFollower::configure(const FollowerConfig& config) {
  constexpr double kHeadingTau_s = 0.05;
  config_ = config;
  north_.set_gains(config.horizontal);
  east_.set_gains(config.east.value_or(config.horizontal));
  down_.set_gains(config.vertical);
  heading_.set_gains(config.heading);
  heading_.set_limits({-config.max_yaw_rate_rad_s, config.max_yaw_rate_rad_s});
  heading_.set_derivative_tau(kHeadingTau_s);
  tan_tilt_ = std::tan(config.max_tilt_rad);
}

void TrajectoryFollower::clear_integrators() {
  for (Pid* pid : {&north_, &east_, &down_, &heading_}) pid->clear_integral();
}

void TrajectoryFollower::restart(const Vector3& trim_W) {
  for (Pid* pid : {&north_, &east_, &down_, &heading_}) pid->reset();
  north_.set_integral(trim_W.x());
  east_.set_integral(trim_W.y());
  down_.set_integral(trim_W.z());
  last_ = ControllerCommand{};
  lateral_limited_ = lift_limited_ = false;
}

Vector3 TrajectoryFollower::wanted_acceleration(const Input& in) {
  const State& at = in.state;
  const Trajectory& to = in.setpoint;
  Vector3 error = to.p_W - at.p_W;
  const double window = config_.max_position_error_m;
  const double lateral = std::sqrt(error.x() * error.x() + error.y() * error.y());
  const bool far_lateral = lateral > window;
  const bool far_below_or_above = std::abs(error.z()) > window;
  if (far_lateral) error.head<2>() *= window / lateral;
  error.z() = std::clamp(error.z(), -window, window);
  const Vector3 v_excess = at.v_W - to.v_W;
  const Vector3 target = at.p_W + error;

  const bool pilot = in.pilot.roll_pitch;
  const bool limited = lateral_limited_ || far_lateral;
  Vector3 u;
  u.x() = north_.step_with_rate(target.x(), at.p_W.x(), v_excess.x(), in.dt_s,
                                may_integrate(north_, error.x(), pilot, limited));
  u.y() = east_.step_with_rate(target.y(), at.p_W.y(), v_excess.y(), in.dt_s,
                               may_integrate(east_, error.y(), pilot, limited));
  u.z() = down_.step_with_rate(
      target.z(), at.p_W.z(), v_excess.z(), in.dt_s,
      may_integrate(down_, error.z(), in.pilot.throttle, lift_limited_ || far_below_or_above));
  const double drag = config_.drag_1_s;
  const double lag_s = config_.attitude_lag_s;
  u.head<2>() +=
      (1.0 + lag_s * drag) * to.a_W.head<2>() + drag * to.v_W.head<2>() + lag_s * to.j_W.head<2>();
  u.z() += to.a_W.z() + config_.thrust_lag_s * to.j_W.z();
  return u;
}

void TrajectoryFollower::limit(Vector3& f_W) {
  const double max_force = config_.max_thrust_N / config_.mass_kg;
  const double lift =
      std::clamp(f_W.z(), -max_force, -config_.min_lift_ratio * config_.gravity_m_s2);
  lift_limited_ = lift != f_W.z();
  f_W.z() = lift;
  const double left = std::sqrt(std::max(max_force * max_force - lift * lift, 0.0));
  const double most = std::min(-lift * tan_tilt_, left);
  const double lateral = std::sqrt(f_W.x() * f_W.x() + f_W.y() * f_W.y());
  lateral_limited_ = lateral > most;
  if (lateral_limited_) f_W.head<2>() *= most / lateral;
}

double TrajectoryFollower::wanted_yaw_rate(const Input& in) {
  const AttitudeView& att = in.attitude;
  const double error = wrap_angle(in.setpoint.psi_rad - att.psi_rad);
  // Row of q_WB's rotation that carries body rates to the vertical: the heading's share of the
  // rotation.
  double psi_dot = 0.0;
  if (heading_.gains().kd != 0.0) {
    const RollPitch rp = RollPitch::of(in.state.q_WB);
    const double cos_pitch = std::max(std::cos(rp.pitch_rad), 0.1);
    psi_dot =
        (in.state.w_B.y() * std::sin(rp.roll_rad) + in.state.w_B.z() * std::cos(rp.roll_rad)) /
        cos_pitch;
  }
  const double feedback =
      heading_.step_with_rate(att.psi_rad + error, att.psi_rad, psi_dot - in.setpoint.psi_dot_rad_s,
                              in.dt_s, in.pilot.yaw ? Pid::Integrate::kNo : Pid::Integrate::kYes);
  return std::clamp(feedback + in.setpoint.psi_dot_rad_s, -config_.max_yaw_rate_rad_s,
                    config_.max_yaw_rate_rad_s);
}

ControllerCommand TrajectoryFollower::step(const Input& in) {
  if (in.setpoint_age_s > config_.timeout_s || !finite(in.setpoint) || !finite(in.state)) return {};
  if (!(in.dt_s > 0.0)) return last_;
  if (in.pilot.roll_pitch) north_.clear_integral(), east_.clear_integral();
  if (in.pilot.throttle) down_.clear_integral();
  if (in.pilot.yaw) heading_.clear_integral();

  Vector3 f_W = wanted_acceleration(in);
  f_W.z() -= config_.gravity_m_s2;
  limit(f_W);
  const double c = in.attitude.cos_psi;
  const double s = in.attitude.sin_psi;
  const double f_x = c * f_W.x() + s * f_W.y();
  const double f_y = -s * f_W.x() + c * f_W.y();
  const double f_z = f_W.z();
  const ThrustDirection to = ThrustDirection::of(f_x, f_y, f_z);

  const double u_psi = wanted_yaw_rate(in);
  // sin and cos of the commanded angles without trigonometry: see ThrustDirection
  const double planar_sq = f_x * f_x + f_z * f_z;
  const double planar = std::sqrt(planar_sq);
  const double sin_roll = f_y / to.specific_force_m_s2;
  const double cos_pitch_cos_roll = -f_z / to.specific_force_m_s2;
  const double pitch_dot = planar > 1e-9 ? u_psi * f_y * f_z / planar_sq : 0.0;
  const double yaw_rate = u_psi * cos_pitch_cos_roll - pitch_dot * sin_roll;

  last_.mode = ControlMode::kRollPitchYawrateThrust;
  last_.cmd = {to.roll_rad, to.pitch_rad,
               std::clamp(yaw_rate, -config_.max_yaw_rate_rad_s, config_.max_yaw_rate_rad_s),
               config_.mass_kg * to.specific_force_m_s2};
  last_.valid = true;
  return last_;
}

}  // namespace rosflight::autonomy::multirotor
