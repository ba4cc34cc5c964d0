// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/firmware.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "firmware/core/version.hpp"

namespace rosflight::core {

Firmware::Firmware(const hal::Board& board, link::Codec& codec)
    : board_{board}, codec_{codec}, store_{board_.storage}, telemetry_{board_.serial, codec} {}

void Firmware::run() {
  const Time now = board_.clock.now();
  board_.system.alive();
  longest_pass_ = std::max(longest_pass_, now - pass_begin_);
  pass_begin_ = now;

  sense(now);
  float dt_s = 0.0f;
  if (sensors_.measurements().new_imu && time_step(dt_s)) control(now, dt_s);
  telemetry_.stream(now, sensors_.measurements(), estimator_.estimate(), mixer_.outputs());

  receive(now);
  supervise(now);
  listen_to_pilot(now);
  decide(now);

  if (telemetry_.tick(now, parameters_.get_bool(Param::kFixedWing))) telemetry_.send(status());
  telemetry_.send_backlog(parameters_, log_);
  if (now >= reboot_at_) {
    reboot_at_ = Time::max();
    board_.outputs.disable();
    board_.system.reset(reboot_to_bootloader_);
  }
}

void Firmware::start() {
  act(state_.handle(Event::kInitialized), board_.clock.now());
  board_.leds.set(hal::Led::kOverride, false);
  board_.leds.set(hal::Led::kStatus, false);
  const StoreResult loaded = load_parameters();
  if (loaded != StoreResult::kOk) log_.warning("Unable to load parameters, using defaults");
  // Only over nothing: a set that cannot be read today may still be there tomorrow.
  if (loaded == StoreResult::kBlank) static_cast<void>(save_parameters());
  static_cast<void>(parameters_.take_changes());
  parameters_.mark_all_reported();

  apply_mixers();
  if (!board_.receiver.start(static_cast<hal::ReceiverType>(parameters_.get_int(Param::kRcType)))) {
    log_.warning("RC_TYPE: this board has no such receiver");
  }
  codec_.set_system_id(static_cast<std::uint8_t>(parameters_.get_int(Param::kSysId)));
  if (!board_.serial.open(static_cast<std::uint32_t>(parameters_.get_int(Param::kBaudRate)),
                          static_cast<std::uint8_t>(parameters_.get_int(Param::kSerialDevice)))) {
    log_.warning("SERIAL_DEVICE, BAUD_RATE: board uses its own");
  }
  board_.system.start_sensors();
  bool ok = false;
  for (std::size_t k = 0; const char* text = board_.system.sensor_message(k, ok); ++k) {
    log_.push(ok ? Severity::kInfo : Severity::kError, text);
  }
  apply_settings();
  rc_.describe(log_);
  check_calibration();
  estimator_.reset();
  recover_from_crash();
  if (!state_.armed()) {
    sensors_.start_baro_calibration();
    if (parameters_.get_float(Param::kDiffPressBias) == 0.0f) sensors_.start_airspeed_calibration();
  }
  imu_heard_ = pass_begin_ = board_.clock.now();
  decide(imu_heard_);
}

// ---- the steps of a pass

void Firmware::sense(Time now) {
  const Sensors::CalibrationEvents events = sensors_.step(now, board_, parameters_, log_);
  if (sensors_.measurements().new_imu) {
    imu_heard_ = now;
    if (state_.has(Error::kImuNotResponding)) set_error(Error::kImuNotResponding, false);
  }
  if (events.accel_settled) estimator_.reset();
  if (events.accel_done) set_error(Error::kUncalibratedImu, false);
  if (events.gyro_done) {
    estimator_.clear_bias();
    act(state_.handle(Event::kCalibrationComplete), now);
  }
  if (events.gyro_failed) act(state_.handle(Event::kCalibrationFailed), now);
  if (sensors_.measurements().new_baro && mixer_.config().use_motor_model) update_max_thrust();
  if (sensors_.measurements().new_battery) watch_battery(now);
}

bool Firmware::time_step(float& dt_s) {
  const Time stamp = sensors_.measurements().imu.stamp;
  const Time previous = imu_stamp_;
  imu_stamp_ = stamp;
  if (!imu_known_) {
    imu_known_ = true;
    return false;
  }
  const bool backwards = stamp < previous;
  if (backwards != state_.has(Error::kTimeGoingBackwards)) {
    set_error(Error::kTimeGoingBackwards, backwards);
  }
  dt_s = hal::seconds(stamp - previous);
  return !backwards;
}

void Firmware::control(Time now, float dt_s) {
  const Measurements& m = sensors_.measurements();
  const AttitudeEstimate& attitude = estimator_.step(m.imu, dt_s);
  if (estimator_.healthy() == state_.has(Error::kUnhealthyEstimator)) {
    set_error(Error::kUnhealthyEstimator, !estimator_.healthy());
  }
  const auto& forces = controller_.step(command_.combined(), attitude, dt_s, state_.armed(),
                                        mixer_.saturation() > 1.0f);
  board_.outputs.write(mixer_.step(
      forces, {m.density_kg_m3, m.battery.voltage_V, state_.armed(), command_.primary_entries()}));
  constexpr float kWorthATest = 2.0f;
  if (mixer_.saturation() > kWorthATest && saturation_texts_.allow(now)) {
    log_.warning(Text("Motor command above full: x ").add(mixer_.saturation(), 2));
  }
  if (mixer_.motor_model_failed() && motor_model_texts_.allow(now)) {
    log_.error("No battery voltage or no MOTOR_KV: motors off");
  }
  const Time took = board_.clock.now() - now;
  loop_time_us_ = static_cast<std::int16_t>(
      std::min<std::int64_t>(took.count(), std::numeric_limits<std::int16_t>::max()));
}

void Firmware::receive(Time now) {
  constexpr int kMostReads = 16;        // 2 kB: 22 ms of a 921 600 baud line; the rest waits
  std::array<std::uint8_t, 128> bytes;  // NOLINT: read() fills what is used
  for (int k = 0; k < kMostReads; ++k) {
    const std::size_t count = board_.serial.read(bytes.data(), bytes.size());
    if (count == 0) return;
    for (std::size_t used = 0; used < count;) {
      const auto result = codec_.decode(bytes.data() + used, count - used);
      used += result.consumed;
      if (result.complete) handle(codec_.message(), now);
    }
  }
}

void Firmware::supervise(Time now) {
  if (parameters_.has_changes()) apply_parameter_changes();
  watch_imu(now);
  act(state_.update(), now);
  show_leds(now);
}

void Firmware::listen_to_pilot(Time now) {
  const bool received = board_.receiver.poll(rc_frame_);
  if (received) telemetry_.send_rc(now, rc_frame_);
  const Rc::Update update = rc_.step(now, received ? &rc_frame_ : nullptr, state_.armed());
  if (update.lost && !state_.has(Error::kRcLost)) act(state_.handle(Event::kRcLost), now);
  if (update.found && (state_.has(Error::kRcLost) || state_.failsafe())) {
    act(state_.handle(Event::kRcFound), now);
  }
  if (update.disarm) act(state_.handle(Event::kDisarm), now);
  if (update.arm) {
    const bool override_ok =
        parameters_.get_bool(Param::kTakeMinThr) || rc_.input().is_on(Switch::kThrottleOverride);
    act(state_.handle(Event::kArm,
                      {rc_.throttle_low(), override_ok, parameters_.get_bool(Param::kArmCalGyro)}),
        now);
  }
  pilot_new_ = update.frame;
}

void Firmware::decide(Time now) {
  if (command_.update(now, rc_.input(), pilot_new_, state_.failsafe())) telemetry_.request_status();
  pilot_new_ = false;
}

// ---- supervision

void Firmware::act(std::uint16_t actions, Time now) {
  if (actions == action::kNone) return;
  if ((actions & action::kSendStatus) != 0) telemetry_.request_status();
  if ((actions & action::kArm) != 0) {
    controller_.reset();
    sensors_.stop_calibrations();
    if (parameters_.unsaved()) static_cast<void>(save_parameters());
    log_.warning("Armed");
  }
  if ((actions & action::kDisarm) != 0) log_.warning("Disarmed");
  if ((actions & action::kCalibrateGyro) != 0) sensors_.start_gyro_calibration();
  refuse(actions, now);
}

void Firmware::refuse(std::uint16_t actions, Time now) {
  constexpr std::uint16_t kRefusals =
      action::kRefuseThrottle | action::kRefuseOverride | action::kRefuseErrors;
  if ((actions & kRefusals) == 0 || !refusals_.allow(now)) return;
  if ((actions & action::kRefuseThrottle) != 0) log_.error("Unable to arm: throttle not low");
  if ((actions & action::kRefuseOverride) != 0) {
    log_.error("Unable to arm: throttle override switch is off");
  }
  if ((actions & action::kRefuseErrors) == 0) return;
  struct Reason {
    Error error;
    const char* text;
  };
  constexpr std::array<Reason, 7> kReasons{
      {{Error::kInvalidMixer, "Unable to arm: invalid mixer"},
       {Error::kImuNotResponding, "Unable to arm: IMU not responding"},
       {Error::kRcLost, "Unable to arm: RC signal lost"},
       {Error::kUnhealthyEstimator, "Unable to arm: unhealthy estimator"},
       {Error::kTimeGoingBackwards, "Unable to arm: time going backwards"},
       {Error::kUncalibratedImu, "Unable to arm: IMU not calibrated"},
       {Error::kInvalidFailsafe, "Unable to arm: FAILSAFE_THR not set"}}};
  for (const Reason& reason : kReasons) {
    if (state_.has(reason.error)) log_.error(reason.text);
  }
}

void Firmware::set_error(Error error, bool on) {
  act(on ? state_.set_error(error) : state_.clear_error(error), board_.clock.now());
}

void Firmware::watch_imu(Time now) {
  if (now - imu_heard_ <= kImuSilence) return;
  if (!state_.has(Error::kImuNotResponding)) {
    set_error(Error::kImuNotResponding, true);
    log_.critical("IMU not responding");
  }
  constexpr Time kFallbackPeriod = hal::milliseconds(20);
  if (now - fallback_written_ < kFallbackPeriod) return;
  fallback_written_ = now;
  if (!parameters_.get_bool(Param::kFixedWing)) {
    mixer_.stop_motors();
  } else {
    const Measurements& m = sensors_.measurements();
    const CommandVector& c = state_.failsafe() ? command_.combined() : command_.pilot();
    static_cast<void>(mixer_.step(c.value, {m.density_kg_m3, m.battery.voltage_V, state_.armed()}));
  }
  board_.outputs.write(mixer_.outputs());
}

void Firmware::watch_battery(Time now) {
  constexpr float kLowFraction = 0.8f;
  constexpr float kConnected_V = 1.0f;
  const float voltage = sensors_.measurements().battery.voltage_V;
  const bool low =
      voltage > kConnected_V && voltage < kLowFraction * parameters_.get_float(Param::kBattVoltMax);
  if (low && state_.armed() && battery_texts_.allow(now)) {
    log_.warning(Text("Low battery: ").add(voltage, 1).add(" V"));
  }
}

void Firmware::show_leds(Time now) {
  bool status = state_.armed();
  if (state_.failsafe() || state_.error()) {
    const std::int64_t half_period_ms = state_.failsafe() ? 100 : 500;
    status = hal::to_ms(now) / half_period_ms % 2 == 0;
  }
  const std::array<bool, 2> wanted{command_.override_word() != 0, status};
  if (wanted[0] != leds_[0]) board_.leds.set(hal::Led::kOverride, wanted[0]);
  if (wanted[1] != leds_[1]) board_.leds.set(hal::Led::kStatus, wanted[1]);
  leds_ = wanted;
}

void Firmware::record_fault(const std::array<std::uint32_t, 8>& registers) {
  CrashRecord record;
  record.fault_count = static_cast<std::uint16_t>(fault_count_ + 1);
  record.error_word = state_.errors();
  record.armed = state_.armed();
  record.registers = registers;
  static_cast<void>(write_crash_record(board_.backup, record));
}

void Firmware::recover_from_crash() {
  CrashRecord record;
  if (!take_crash_record(board_.backup, record)) return;
  fault_count_ = record.fault_count;
  const Time now = board_.clock.now();
  act(state_.update(), now);
  if (record.armed) {
    act(state_.handle(Event::kArm, {true, true, false}), now);
    if (state_.armed()) {
      estimator_.reset_in_flight();
      log_.critical("Rearmed after a fault in flight");
    } else {
      log_.critical("Fault in flight, but rearming failed");
    }
  }
  telemetry_.report_crash(record, record.armed);
  log_.critical(Text("Fault ").add(record.fault_count).add(" at pc ").add_hex(record.pc()));
}

link::Status Firmware::status() const {
  const CommandVector& c = command_.combined();
  link::Status s;
  s.armed = state_.armed();
  s.failsafe = state_.failsafe();
  s.offboard = command_.offboard_active();
  s.rc_override = command_.override_word();
  s.error_code = static_cast<std::uint8_t>(state_.errors());
  const bool raw =
      parameters_.get_bool(Param::kFixedWing) || c.type[3] == CommandType::kPassThrough;
  s.control_mode = raw ? 0 : (c.type[3] == CommandType::kAngle ? 2 : 1);
  s.sensor_errors = static_cast<std::int16_t>(board_.system.sensor_errors());
  s.loop_time_us = loop_time_us_;
  return s;
}

}  // namespace rosflight::core
