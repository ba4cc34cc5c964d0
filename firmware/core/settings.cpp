// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/settings.hpp"

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::core {
namespace {

constexpr auto kEscCalibrationMixer = static_cast<std::int32_t>(MixerId::kEscCalibration);

Vector3 three(const Parameters& p, Param first) {
  const auto base = static_cast<std::uint16_t>(first);
  const auto at = [&](std::uint16_t k) { return p.get_float(static_cast<Param>(base + k)); };
  return {at(0), at(1), at(2)};
}

Pid::Gains gains(const Parameters& p, Param first) {
  const Vector3 v = three(p, first);
  return {v.x(), v.y(), v.z()};
}

std::uint8_t channel(const Parameters& p, Param id) {
  return static_cast<std::uint8_t>(p.get_int(id));  // -1 becomes 255: unmapped
}

}  // namespace

bool calibrates_escs(const Parameters& p) {
  return p.get_int(Param::kPrimaryMixer) == kEscCalibrationMixer;
}

bool uses_motor_model(const Parameters& p) {
  return p.get_bool(Param::kUseMotorParam) && !calibrates_escs(p);
}

std::uint8_t throttle_axis(const Parameters& p) {
  return static_cast<std::uint8_t>(p.get_int(Param::kRcFAxis));
}

Sensors::Config sensor_settings(const Parameters& p) {
  Sensors::Config c;
  c.imu_mounting_deg = three(p, Param::kImuRoll);
  c.mag_mounting_deg = three(p, Param::kMagRoll);
  c.acc_bias = three(p, Param::kAccXBias);
  c.acc_temp_comp = three(p, Param::kAccXTempComp);
  c.gyro_bias = three(p, Param::kGyroXBias);
  c.mag_bias = three(p, Param::kMagXBias);
  c.mag_soft_iron.row(0) = three(p, Param::kMagCalA00).transpose();
  c.mag_soft_iron.row(1) = three(p, Param::kMagCalA10).transpose();
  c.mag_soft_iron.row(2) = three(p, Param::kMagCalA20).transpose();
  c.diff_pressure_bias_Pa = p.get_float(Param::kDiffPressBias);
  c.gyro_low_pass_Hz = p.get_float(Param::kGyroLpfHz);
  c.gyro_notch_Hz = p.get_float(Param::kGyroNotchHz);
  c.gyro_notch_width_Hz = p.get_float(Param::kGyroNotchBw);
  c.battery_voltage_lpf = p.get_float(Param::kBattVoltLpf);
  c.battery_current_lpf = p.get_float(Param::kBattCurrLpf);
  return c;
}

Estimator::Config estimator_settings(const Parameters& p) {
  Estimator::Config c;
  c.init_time = hal::milliseconds(p.get_int(Param::kFiltInitT));
  c.acc_kp = p.get_float(Param::kFiltAccKp);
  c.ki = p.get_float(Param::kFiltKi);
  c.ext_kp = p.get_float(Param::kFiltExtKp);
  c.acc_margin = p.get_float(Param::kFiltAccMargin);
  c.acc_lpf = p.get_float(Param::kAccLpf);
  c.gyro_xy_lpf = p.get_float(Param::kGyroXyLpf);
  c.gyro_z_lpf = p.get_float(Param::kGyroZLpf);
  c.quadratic_rates = p.get_bool(Param::kFiltQuadInt);
  c.exact_step = p.get_bool(Param::kFiltMatExp);
  c.use_acc = p.get_bool(Param::kFiltUseAcc);
  c.fixed_wing = p.get_bool(Param::kFixedWing);
  return c;
}

Rc::Config rc_settings(const Parameters& p) {
  Rc::Config c;
  c.channel_count = channel(p, Param::kRcNumChn);
  c.roll = channel(p, Param::kRcXChn);
  c.pitch = channel(p, Param::kRcYChn);
  c.throttle = channel(p, Param::kRcFChn);
  c.yaw = channel(p, Param::kRcZChn);
  c.switch_channel = {channel(p, Param::kRcArmChn), channel(p, Param::kRcAttOvrdChn),
                      channel(p, Param::kRcThrOvrdChn), channel(p, Param::kRcAttCtrlChn)};
  const auto first = static_cast<std::uint16_t>(Param::kSwitch5Dir);
  for (std::size_t k = 0; k < c.direction.size(); ++k) {
    c.direction[k] = static_cast<std::int8_t>(p.get_int(static_cast<Param>(first + k)));
  }
  c.arm_threshold = p.get_float(Param::kRcArmThreshold);
  return c;
}

CommandManager::Config command_settings(const Parameters& p, const Rc& rc, bool override_whole) {
  CommandManager::Config c;
  c.fixed_wing = p.get_bool(Param::kFixedWing);
  c.throttle_axis = throttle_axis(p);
  c.angle_mode = p.get_bool(Param::kRcAttMode);
  c.type_switch_mapped = rc.mapped(Switch::kAttitudeType);
  c.max_roll_rad = p.get_float(Param::kRcMaxRoll);
  c.max_pitch_rad = p.get_float(Param::kRcMaxPitch);
  c.max_roll_rate_rad_s = p.get_float(Param::kRcMaxRollrate);
  c.max_pitch_rate_rad_s = p.get_float(Param::kRcMaxPitchrate);
  c.max_yaw_rate_rad_s = p.get_float(Param::kRcMaxYawrate);
  c.max_throttle = p.get_float(Param::kRcMaxThr);
  c.stick_deviation = p.get_float(Param::kRcOvrdDev);
  c.stick_hold = hal::milliseconds(p.get_int(Param::kRcOvrdLagT));
  c.take_min_throttle = p.get_bool(Param::kTakeMinThr);
  c.offboard_timeout = hal::milliseconds(p.get_int(Param::kOffboardTimeout));
  c.failsafe_throttle = p.get_float(Param::kFailsafeThr);
  c.offboard_hold = hal::milliseconds(p.get_int(Param::kOffboardHold));
  c.companion_in_failsafe = p.get_bool(Param::kFailsafeOffbrd);
  c.fixed_wing_holds = c.fixed_wing && p.get_bool(Param::kFwAngleHold);
  c.override_whole = override_whole;
  return c;
}

MotorModel motor_settings(const Parameters& p) {
  MotorModel m;
  m.resistance_ohm = p.get_float(Param::kMotorResistance);
  m.kv_V_s_rad = p.get_float(Param::kMotorKv);
  m.no_load_current_A = p.get_float(Param::kNoLoadCurrent);
  m.prop_diameter_m = p.get_float(Param::kPropDiameter);
  m.prop_ct = p.get_float(Param::kPropCt);
  m.prop_cq = p.get_float(Param::kPropCq);
  m.full_voltage_V = p.get_float(Param::kBattVoltMax);
  m.motor_count = p.get_int(Param::kNumMotors);
  return m;
}

Controller::Config controller_settings(const Parameters& p, float max_thrust_N) {
  Controller::Config c;
  c.roll_rate = gains(p, Param::kPidRollRateP);
  c.pitch_rate = gains(p, Param::kPidPitchRateP);
  c.yaw_rate = gains(p, Param::kPidYawRateP);
  c.roll_angle = gains(p, Param::kPidRollAngP);
  c.pitch_angle = gains(p, Param::kPidPitchAngP);
  c.tau_s = p.get_float(Param::kPidTau);
  const Vector3 trim = three(p, Param::kXEqTorque);
  c.equilibrium_torque = {trim.x(), trim.y(), trim.z()};
  // Calibrating speed controllers takes the whole range of the stick.
  c.max_throttle = calibrates_escs(p) ? 1.0f : p.get_float(Param::kRcMaxThr);
  c.max_thrust_N = max_thrust_N;
  return c;
}

Mixer::Config mixer_settings(const Parameters& p, float max_thrust_N) {
  Mixer::Config c;
  c.fixed_wing = p.get_bool(Param::kFixedWing);
  c.reverse_aileron = p.get_bool(Param::kRevAileron);
  c.reverse_elevator = p.get_bool(Param::kRevElevator);
  c.reverse_rudder = p.get_bool(Param::kRevRudder);
  c.use_motor_model = uses_motor_model(p);
  c.unsigned_throttle = calibrates_escs(p);
  c.spin_when_armed = p.get_bool(Param::kArmSpinMotors) && !calibrates_escs(p);
  c.idle_throttle = p.get_float(Param::kMotorIdleThr);
  c.throttle_axis = throttle_axis(p);
  c.max_thrust_N = max_thrust_N;
  c.motor = motor_settings(p);
  return c;
}

}  // namespace rosflight::core
