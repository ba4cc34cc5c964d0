// SPDX-License-Identifier: BSD-3-Clause
// The part of Firmware that arms and disarms.
#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/core/firmware.hpp"
#include "firmware/core/mixer_frames.hpp"

namespace rosflight::core {
namespace {

constexpr float kStillRate_rad_s = 0.3f;
constexpr float kLevelCosine = 0.965925826f;  // cos(15 deg)
constexpr float kLowBatteryFraction = 0.8f;
constexpr float kBatteryConnected_V = 1.0f;
constexpr float kIdleMargin = 0.005f;

}  // namespace

// ---- the list before arming

CheckResults Firmware::checks(Time now) const {
  const Quaternion& q = estimator_.estimate().q_WB;
  CheckInputs in;
  in.errors = state_.errors();
  constexpr auto kEscs = static_cast<std::int32_t>(MixerId::kEscCalibration);
  in.esc_calibration = parameters_.get_int(Param::kPrimaryMixer) == kEscs ||
                       parameters_.get_int(Param::kSecondaryMixer) == kEscs;
  in.throttle_low = rc_.throttle_low();
  in.override_ok =
      parameters_.get_bool(Param::kTakeMinThr) || rc_.input().is_on(Switch::kThrottleOverride);
  in.still = now - moved_ >= kStillTime;
  in.level = 1.0f - 2.0f * (q.x * q.x + q.y * q.y) >= kLevelCosine;
  for (std::size_t k = 0; k < kAidCount; ++k) {
    in.sensor_silent = in.sensor_silent || sensor_watch_.silent(static_cast<Aid>(k), now);
  }
  in.storage_healthy = storage_healthy_;
  in.loop_in_time = counters_.in_time(now);
  const bool battery_seen = sensor_watch_.answered(Aid::kBattery);
  const float battery_V = sensors_.measurements().battery.voltage_V;
  const bool motors_known =  // false for NaN
      battery_seen && battery_V > kBatteryConnected_V && max_thrust_N_ > 0.0f;
  in.motor_model_unusable = mixer_.config().use_motor_model && !motors_known;
  in.battery_low = battery_seen && battery_low();
  in.level_refuses = parameters_.get_bool(Param::kCheckLevel);
  in.battery_refuses = parameters_.get_bool(Param::kCheckBattery);
  in.shares_processor = board_.system.shares_processor();
  return run_checks(in);
}

bool Firmware::battery_low() const {
  const float voltage_V = sensors_.measurements().battery.voltage_V;
  return voltage_V > kBatteryConnected_V &&
         voltage_V < kLowBatteryFraction * parameters_.get_float(Param::kBattVoltMax);
}

Text Firmware::check_text(Check check, Time now) const {
  Text text{kChecks[static_cast<std::size_t>(check)].text};
  if (check != Check::kSensors) return text;
  for (std::size_t k = 0; k < kAidCount; ++k) {
    if (sensor_watch_.silent(static_cast<Aid>(k), now)) text.add(" ").add(kAidNames[k]);
  }
  return text;
}

void Firmware::refuse(Time now) {
  if (!refusals_.allow(now)) return;
  const CheckResults results = checks(now);
  for (const CheckRow& row : kChecks) {
    if (results.of(row.check) != Verdict::kRefuses) continue;
    log_.error(Text("Unable to arm: ").add(check_text(row.check, now)));
  }
}

void Firmware::warn_before_arming(Time now) {
  const CheckResults results = checks(now);
  for (const CheckRow& row : kChecks) {
    if (results.of(row.check) != Verdict::kWarning) continue;
    const Text text = Text("Arming: ").add(check_text(row.check, now));
    log_.push(row.check == Check::kEscCalibration ? Severity::kCritical : Severity::kWarning, text);
  }
}

void Firmware::report_checks(Time now) {
  if (!telemetry_.has_room()) return;
  const CheckRow& row = kChecks[next_check_];
  const Verdict verdict = checks(now).of(row.check);
  link::CheckResult line;
  line.index = static_cast<std::uint8_t>(next_check_);
  line.count = static_cast<std::uint8_t>(kCheckCount);
  line.result = static_cast<std::uint8_t>(verdict);
  line.name = padded_name(row.name);
  if (verdict != Verdict::kPass) line.reason = check_text(row.check, now).chars();
  telemetry_.send(line);
  ++next_check_;
}

// ---- arming and disarming

ArmRequest Firmware::arm_request(Time now) const {
  CheckResults results = checks(now);
  const bool calibrate = parameters_.get_bool(Param::kArmCalGyro);
  if (calibrate && state_.state() == State::kPreflight) {
    // Before the gyro's offset is known, rates and attitude show no motion; its calibration does.
    results.pass(Check::kStill);
    results.pass(Check::kLevel);
  }
  return {results.ready(), calibrate, parameters_.unsaved() || store_.busy()};
}

/// Armed, or disarmed so recently that the vehicle may still be in the air.
bool Firmware::in_flight(Time now) const {
  return state_.armed() || (rearm_in_air_ && now - disarmed_ <= kRearmInAir);
}

void Firmware::request_arming(Time now) {
  if (in_flight(now)) {
    note(Event::kArmInAir, now);
  } else {
    act(state_.handle(Event::kArm, arm_request(now)), now);
  }
}

void Firmware::armed_now(Actions actions, Time now) {
  const bool in_air = (actions & action::kInAir) != 0;
  if (reboot_at_ != Time::max()) log_.warning("Reboot cancelled by arming");
  reboot_at_ = Time::max();
  controller_.reset();
  if (!in_air && sensors_.calibrating_imu()) estimator_.settle();
  sensors_.stop_calibrations();
  motor_stop_.reset();
  mixer_.drop_auxiliary_motors();
  stop_reported_ = rearm_in_air_ = false;
  holding_idle_ = !in_air;
  idle_until_ = now + kIdleFirst;
  command_.arm(now, in_air);
  if (!in_air) {
    powered_ = Time::min() / 2;
    command_.forget_offboard();
    if (queue_ == Queue::kWaiting) queue_ = Queue::kStale;
    warn_before_arming(now);
  }
  log_.warning(in_air ? "Armed in the air" : "Armed");
}

void Firmware::disarmed_now(Time now) {
  rearm_in_air_ = above_idle();
  disarmed_ = now;
  learned_.reset();
  command_.disarm();
  motor_stop_.reset();
  holding_idle_ = false;
  stop_motors();
  log_.warning("Disarmed");
}

void Firmware::stop_motors() {
  mixer_.stop_motors();
  board_.outputs.write(mixer_.outputs());
}

bool Firmware::above_idle() const {
  const float idle = parameters_.get_float(Param::kMotorIdleThr) + kIdleMargin;
  for (std::size_t k = 0; k < kChannels; ++k) {
    if (mixer_.header().type[k] == OutputType::kMotor && mixer_.outputs()[k] > idle) return true;
  }
  return false;
}

/// A fixed wing whose motor was above idle not long ago may be in the air.
bool Firmware::may_glide(Time now) const {
  return mixer_.config().fixed_wing && now - powered_ <= kGlide;
}

bool Firmware::still_holding_idle(Time now) {
  holding_idle_ = now < idle_until_ && rc_.throttle_low() && !command_.offboard_active();
  return holding_idle_;
}

bool Firmware::turning() const {
  // In this order of comparison a NaN counts as motion.
  const float rate_sq = estimator_.estimate().rates_rad_s.squaredNorm();
  return !(rate_sq < kStillRate_rad_s * kStillRate_rad_s);
}

void Firmware::watch_motion(Time now) {
  const AttitudeEstimate& attitude = estimator_.estimate();
  if (!state_.armed()) {
    if (turning()) moved_ = now;
    return;
  }
  const Measurements& m = sensors_.measurements();
  const bool throttle = above_idle();
  // Without a receiver rest counts if the failsafe command flies, or the companion commands idle.
  const bool rest_counts = command_.in_failsafe() || (state_.failsafe() && !throttle);
  motor_stop_.step(now, {attitude.q_WB, to_vector(m.imu.accel_m_s2), attitude.rates_rad_s,
                         m.altitude_m, throttle, rest_counts});
}

void Firmware::report_motor_stop() {
  if (stop_reported_) return;
  stop_reported_ = true;
  stop_motors();
  switch (motor_stop_.reason()) {
    case StopReason::kImuSilent:
      log_.critical("Motors stopped until disarmed: IMU silent for 1 s");
      break;
    case StopReason::kTipOver:
      log_.critical("Motors stopped until disarmed: tipped over");
      break;
    case StopReason::kImpact:
      log_.critical("Motors stopped until disarmed: impact");
      break;
    case StopReason::kFailsafeAtRest:
      log_.critical("Motors stopped: on ground, 30 s without RC");
      break;
    case StopReason::kNone:
      break;
  }
}

// ---- motor test

void Firmware::on(const link::MotorTest& message, Time now) {
  if (!is_me(message.target_system)) return;
  const bool motor = mixer_.is_motor(message.motor);
  const bool in_range = message.value >= 0.0f && message.value <= kMotorTestLimit;  // false for NaN
  const auto wanted = static_cast<std::int8_t>(message.motor);
  if (state_.state() == State::kMotorTest) {
    if (!motor || !in_range || wanted != test_motor_) {
      note(Event::kMotorTestEnd, now);
      return;
    }
  } else {
    if (motor && in_range && !in_flight(now)) note(Event::kMotorTest, now);
    if (state_.state() != State::kMotorTest) {
      if (motor_test_texts_.allow(now)) {
        log_.error(Text("Motor test refused: ")
                       .add(!motor      ? "no motor on that output"
                            : !in_range ? "value not in 0..0.3"
                                        : "not in preflight state"));
      }
      return;
    }
    log_.warning(Text("Motor test: output ").add(static_cast<std::int32_t>(message.motor)));
  }
  test_motor_ = wanted;
  test_value_ = message.value;
  test_until_ = now + kMotorTestTime;
}

void Firmware::watch_motor_test(Time now) {
  if (now >= test_until_) note(Event::kMotorTestEnd, now);
}

// ---- faults

void Firmware::record_fault(const std::array<std::uint32_t, 8>& registers) {
  CrashRecord record;
  record.fault_count = static_cast<std::uint16_t>(fault_count_ + 1);
  record.error_word = state_.errors();
  record.armed = state_.armed();
  record.registers = registers;
  const Time now = board_.clock.now();
  record.above_idle = above_idle() || may_glide(now);
  record.motion = estimator_.motion();
  record.motion_age = now - record.motion.stamp;
  const std::int64_t uptime_ms = hal::to_ms(now);
  for (std::size_t k = 0; k < rearm_ages_ms_.size(); ++k) {
    record.rearm_age_ms[k] = static_cast<std::uint32_t>(
        std::min<std::int64_t>(rearm_ages_ms_[k] + uptime_ms, CrashRecord::kNever));
  }
  static_cast<void>(write_crash_record(board_.backup, record));
}

void Firmware::recover_from_crash(Time started) {
  CrashRecord record;
  if (!take_crash_record(board_.backup, record)) return;
  fault_count_ = record.fault_count;
  rearm_ages_ms_ = record.rearm_age_ms;
  const Time now = board_.clock.now();
  act(state_.update(), now);
  if (record.may_rearm()) note(Event::kArmInAir, now);
  if (state_.armed()) {
    rearm_ages_ms_ = {0, record.rearm_age_ms[0], record.rearm_age_ms[1]};
    record.motion.stamp = started - record.motion_age;
    estimator_.resume_in_flight(record.motion);
    powered_ = now;
    log_.critical("Rearmed after a fault in flight");
  } else if (record.armed) {
    log_.critical(record.above_idle ? "Fault in flight, but rearming failed"
                                    : "Fault at idle: not rearmed");
  }
  telemetry_.report_crash(record, state_.armed());
  log_.critical(Text("Fault ").add(record.fault_count).add(" at pc ").add_hex(record.pc()));
}

}  // namespace rosflight::core
