// SPDX-License-Identifier: BSD-3-Clause
// The part of Firmware that answers messages and follows parameters.
#include <algorithm>
#include <limits>

#include "firmware/core/firmware.hpp"
#include "firmware/core/version.hpp"

namespace rosflight::core {
namespace {

constexpr Time kRebootDelay = hal::milliseconds(20);  // lets the acknowledgement out

bool any_of(const Parameters::ChangeSet& changed, Param first, Param last) {
  for (auto k = static_cast<std::size_t>(first); k <= static_cast<std::size_t>(last); ++k) {
    if (changed.test(k)) return true;
  }
  return false;
}

bool any_of(const Parameters::ChangeSet& changed, std::initializer_list<Param> ids) {
  for (const Param id : ids) {
    if (changed.test(static_cast<std::size_t>(id))) return true;
  }
  return false;
}

}  // namespace

void Firmware::handle(const link::Message& message, Time now) {
  if (const auto* offboard = std::get_if<link::OffboardControl>(&message)) {
    on(*offboard, now);
  } else if (const auto* sync = std::get_if<link::TimeSync>(&message)) {
    on(*sync, now);
  } else if (const auto* beat = std::get_if<link::Heartbeat>(&message)) {
    on(*beat, now);
  } else if (const auto* set = std::get_if<link::ParamSet>(&message)) {
    on(*set);
  } else if (const auto* read = std::get_if<link::ParamRequestRead>(&message)) {
    on(*read);
  } else if (const auto* list = std::get_if<link::ParamRequestList>(&message)) {
    on(*list);
  } else if (const auto* command = std::get_if<link::CommandRequest>(&message)) {
    on(*command, now);
  } else if (const auto* aux = std::get_if<link::AuxCommand>(&message)) {
    static_cast<void>(mixer_.set_auxiliary(*aux));
  } else if (const auto* attitude = std::get_if<link::ExternalAttitude>(&message)) {
    static_cast<void>(estimator_.set_external_attitude(attitude->q_NB));
  }
}

bool Firmware::is_me(std::uint8_t target_system) const {
  return target_system == 0 || target_system == parameters_.get_int(Param::kSysId);
}

void Firmware::on(const link::Heartbeat& /*message*/, Time now) {
  telemetry_.heard_peer(now);
}

void Firmware::on(const link::TimeSync& message, Time now) {
  if (message.tc1_ns != 0) return;
  telemetry_.send(link::TimeSync{now.count() * 1000, message.ts1_ns}, hal::Serial::kTimely);
}

void Firmware::on(const link::ParamRequestRead& message) {
  if (!is_me(message.target_system)) return;
  const std::size_t index =
      message.index >= 0 ? static_cast<std::size_t>(message.index) : Parameters::find(message.name);
  if (index < kParamCount) {
    telemetry_.send_parameter(static_cast<Param>(index), parameters_);
  } else {
    log_.warning(Text("No parameter ").add(message.name));
  }
}

void Firmware::on(const link::ParamRequestList& message) {
  if (is_me(message.target_system)) telemetry_.start_list();
}

void Firmware::on(const link::ParamSet& message) {
  if (!is_me(message.target_system)) return;
  const std::size_t index = Parameters::find(message.name);
  if (index >= kParamCount) {
    log_.warning(Text("No parameter ").add(message.name));
    return;
  }
  const auto id = static_cast<Param>(index);
  switch (parameters_.set_bits(id, message.type, message.value.bits, state_.armed())) {
    case SetResult::kChanged:
      apply_parameter_changes();
      break;
    case SetResult::kOutOfRange:
      log_.warning(Text("Out of range, kept: ").add(message.name));
      break;
    case SetResult::kWrongType:
      log_.warning(Text("Wrong type, kept: ").add(message.name));
      break;
    case SetResult::kLockedArmed:
      log_.warning(Text("Not while armed, kept: ").add(message.name));
      break;
    case SetResult::kUnchanged:
      break;
  }
  telemetry_.send_parameter(id, parameters_);
  parameters_.mark_reported(id);
}

void Firmware::on(const link::OffboardControl& message, Time now) {
  const bool pass_through =
      message.mode == static_cast<std::uint8_t>(link::OffboardMode::kPassThrough);
  auto u = message.u;
  for (std::size_t k = 0; k < u.size(); ++k) {
    if ((message.ignore >> k & 1u) != 0) u[k] = 0.0f;  // whatever is in there, NaN included
  }
  const float fraction =
      pass_through ? mixer_.thrust_fraction(u, sensors_.measurements().density_kg_m3) : 0.0f;
  if (!command_.set_offboard(now, message, fraction) && offboard_texts_.allow(now)) {
    log_.warning("Offboard command refused: mode or value");
  }
}

void Firmware::on(const link::CommandRequest& message, Time now) {
  constexpr auto kLast = static_cast<std::uint8_t>(link::Command::kSendVersion);
  const auto command = static_cast<link::Command>(message.command);
  const bool known = message.command <= kLast;
  const bool allowed = !state_.armed() || command == link::Command::kSendVersion;
  const bool success = known && allowed && run_command(command, now);
  telemetry_.send_ack(message.command, success);
}

bool Firmware::run_command(link::Command command, Time now) {
  switch (command) {
    case link::Command::kRcCalibration:
      capture_trim();
      return true;
    case link::Command::kAccelCalibration:
      sensors_.start_accel_calibration();
      return true;
    case link::Command::kGyroCalibration:
      sensors_.start_gyro_calibration();
      return true;
    case link::Command::kBaroCalibration:
      sensors_.start_baro_calibration();
      return true;
    case link::Command::kAirspeedCalibration:
      sensors_.start_airspeed_calibration();
      return true;
    case link::Command::kReadParams:
      return load_parameters() == StoreResult::kOk;
    case link::Command::kWriteParams:
      return save_parameters();
    case link::Command::kSetParamDefaults:
      parameters_.reset_to_defaults();
      return true;
    case link::Command::kReboot:
    case link::Command::kRebootToBootloader:
      reboot_to_bootloader_ = command == link::Command::kRebootToBootloader;
      reboot_at_ = now + kRebootDelay;
      return true;
    case link::Command::kSendVersion: {
      link::Version version;
      version.text = Text(kVersion).chars();
      telemetry_.send(version);
      log_.info(Text("Longest pass: ")
                    .add(static_cast<std::int32_t>(std::min<std::int64_t>(
                        longest_pass_.count(), std::numeric_limits<std::int32_t>::max())))
                    .add(" us"));
      longest_pass_ = Time{0};
      return true;
    }
  }
  return false;
}

void Firmware::capture_trim() {
  const auto torque = controller_.trim(command_.pilot());
  const auto axis = [](std::uint16_t k) {
    return static_cast<Param>(static_cast<std::uint16_t>(Param::kXEqTorque) + k);
  };
  std::array<float, 3> sum{};
  bool in_range = true;
  for (std::uint16_t k = 0; k < 3; ++k) {
    sum[k] = parameters_.get_float(axis(k)) + torque[k];
    in_range = in_range && Parameters::in_range(axis(k), ParamValue{sum[k]});
  }
  if (in_range) {
    for (std::uint16_t k = 0; k < 3; ++k) {
      static_cast<void>(parameters_.set_float(axis(k), sum[k]));
    }
    log_.warning("Equilibrium torques found and applied");
    log_.warning("Now zero the trims of the transmitter");
    log_.warning("and write the parameters to keep them");
  } else {
    log_.error("Equilibrium torque out of range, not taken");
  }
}

// ---- parameters

StoreResult Firmware::load_parameters() {
  ParameterStore::LoadReport report;
  const StoreResult result = store_.load(parameters_, report);
  if (report.skipped > 0) {
    log_.warning(Text("Stored parameters skipped: ").add(report.skipped));
  }
  return result;
}

bool Firmware::save_parameters() {
  if (store_.save(parameters_) != StoreResult::kOk) {
    log_.error("Parameters not saved: storage failed");
    return false;
  }
  parameters_.mark_saved();
  return true;
}

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
}

void Firmware::apply_mixers() {
  set_error(Error::kInvalidMixer, !choose_mixers(parameters_, mixer_, log_));
  if (!board_.outputs.configure(output_rates(mixer_.header()))) {
    log_.warning("PRI_MIXER_PWM: board cannot give all rates");
  }
}

void Firmware::apply_settings() {
  sensors_.configure(sensor_settings(parameters_));
  estimator_.configure(estimator_settings(parameters_));
  rc_.configure(rc_settings(parameters_));
  command_.configure(command_settings(parameters_, rc_, !mixer_.mixers_agree()));
  update_max_thrust();
  // 1, the table's default, means that nobody chose a scale: the board keeps its own.
  const auto scale = [this](Param id) {
    const float v = parameters_.get_float(id);
    return v == 1.0f ? 0.0f : v;
  };
  board_.battery.set_multipliers(scale(Param::kBattVoltMult), scale(Param::kBattCurrMult));
  check_failsafe();
}

void Firmware::update_max_thrust() {
  max_thrust_N_ =
      parameters_.get_bool(Param::kUseMotorParam)
          ? motor_settings(parameters_).max_thrust_N(sensors_.measurements().density_kg_m3)
          : 1.0f;
  controller_.configure(controller_settings(parameters_, max_thrust_N_));
  mixer_.configure(mixer_settings(parameters_, max_thrust_N_));
}

void Firmware::check_calibration() {
  bool biased = false;
  for (auto k = static_cast<std::uint16_t>(Param::kGyroXBias);
       k <= static_cast<std::uint16_t>(Param::kAccZBias); ++k) {
    biased = biased || parameters_.get_float(static_cast<Param>(k)) != 0.0f;
  }
  set_error(Error::kUncalibratedImu, !biased);
}

void Firmware::check_failsafe() {
  set_error(Error::kInvalidFailsafe, !command_.failsafe_valid());
}

}  // namespace rosflight::core
