// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/controller.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr unsigned bit(unsigned loop) {
  return 1U << loop;
}
double clip(double x, double limit) {
  return std::clamp(x, -limit, limit);
}

}  // namespace

Controller::Controller(const ControllerConfig& config, const ThrustModel& thrust) {
  configure(config, thrust);
}

void Controller::configure(const ControllerConfig& config, const ThrustModel& thrust) {
  config_ = config;
  thrust_ = thrust;
  tan_tilt_ = std::tan(config.max_tilt_rad);
  cos_tilt_ = std::cos(config.max_tilt_rad);
  // North and east are limited together, so that the direction stays: see the steps of the chain.
  const auto set = [&](Loop loop, const PidGains& gains, double lower, double upper) {
    pids_[loop].set_gains(gains);
    pids_[loop].set_limits({lower, upper});
    pids_[loop].set_derivative_tau(config.derivative_tau_s);
  };
  const double climb = config.max_thrust_N / config.mass_kg - config.gravity_m_s2;
  set(kPosN, config.position_horizontal, -kInfinity, kInfinity);
  set(kPosE, config.position_east.value_or(config.position_horizontal), -kInfinity, kInfinity);
  set(kPosD, config.position_vertical, -config.max_climb_m_s, config.max_descend_m_s);
  set(kVelN, config.velocity_horizontal, -kInfinity, kInfinity);
  set(kVelE, config.velocity_east.value_or(config.velocity_horizontal), -kInfinity, kInfinity);
  set(kVelD, config.velocity_vertical, -climb, config.max_descend_acceleration_m_s2);
  set(kHeading, config.heading_to_rate, -config.max_yaw_rate_rad_s, config.max_yaw_rate_rad_s);
  const double q = config.max_roll_pitch_torque_Nm;
  const double qz = config.max_yaw_torque_Nm;
  set(kRollTorque, config.roll_to_torque, -q, q);
  set(kPitchTorque, config.pitch_to_torque, -q, q);
  set(kYawTorque, config.yaw_to_torque, -qz, qz);
  set(kRollRate, config.roll_rate_to_torque, -q, q);
  set(kPitchRate, config.pitch_rate_to_torque, -q, q);
  set(kYawRate, config.yaw_rate_to_torque, -qz, qz);
}

unsigned Controller::loops_of(ControlMode mode) {
  constexpr unsigned kVelocity = bit(kVelN) | bit(kVelE) | bit(kVelD);
  constexpr unsigned kHorizontal = bit(kPosN) | bit(kPosE);
  switch (mode) {
    case ControlMode::kNposEposDposYaw:
      return kHorizontal | bit(kPosD) | kVelocity | bit(kHeading);
    case ControlMode::kNvelEvelDposYawrate:
      return bit(kPosD) | kVelocity;
    case ControlMode::kNvelEvelDvelYawrate:
      return kVelocity;
    case ControlMode::kNposEposDvelYaw:
      return kHorizontal | kVelocity | bit(kHeading);
    case ControlMode::kRollPitchYawThrottle:
      return bit(kHeading);
    case ControlMode::kRollPitchYawThrust:
      return bit(kRollTorque) | bit(kPitchTorque) | bit(kYawTorque) | bit(kHeading);
    case ControlMode::kRollPitchYawrateThrust:
      return bit(kRollTorque) | bit(kPitchTorque) | bit(kYawRate);
    case ControlMode::kRollratePitchrateYawrateThrust:
      return bit(kRollRate) | bit(kPitchRate) | bit(kYawRate);
    case ControlMode::kFaccRaccDaccYawrate:
    case ControlMode::kRollPitchYawrateThrottle:
    case ControlMode::kRollratePitchrateYawrateThrottle:
    case ControlMode::kPassThroughToMixer:
      return 0;
  }
  return 0;
}

void Controller::enter(ControlMode mode, const Vector3& trim_W) {
  const unsigned fresh = loops_of(mode) & ~loops_of(mode_);
  for (unsigned loop = 0; loop < kLoops; ++loop) {
    if ((fresh & bit(loop)) == 0) continue;
    pids_[loop].reset();
    if (loop >= kVelN && loop <= kVelD)
      pids_[loop].set_integral(trim_W[static_cast<int>(loop - kVelN)]);
  }
  mode_ = mode;
}

Vector3 Controller::trim_W() const {
  return {pids_[kVelN].integral(), pids_[kVelE].integral(), pids_[kVelD].integral()};
}

void Controller::clear_integrators() {
  for (Pid& pid : pids_) pid.clear_integral();
}

bool Controller::pilot_holds(Loop loop, const PilotOverride& pilot) {
  const bool vertical = loop == kPosD || loop == kVelD;
  const bool yaw = loop == kHeading || loop == kYawTorque || loop == kYawRate;
  return vertical ? pilot.throttle : (yaw ? pilot.yaw : pilot.roll_pitch);
}

Pid::Integrate Controller::integrate(Loop loop, const Input& in) const {
  const bool vertical = loop == kPosD || loop == kVelD;
  const bool limited = ((loop == kPosN || loop == kPosE) && speed_limited_) ||
                       ((loop == kVelN || loop == kVelE) && tilt_limited_);
  const bool hold = pilot_holds(loop, in.pilot) || (in.on_ground && !vertical) || limited;
  return hold ? Pid::Integrate::kNo : Pid::Integrate::kYes;
}

double Controller::run(Loop loop, double desired, double current, const Input& in) {
  return pids_[loop].step(desired, current, in.dt_s, integrate(loop, in));
}

double Controller::run(Loop loop, double desired, double current, double rate, const Input& in) {
  return pids_[loop].step_with_rate(desired, current, rate, in.dt_s, integrate(loop, in));
}

Vector3 Controller::position_to_velocity(const Four& cmd, bool down_too, const Input& in) {
  const Vector3& p = in.state.p_W;
  Vector3 v{run(kPosN, cmd[0], p.x(), in), run(kPosE, cmd[1], p.y(), in), cmd[2]};
  if (down_too) v.z() = run(kPosD, cmd[2], p.z(), in);
  const double speed = std::sqrt(v.x() * v.x() + v.y() * v.y());
  const double most = config_.max_horizontal_velocity_m_s;
  speed_limited_ = speed > most;
  if (speed_limited_) v.head<2>() *= most / speed;
  return v;
}

double Controller::heading_to_rate(double psi_rad, const Input& in) {
  const double psi = in.attitude.psi_rad;
  return run(kHeading, psi + wrap_angle(psi_rad - psi), psi, in.state.w_B.z(), in);
}

Vector3 Controller::velocity_to_acceleration(const Vector3& v_W, const Input& in) {
  const Vector3& v = in.state.v_W;
  const double down = std::clamp(v_W.z(), -config_.max_climb_m_s, config_.max_descend_m_s);
  return {run(kVelN, v_W.x(), v.x(), in), run(kVelE, v_W.y(), v.y(), in),
          run(kVelD, down, v.z(), in)};
}

/// Accelerations in v1 [m/s^2].
Controller::Output Controller::accelerate(double forward, double right, double down,
                                          double yaw_rate, const Input& in) {
  const double g = config_.gravity_m_s2;
  const double mass = config_.mass_kg;
  const double lift =
      std::clamp(g - down, config_.min_thrust_N / mass, config_.max_thrust_N / mass);
  const double lateral = std::sqrt(forward * forward + right * right);
  const double most = lift * tan_tilt_;
  tilt_limited_ = lateral > most;
  const double keep = tilt_limited_ ? most / lateral : 1.0;
  const ThrustDirection to = ThrustDirection::of(forward * keep, right * keep, -lift);
  const double thrust_N = mass * lift / std::max(in.attitude.cos_tilt, cos_tilt_);
  const double limited_N = std::clamp(thrust_N, config_.min_thrust_N, config_.max_thrust_N);
  return to_firmware(FirmwareMode::kRollPitchYawrateThrottle, to.roll_rad, to.pitch_rad, yaw_rate,
                     thrust_.throttle(limited_N, in.battery_voltage_V), limited_N, in);
}

Controller::Output Controller::to_firmware(FirmwareMode mode, double x, double y, double z,
                                           double throttle, double thrust_N,
                                           const Input& in) const {
  const bool angles = mode == FirmwareMode::kRollPitchYawrateThrottle;
  const double most = angles ? config_.max_tilt_rad : config_.max_roll_pitch_rate_rad_s;
  Output out;
  if (!in.on_ground) {
    out.roll_rad = clip(x, most);
    out.pitch_rad = clip(y, most);
    out.yaw_rate_rad_s = clip(z, config_.max_yaw_rate_rad_s);
  }
  out.thrust_N = thrust_N;
  out.command.mode = mode;
  out.command.u = {0.0F,
                   0.0F,
                   static_cast<float>(throttle),
                   static_cast<float>(out.roll_rad),
                   static_cast<float>(out.pitch_rad),
                   static_cast<float>(out.yaw_rate_rad_s)};
  return out;
}

Controller::Output Controller::to_mixer(double qx, double qy, double qz, double thrust_N) const {
  Output out;
  out.roll_rad = clip(qx, config_.max_roll_pitch_torque_Nm);
  out.pitch_rad = clip(qy, config_.max_roll_pitch_torque_Nm);
  out.yaw_rate_rad_s = clip(qz, config_.max_yaw_torque_Nm);
  out.thrust_N = std::clamp(thrust_N, 0.0, config_.max_thrust_N);
  out.command.mode = FirmwareMode::kPassThrough;
  out.command.u = {0.0F,
                   0.0F,
                   static_cast<float>(-out.thrust_N),
                   static_cast<float>(out.roll_rad),
                   static_cast<float>(out.pitch_rad),
                   static_cast<float>(out.yaw_rate_rad_s)};
  return out;
}

Controller::Output Controller::torques(ControlMode mode, const Four& cmd, const Input& in) {
  const Vector3& w = in.state.w_B;
  if (mode == ControlMode::kRollratePitchrateYawrateThrust) {
    const double most = config_.max_roll_pitch_rate_rad_s;
    return to_mixer(
        run(kRollRate, in.on_ground ? 0.0 : clip(cmd[0], most), w.x(), in),
        run(kPitchRate, in.on_ground ? 0.0 : clip(cmd[1], most), w.y(), in),
        run(kYawRate, in.on_ground ? 0.0 : clip(cmd[2], config_.max_yaw_rate_rad_s), w.z(), in),
        cmd[3]);
  }
  const RollPitch at = RollPitch::of(in.state.q_WB);
  const double roll = in.on_ground ? 0.0 : clip(cmd[0], config_.max_tilt_rad);
  const double pitch = in.on_ground ? 0.0 : clip(cmd[1], config_.max_tilt_rad);
  const double qx = run(kRollTorque, roll, at.roll_rad, w.x(), in);
  const double qy = run(kPitchTorque, pitch, at.pitch_rad, w.y(), in);
  double qz = 0.0;
  if (mode == ControlMode::kRollPitchYawThrust) {
    const double psi = in.attitude.psi_rad;
    const double error = in.on_ground ? 0.0 : wrap_angle(cmd[2] - psi);
    qz = run(kYawTorque, psi + error, psi, w.z(), in);
  } else {
    qz = run(kYawRate, in.on_ground ? 0.0 : clip(cmd[2], config_.max_yaw_rate_rad_s), w.z(), in);
  }
  return to_mixer(qx, qy, qz, cmd[3]);
}

Controller::Output Controller::dispatch(const Input& in) {
  const Four& cmd = in.command.cmd;
  const auto accelerate_W = [&](const Vector3& v_W, double yaw_rate) {
    const Vector3 a = velocity_to_acceleration(v_W, in);
    const double c = in.attitude.cos_psi;
    const double s = in.attitude.sin_psi;
    return accelerate(c * a.x() + s * a.y(), -s * a.x() + c * a.y(), a.z(), yaw_rate, in);
  };
  const auto throttle_mode = [&](FirmwareMode mode, double z) {
    const double throttle = std::clamp(cmd[3], config_.min_throttle, config_.max_throttle);
    return to_firmware(mode, cmd[0], cmd[1], z, throttle,
                       thrust_.thrust_N(throttle, in.battery_voltage_V), in);
  };
  const auto thrust_mode = [&](FirmwareMode mode, double z) {
    const double thrust_N = std::clamp(cmd[3], 0.0, config_.max_thrust_N);
    return to_firmware(mode, cmd[0], cmd[1], z, thrust_.throttle(thrust_N, in.battery_voltage_V),
                       thrust_N, in);
  };
  constexpr auto kAngles = FirmwareMode::kRollPitchYawrateThrottle;
  constexpr auto kRates = FirmwareMode::kRatesThrottle;
  const bool firmware_loops = config_.attitude_loops == AttitudeLoops::kFirmware;
  const double g = config_.gravity_m_s2;

  switch (in.command.mode) {
    case ControlMode::kNposEposDposYaw:
      return accelerate_W(position_to_velocity(cmd, true, in), heading_to_rate(cmd[3], in));
    case ControlMode::kNvelEvelDposYawrate:
      return accelerate_W({cmd[0], cmd[1], run(kPosD, cmd[2], in.state.p_W.z(), in)}, cmd[3]);
    case ControlMode::kFaccRaccDaccYawrate:
      return accelerate(g * cmd[0], g * cmd[1], g * cmd[2], cmd[3], in);
    case ControlMode::kNvelEvelDvelYawrate:
      return accelerate_W({cmd[0], cmd[1], cmd[2]}, cmd[3]);
    case ControlMode::kNposEposDvelYaw:
      return accelerate_W(position_to_velocity(cmd, false, in), heading_to_rate(cmd[3], in));
    case ControlMode::kRollPitchYawThrottle:
      return throttle_mode(kAngles, heading_to_rate(cmd[2], in));
    case ControlMode::kRollPitchYawrateThrottle:
      return throttle_mode(kAngles, cmd[2]);
    case ControlMode::kRollratePitchrateYawrateThrottle:
      return throttle_mode(kRates, cmd[2]);
    case ControlMode::kPassThroughToMixer:
      return to_mixer(cmd[0], cmd[1], cmd[2], cmd[3]);
    case ControlMode::kRollPitchYawThrust:
      return firmware_loops ? thrust_mode(kAngles, heading_to_rate(cmd[2], in))
                            : torques(in.command.mode, cmd, in);
    case ControlMode::kRollPitchYawrateThrust:
      return firmware_loops ? thrust_mode(kAngles, cmd[2]) : torques(in.command.mode, cmd, in);
    case ControlMode::kRollratePitchrateYawrateThrust:
      return firmware_loops ? thrust_mode(kRates, cmd[2]) : torques(in.command.mode, cmd, in);
  }
  return last_;
}

Controller::Output Controller::step(const Input& in) {
  if (!(in.dt_s > 0.0)) return last_;
  if (in.command.mode != mode_) enter(in.command.mode, trim_W());
  if (in.pilot.any()) {
    for (unsigned loop = 0; loop < kLoops; ++loop) {
      if (pilot_holds(static_cast<Loop>(loop), in.pilot)) pids_[loop].clear_integral();
    }
  }
  last_ = dispatch(in);
  return last_;
}

}  // namespace rosflight::autonomy::multirotor
