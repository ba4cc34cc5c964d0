// SPDX-License-Identifier: BSD-3-Clause
// The part of Firmware that stores parameters and follows their changes.
#include "firmware/core/firmware.hpp"

namespace rosflight::core {
namespace {

// Bits of BATT_MULT_SET.
constexpr std::int32_t kVoltageChosen = 1;
constexpr std::int32_t kCurrentChosen = 2;

bool any_of(const Parameters::ChangeSet& changed, Param first, Param last) {
  // A member of libstdc++, which the host and the microcontrollers have: skips words of zeros.
  return changed._Find_next(static_cast<std::size_t>(first) - 1) <= static_cast<std::size_t>(last);
}

bool any_of(const Parameters::ChangeSet& changed, std::initializer_list<Param> ids) {
  for (const Param id : ids) {
    if (changed[static_cast<std::size_t>(id)]) return true;
  }
  return false;
}

}  // namespace

/// A battery multiplier of 1 counts if it was set by a user: BATT_MULT_SET records that.
void Firmware::note_multiplier(Param id) {
  std::int32_t chosen = parameters_.get_int(Param::kBattMultSet);
  if (id == Param::kBattVoltMult) chosen |= kVoltageChosen;
  if (id == Param::kBattCurrMult) chosen |= kCurrentChosen;
  static_cast<void>(parameters_.set_int(Param::kBattMultSet, chosen));
}

StoreResult Firmware::load_parameters() {
  ParameterStore::LoadReport report;
  const StoreResult result = store_.load(parameters_, report, &board_.system);
  if (report.skipped > 0) {
    log_.warning(Text("Stored parameters skipped: ").add(report.skipped));
    log_.warning(Text("The first of them: ").add(report.first_skipped));
  }
  const char* fault = nullptr;
  if (report.fell_back) fault = "Newer parameters damaged: older set in force";
  if (result == StoreResult::kDamaged) fault = "Stored parameters damaged, not overwritten";
  if (result == StoreResult::kFailed && store_.present())
    fault = "Parameter storage cannot be read";
  if (fault != nullptr) {
    log_.critical(fault);
    log_.critical("No arming until the parameters are written");
    storage_healthy_ = false;
  }
  return result;
}

/// Stores what differs from storage, a block per pass: the gyro biases alone cost one.
void Firmware::begin_save() {
  save_requested_ = true;
  if (store_.busy()) return;
  if (parameters_.others_unsaved() || store_.begin_gyro_bias(parameters_) != StoreResult::kBusy) {
    static_cast<void>(store_.begin(parameters_));
  }
}

/// WRITE_PARAMS: stores all parameters and acknowledges when they are stored. A request during a
/// save stores them again, so that its acknowledgement covers every earlier change.
bool Firmware::begin_write() {
  write_again_ = store_.busy();
  if (!write_again_ && store_.begin(parameters_) != StoreResult::kBusy) {
    log_.error("Parameters not saved: storage failed");
    return false;
  }
  ++writes_requested_;
  return true;
}

/// At most once per pass and never armed: writes a block. Completes begin_save() and begin_write(),
/// and continues an arming that waits for them.
void Firmware::continue_save(Time now) {
  const bool busy = store_.busy();
  if (stored_ || state_.armed() || !(busy || save_requested_)) return;
  stored_ = busy;
  StoreResult result = busy ? store_.step(parameters_) : StoreResult::kFailed;
  if (result == StoreResult::kBusy) return;
  if (result == StoreResult::kOk) store_.mark_saved(parameters_);
  if (result == StoreResult::kOk && write_again_) {
    write_again_ = false;
    result = store_.begin(parameters_);
    if (result == StoreResult::kBusy) return;
  }
  const bool ok = result == StoreResult::kOk;
  if (!ok) log_.error("Parameters not saved: storage failed");
  if (ok && writes_requested_ > 0) storage_healthy_ = true;
  for (; writes_requested_ > 0; --writes_requested_) {
    telemetry_.send_ack(static_cast<std::uint8_t>(link::Command::kWriteParams), ok);
  }
  write_again_ = false;
  if (!save_requested_) return;
  save_requested_ = false;
  act(ok ? state_.handle(Event::kSaved, arm_request(now)) : state_.handle(Event::kSaveFailed), now);
}

/// Stores all at once, for the start.
bool Firmware::save_parameters() {
  const bool ok = store_.save(parameters_, &board_.system) == StoreResult::kOk;
  if (ok) {
    store_.mark_saved(parameters_);
  } else {
    log_.error("Parameters not saved: storage failed");
  }
  return ok;
}

/// Once per pass: applies the changed parameters to the modules.
void Firmware::apply_parameter_changes() {
  const Parameters::ChangeSet changed = parameters_.take_changes();
  if (any_of(changed, {Param::kSysId})) {
    codec_.set_system_id(static_cast<std::uint8_t>(parameters_.get_int(Param::kSysId)));
  }
  if (any_of(changed, {Param::kPrimaryMixer, Param::kSecondaryMixer, Param::kUseMotorParam,
                       Param::kRcFAxis})) {
    apply_mixers();
  } else if (any_of(changed, Param::kPriMixerOut0, Param::kSecMixer9_9) &&
             take_mixer_changes(changed, parameters_, mixer_)) {
    if (!board_.outputs.configure(output_rates(mixer_.header()))) {
      log_.warning("PRI_MIXER_PWM: board cannot give all rates");
    }
    stop_motors();
  }
  if (any_of(changed, {Param::kRcType}) &&
      !board_.receiver.start(static_cast<hal::ReceiverType>(parameters_.get_int(Param::kRcType)))) {
    log_.warning("RC_TYPE: this board has no such receiver");
  }
  apply_settings();
  if (any_of(changed, Param::kRcAttOvrdChn, Param::kSwitch8Dir)) rc_.describe(log_);
  if (any_of(changed, Param::kGyroXBias, Param::kAccZBias) ||
      any_of(changed, Param::kImuRoll, Param::kImuYaw)) {
    check_calibration();
  }
  static_cast<void>(parameters_.take_changes());  // rows that the choice of mixer has filled in
}

void Firmware::apply_mixers() {
  set_error(Error::kInvalidMixer, !choose_mixers(parameters_, mixer_, log_));
  if (!board_.outputs.configure(output_rates(mixer_.header()))) {
    log_.warning("PRI_MIXER_PWM: board cannot give all rates");
  }
  stop_motors();  // an output that was a servo may now be a motor
}

void Firmware::apply_settings() {
  sensors_.configure(sensor_settings(parameters_));
  estimator_.configure(estimator_settings(parameters_));
  rc_.configure(rc_settings(parameters_));
  command_.configure(command_settings(parameters_, rc_, !mixer_.mixers_agree()));
  learned_.configure(
      {parameters_.get_float(Param::kRcMaxRollrate), parameters_.get_float(Param::kRcMaxPitchrate),
       parameters_.get_float(Param::kRcMaxYawrate)},
      static_cast<std::size_t>(parameters_.get_int(Param::kRcFAxis)));
  update_max_thrust();
  correct_throttle();
  // 1 is also the table's default: unless a user set it, the board keeps its own scale.
  const std::int32_t chosen = parameters_.get_int(Param::kBattMultSet);
  const auto scale = [this, chosen](Param id, std::int32_t bit) {
    const float v = parameters_.get_float(id);
    return v == 1.0f && (chosen & bit) == 0 ? 0.0f : v;
  };
  board_.battery.set_multipliers(scale(Param::kBattVoltMult, kVoltageChosen),
                                 scale(Param::kBattCurrMult, kCurrentChosen));
  check_failsafe();
  const std::int32_t crash_stop = parameters_.get_int(Param::kCrashStop);
  motor_stop_.configure(
      {parameters_.get_bool(Param::kFixedWing), (crash_stop & 1) != 0, (crash_stop & 2) != 0});
}

void Firmware::update_max_thrust() {
  max_thrust_N_ =
      uses_motor_model(parameters_)
          ? motor_settings(parameters_).max_thrust_N(sensors_.measurements().density_kg_m3)
          : 1.0f;
  controller_.configure(controller_settings(parameters_, max_thrust_N_));
  mixer_.configure(mixer_settings(parameters_, max_thrust_N_));
  command_.set_axis_limits(mixer_.axis_limits(sensors_.measurements().density_kg_m3));
}

/// Sticks mean the same thrust on every battery, if THR_VOLT_COMP asks for it. With motor parameters
/// the mixer does this for all commands.
void Firmware::correct_throttle() {
  const bool wanted = parameters_.get_bool(Param::kThrVoltComp) && !uses_motor_model(parameters_) &&
                      !calibrates_escs(parameters_);
  const float voltage_V = sensors_.measurements().battery.voltage_V;
  command_.set_throttle_factor(
      wanted ? full_battery_factor(voltage_V, parameters_.get_float(Param::kBattVoltMax)) : 1.0f);
}

/// Biases were set by a user: the measured ones are no longer in force.
void Firmware::forget_accel_calibration() {
  accel_calibrated_ = false;
  check_calibration();
}

/// Only the accelerometer's biases show a calibration: those of the gyro are measured at every
/// calibration, also on a vehicle whose accelerometer was never calibrated.
void Firmware::check_calibration() {
  bool calibrated = accel_calibrated_;
  for (const Param id : {Param::kAccXBias, Param::kAccYBias, Param::kAccZBias}) {
    calibrated = calibrated || parameters_.get_float(id) != 0.0f;
  }
  set_error(Error::kUncalibratedImu, !calibrated);
}

void Firmware::check_failsafe() {
  set_error(Error::kInvalidFailsafe, !command_.failsafe_valid());
}

}  // namespace rosflight::core
