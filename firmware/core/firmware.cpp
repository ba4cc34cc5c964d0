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
  board_.system.feed_watchdog();
  const Time busy_before = board_.system.busy_time();
  max_pass_ = std::max(max_pass_, now - pass_begin_);
  pass_begin_ = now;

  // Only changes by handle() between two passes; all others were applied by supervise().
  if (parameters_.has_changes()) apply_parameter_changes();
  sense(now);
  float dt_s = 0.0f;
  if (sensors_.measurements().new_imu && time_step(dt_s)) control(now, dt_s);
  telemetry_.stream(sensors_.measurements(), estimator_.estimate());

  receive(now);
  supervise(now);
  read_pilot(now);
  decide(now);

  report_sensor_changes();
  if (telemetry_.tick(now, parameters_.get_bool(Param::kFixedWing))) {
    telemetry_.send(status());
    if (turning()) moved_ = now;
    report_losses(now);
    report_sensors(now);
  }
  if (next_check_ < kCheckCount) report_checks(now);
  telemetry_.send_backlog(now, {mixer_.outputs(), rc_frame_}, parameters_, log_);
  counters_.pass(now, board_.system.busy_time() - busy_before, stored_);
  stored_ = false;
  if (now >= reboot_at_ && !store_.busy()) {
    reboot_at_ = Time::max();
    board_.outputs.disable();
    board_.system.reset(reboot_to_bootloader_);
  }
}

void Firmware::start() {
  const Time started = board_.clock.now();
  note(Event::kInitialized, started);
  board_.leds.set(hal::Led::kOverride, false);
  board_.leds.set(hal::Led::kStatus, false);
  const StoreResult loaded = load_parameters();
  if (loaded != StoreResult::kOk) log_.warning("Unable to load parameters, using defaults");
  // Only onto blank storage: a set that cannot be read now may be valid at the next start.
  if (loaded == StoreResult::kBlank) static_cast<void>(save_parameters());
  static_cast<void>(parameters_.take_changes());
  parameters_.mark_all_reported();

  const bool saved = !parameters_.unsaved();
  apply_mixers();
  // Rows that follow from the stored choice of mixer follow from it again at the next start.
  if (saved) parameters_.mark_saved(parameters_.version());
  static_cast<void>(parameters_.take_changes());
  if (!board_.receiver.start(static_cast<hal::ReceiverType>(parameters_.get_int(Param::kRcType)))) {
    log_.warning("RC_TYPE: this board has no such receiver");
  }
  codec_.set_system_id(static_cast<std::uint8_t>(parameters_.get_int(Param::kSysId)));
  constexpr std::uint32_t kBitsPerByte = 10;  // with start and stop bit
  const auto baud = static_cast<std::uint32_t>(parameters_.get_int(Param::kBaudRate));
  if (board_.serial.open(baud,
                         static_cast<std::uint8_t>(parameters_.get_int(Param::kSerialDevice)))) {
    telemetry_.set_line(baud / kBitsPerByte);
  } else {
    log_.warning("SERIAL_DEVICE, BAUD_RATE: board uses its own");
  }
  board_.system.start_sensors();
  bool ok = false;
  for (std::size_t k = 0; const char* text = board_.system.sensor_message(k, ok); ++k) {
    log_.push(ok ? Severity::kInfo : Severity::kError, text);
    if (!ok) reported_sensor_errors_ = board_.system.sensor_errors();
  }
  if (learned_.built_in()) describe_policy();
  apply_settings();
  static_cast<void>(parameters_.take_changes());  // rows that the choice of mixer has filled in
  rc_.describe(log_);
  check_calibration();
  estimator_.reset();
  recover_from_crash(started);
  if (!state_.armed()) {
    sensors_.start_baro_calibration();
    if (parameters_.get_float(Param::kDiffPressBias) == 0.0f) sensors_.start_airspeed_calibration();
  }
  last_imu_ = pass_begin_ = board_.clock.now();
  decide(last_imu_);
}

// ---- the steps of a pass

void Firmware::sense(Time now) {
  const Sensors::CalibrationEvents events = sensors_.step(now, board_, parameters_, log_);
  sensor_watch_.step(now, sensors_.measurements());
  if (sensors_.measurements().new_imu) {
    last_imu_ = now;
    counters_.imu(now, sensors_.measurements().imu.stamp);
    if (state_.has(Error::kImuNotResponding)) set_error(Error::kImuNotResponding, false);
    if (state_.has(Error::kTimeGoingBackwards)) set_error(Error::kTimeGoingBackwards, false);
  } else if (sensors_.imu_step().backwards && !state_.has(Error::kTimeGoingBackwards)) {
    set_error(Error::kTimeGoingBackwards, true);
  }
  if (events.any()) finish_calibration(events, now);
  if (sensors_.measurements().new_baro && mixer_.config().use_motor_model) update_max_thrust();
  if (sensors_.measurements().new_battery) {
    correct_throttle();
    watch_battery(now);
  }
}

void Firmware::finish_calibration(const Sensors::CalibrationEvents& events, Time now) {
  if (events.accel_settled) estimator_.reset();
  if (events.accel_done) {
    accel_calibrated_ = true;  // the result itself may be zero
    set_error(Error::kUncalibratedImu, false);
  }
  if (events.gyro_done) {
    estimator_.settle();
    moved_ = now - kStillTime;  // it did not move meanwhile
    if (rc_.arm_switch_off()) {
      note(Event::kDisarm, now);
    } else {
      act(state_.handle(Event::kCalibrationComplete, arm_request(now)), now);
    }
    continue_save(now);  // the new biases fit one block: armed before this pass's control
  }
  if (events.gyro_failed) note(Event::kCalibrationFailed, now);
}

bool Firmware::time_step(float& dt_s) {
  const ImuClock::Step& step = sensors_.imu_step();
  dt_s = step.dt_s;
  return !step.restarted || dt_s > 0.0f;  // the first sample only sets the clock
}

/// Acceleration is no error: in flight the accelerometer may be useless for as long as the gyro can do without it.
void Firmware::judge_estimator() {
  const bool has = state_.has(Error::kUnhealthyEstimator);
  const bool in_flight = state_.armed() && !has;
  const bool healthy = in_flight ? estimator_.healthy_in_flight() : estimator_.healthy();
  if (healthy == has) set_error(Error::kUnhealthyEstimator, !healthy);
}

/// Conditions of the mixer, besides its inputs.
inline Mixer::Conditions Firmware::mixer_conditions(Time now) {
  const Measurements& m = sensors_.measurements();
  Mixer::Conditions c;
  c.density_kg_m3 = m.density_kg_m3;
  c.battery_V = m.battery.voltage_V;
  c.armed = motors_enabled();
  c.hold_idle = motor_stop_.probing() || (holding_idle_ && still_holding_idle(now));
  if (mixer_.has_auxiliary_motors()) {
    c.failsafe = command_.in_failsafe();
    c.companion_present = now - last_companion_frame_ <= kCompanionSilence;
  }
  if (state_.state() == State::kMotorTest) {
    c.test_motor = test_motor_;
    c.test_value = test_value_;
  }
  return c;
}

bool Firmware::is_request(const link::Message& message) {
  return std::holds_alternative<link::ParamSet>(message) ||
         std::holds_alternative<link::ParamRequestRead>(message) ||
         std::holds_alternative<link::CommandRequest>(message);
}

bool Firmware::is_command(const link::Message& message) {
  return std::holds_alternative<link::OffboardControl>(message) ||
         std::holds_alternative<link::AuxCommand>(message);
}

void Firmware::control(Time now, float dt_s) {
  const Measurements& m = sensors_.measurements();
  const AttitudeEstimate& attitude = estimator_.step(m.imu, dt_s);
  if (estimator_.healthy() == state_.has(Error::kUnhealthyEstimator)) judge_estimator();
  const CommandVector& command =
      learned_.built_in() ? learned_command(attitude, dt_s) : command_.combined();
  Mixer::Conditions conditions = mixer_conditions(now);
  conditions.primary_axes = command_.primary_axes();
  if (learned_.flying() && learned_.of_motors()) {
    board_.outputs.write(mixer_.step_motors(learned_.motors(), conditions));
  } else {
    const auto& forces =
        controller_.step(command, attitude, dt_s, state_.armed(), mixer_.saturated());
    board_.outputs.write(mixer_.step(forces, conditions));
  }
  if (mixer_.config().fixed_wing && state_.armed() && above_idle()) powered_ = now;
  if (!state_.armed() || motor_stop_.watching(state_.failsafe())) watch_motion(now);
  constexpr float kWorthAText = 2.0f;
  if (mixer_.saturation() > kWorthAText && saturation_texts_.allow(now)) {
    log_.warning(Text("Motor command above full: x ").add(mixer_.saturation(), 2));
  }
  if (mixer_.motor_model_failed() && motor_model_texts_.allow(now)) {
    log_.error("No battery voltage or no MOTOR_KV: motors off");
  }
  if (mixer_.voltage_replaced() && motor_model_texts_.allow(now)) {
    log_.error("Battery voltage out of range");
  }
  const Time took = board_.clock.now() - now;
  loop_time_us_ = static_cast<std::int16_t>(
      std::min<std::int64_t>(took.count(), std::numeric_limits<std::int16_t>::max()));
}

void Firmware::receive(Time now) {
  if (incoming_used_ == incoming_size_ && !refill()) {
    queue_ = Queue::kEmpty;
  } else {
    take_messages(now);
  }
}

void Firmware::take_messages(Time now) {
  int messages_left = kMessagesPerPass;
  std::size_t bytes_left = kBytesPerPass;
  do {
    const std::size_t waiting = std::min(incoming_size_ - incoming_used_, bytes_left);
    const auto result = codec_.decode(incoming_.data() + incoming_used_, waiting);
    incoming_used_ += result.consumed;
    bytes_left -= result.consumed;
    if (result.complete) {
      if (queue_ != Queue::kStale || !is_command(codec_.message())) handle(codec_.message(), now);
      messages_left -= is_request(codec_.message()) ? kRequestCounts : 1;
    }
    if (messages_left <= 0 || bytes_left == 0) {
      if (queue_ == Queue::kEmpty) queue_ = Queue::kWaiting;
      return;
    }
  } while (incoming_used_ < incoming_size_ || refill());
  queue_ = Queue::kEmpty;
}

bool Firmware::refill() {
  incoming_used_ = 0;
  incoming_size_ = board_.serial.read(incoming_.data(), incoming_.size());
  return incoming_size_ > 0;
}

void Firmware::supervise(Time now) {
  if (parameters_.has_changes()) apply_parameter_changes();
  if (now - last_imu_ > kImuSilence) watch_imu(now);
  if (store_.busy() || save_requested_) continue_save(now);
  if (state_.state() == State::kMotorTest) watch_motor_test(now);
  if (motor_stop_.stopped()) report_motor_stop();
  if (mixer_.has_auxiliary_motors() && mixer_.end_auxiliary_motors(mixer_conditions(now))) {
    board_.outputs.write(mixer_.outputs());
  }
  act(state_.update(), now);
  show_leds(now);
}

void Firmware::read_pilot(Time now) {
  if (!board_.receiver.poll(rc_frame_)) {
    if (rc_.silent(now)) lose_receiver(now);
    return;
  }
  telemetry_.note_rc();
  const Rc::Update update = rc_.step(now, &rc_frame_, state_.arming());
  if (update.lost) lose_receiver(now);
  if (update.found && (state_.has(Error::kRcLost) || state_.failsafe())) {
    note(Event::kRcFound, now);
  }
  if (update.disarm) note(Event::kDisarm, now);
  if (update.arm) request_arming(now);
  pilot_new_ = update.frame;
}

void Firmware::lose_receiver(Time now) {
  if (!state_.has(Error::kRcLost)) note(Event::kRcLost, now);
}

void Firmware::decide(Time now) {
  if (command_.update(now, rc_.input(), pilot_new_, state_.failsafe())) telemetry_.request_status();
  pilot_new_ = false;
}

// ---- supervision

void Firmware::act(Actions actions, Time now) {
  if (actions == action::kNone) return;
  if ((actions & action::kSendStatus) != 0) telemetry_.request_status();
  if ((actions & action::kStopMotorTest) != 0) stop_motors();
  if ((actions & action::kArm) != 0) armed_now(actions, now);
  if ((actions & action::kDisarm) != 0) disarmed_now(now);
  if ((actions & action::kCalibrateGyro) != 0) {
    sensors_.start_gyro_calibration();
    if (parameters_.unsaved()) begin_save();
  }
  if ((actions & action::kStopCalibration) != 0) sensors_.stop_calibrations();
  if ((actions & action::kSave) != 0) begin_save();
  if ((actions & action::kRefuse) != 0) refuse(now);
  if ((actions & action::kRefuseStorage) != 0) {
    log_.error("Unable to arm: parameters not stored");
  }
}

void Firmware::note(Event event, Time now) {
  act(state_.handle(event), now);
}

void Firmware::set_error(Error error, bool on) {
  act(on ? state_.set_error(error) : state_.clear_error(error), board_.clock.now());
}

void Firmware::watch_imu(Time now) {
  if (!state_.has(Error::kImuNotResponding)) {
    set_error(Error::kImuNotResponding, true);
    log_.critical("IMU not responding");
  }
  if (state_.armed()) {
    if (now - last_imu_ <= kImuHold) return;  // the last outputs hold
    motor_stop_.watch_imu(now, last_imu_);
  }
  constexpr Time kFallbackPeriod = hal::milliseconds(20);
  if (now - fallback_written_ < kFallbackPeriod) return;
  fallback_written_ = now;
  if (!parameters_.get_bool(Param::kFixedWing)) {
    mixer_.stop_motors();
  } else {
    const CommandVector& c = state_.failsafe() ? command_.combined() : command_.pilot();
    static_cast<void>(mixer_.step(controller_.trimmed(c.value), mixer_conditions(now)));
  }
  board_.outputs.write(mixer_.outputs());
}

void Firmware::watch_battery(Time now) {
  if (state_.armed() && battery_low() && battery_texts_.allow(now)) {
    const float voltage_V = sensors_.measurements().battery.voltage_V;
    log_.warning(Text("Low battery: ").add(voltage_V, 1).add(" V"));
  }
}

void Firmware::show_leds(Time now) {
  bool status = state_.armed();
  if (state_.failsafe() || state_.error()) {
    const std::uint32_t half_period_ms = state_.failsafe() ? 100 : 500;
    status = static_cast<std::uint32_t>(hal::to_ms(now)) / half_period_ms % 2 == 0;
  }
  const std::array<bool, 2> wanted{command_.override_word() != 0, status};
  if (wanted[0] != leds_[0]) board_.leds.set(hal::Led::kOverride, wanted[0]);
  if (wanted[1] != leds_[1]) board_.leds.set(hal::Led::kStatus, wanted[1]);
  leds_ = wanted;
}

link::Status Firmware::status() const {
  const CommandVector& c = command_.combined();
  link::Status s;
  s.armed = state_.armed();
  s.failsafe = command_.in_failsafe();
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
