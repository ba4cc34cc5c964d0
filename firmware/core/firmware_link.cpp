// SPDX-License-Identifier: BSD-3-Clause
// The part of Firmware that handles messages.
#include "firmware/core/firmware.hpp"

namespace rosflight::core {
namespace {

/// The system that a message is addressed to; 0 (all) if it has no such field.
std::uint8_t target_of(const link::Message& message) {
  if (const auto* set = std::get_if<link::ParamSet>(&message)) return set->target_system;
  if (const auto* read = std::get_if<link::ParamRequestRead>(&message)) return read->target_system;
  if (const auto* list = std::get_if<link::ParamRequestList>(&message)) return list->target_system;
  if (const auto* test = std::get_if<link::MotorTest>(&message)) return test->target_system;
  if (const auto* report = std::get_if<link::ReportRequest>(&message)) return report->target_system;
  if (const auto* record = std::get_if<link::RecordRequest>(&message)) return record->target_system;
  return 0;
}

}  // namespace

void Firmware::handle(const link::Message& message, Time now) {
  if (is_me(target_of(message))) last_companion_frame_ = now;
  if (const auto* offboard = std::get_if<link::OffboardControl>(&message)) {
    on(*offboard, now);
  } else if (const auto* sync = std::get_if<link::TimeSync>(&message)) {
    on(*sync, now);
  } else if (const auto* beat = std::get_if<link::Heartbeat>(&message)) {
    on(*beat, now);
  } else if (const auto* set = std::get_if<link::ParamSet>(&message)) {
    on(*set, now);
  } else if (const auto* read = std::get_if<link::ParamRequestRead>(&message)) {
    on(*read);
  } else if (const auto* list = std::get_if<link::ParamRequestList>(&message)) {
    on(*list);
  } else if (const auto* command = std::get_if<link::CommandRequest>(&message)) {
    on(*command, now);
  } else if (const auto* aux = std::get_if<link::AuxCommand>(&message)) {
    static_cast<void>(mixer_.set_auxiliary(*aux));
  } else if (const auto* attitude = std::get_if<link::ExternalAttitude>(&message)) {
    static_cast<void>(estimator_.set_external_attitude(attitude->q_WB));
  } else if (const auto* test = std::get_if<link::MotorTest>(&message)) {
    on(*test, now);
  } else if (const auto* report = std::get_if<link::ReportRequest>(&message)) {
    on(*report);
  }
}

bool Firmware::is_me(std::uint8_t target_system) const {
  return target_system == 0 || target_system == parameters_.get_int(Param::kSysId);
}

void Firmware::on(const link::Heartbeat& /*message*/, Time now) {
  telemetry_.note_peer_frame(now);
}

void Firmware::on(const link::TimeSync& message, Time now) {
  if (message.tc1_ns != 0) return;
  telemetry_.send(link::TimeSync{now.count() * 1000, message.ts1_ns});
}

void Firmware::on(const link::ParamRequestRead& message) {
  if (!is_me(message.target_system)) return;
  const std::size_t index =
      message.index >= 0 ? static_cast<std::size_t>(message.index) : Parameters::find(message.name);
  if (index < kParamCount) {
    answer_with(static_cast<Param>(index));
  } else {
    log_.warning(Text("No parameter ").add(message.name));
  }
}

void Firmware::on(const link::ParamRequestList& message) {
  if (is_me(message.target_system)) telemetry_.start_list();
}

void Firmware::on(const link::ParamSet& message, Time now) {
  if (!is_me(message.target_system)) return;
  const std::size_t index = Parameters::find(message.name);
  if (index >= kParamCount) {
    log_.warning(Text("No parameter ").add(message.name));
    return;
  }
  const auto id = static_cast<Param>(index);
  const SetResult result =
      parameters_.set_bits(id, message.type, message.value.bits, in_flight(now));
  switch (result) {
    case SetResult::kChanged:  // modules apply it once per pass
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
    case SetResult::kTooFar:
      log_.warning(Text("Not that far while armed, kept: ").add(message.name));
      break;
    case SetResult::kUnchanged:
      break;
  }
  const bool taken = result == SetResult::kChanged || result == SetResult::kUnchanged;
  if (taken && !state_.armed()) note_multiplier(id);
  if (result == SetResult::kChanged && id >= Param::kAccXBias && id <= Param::kAccZBias) {
    forget_accel_calibration();
  }
  answer_with(id);
}

/// Sends the value in force: now if the queue has room, else as soon as it has.
void Firmware::answer_with(Param id) {
  if (!telemetry_.has_room()) {
    parameters_.mark_unreported(id);
    return;
  }
  telemetry_.send_parameter(id, parameters_);
  parameters_.mark_reported(id);
}

void Firmware::on(const link::OffboardControl& message, Time now) {
  link::OffboardControl command = message;
  const std::uint32_t limited_before = command_.limited().count;
  if (!command_.admit(command)) {
    if (offboard_texts_.allow(now)) log_.warning("Offboard command refused: mode or value");
    return;
  }
  const CommandManager::Limited& limited = command_.limited();
  if (limited.count != limited_before && limit_texts_.allow(now)) {
    log_.warning(Text("Offboard command limited: axis ")
                     .add(static_cast<std::int32_t>(limited.axis))
                     .add(", ")
                     .add(limited.requested, 2)
                     .add(" to ")
                     .add(limited.used, 2));
  }
  const bool pass_through =
      command.mode == static_cast<std::uint8_t>(link::OffboardMode::kPassThrough);
  const float fraction =
      pass_through ? mixer_.thrust_fraction(command.u, sensors_.measurements().density_kg_m3)
                   : 0.0f;
  command_.take_offboard(now, command, fraction);
}

void Firmware::on(const link::CommandRequest& message, Time now) {
  constexpr auto kLast = static_cast<std::uint8_t>(link::Command::kSendVersion);
  const auto command = static_cast<link::Command>(message.command);
  const bool known = message.command <= kLast;
  const bool allowed = !in_flight(now) || command == link::Command::kSendVersion;
  if (known && allowed && command == link::Command::kWriteParams && begin_write()) return;
  const bool success = known && allowed && run_command(command, now);
  telemetry_.send_ack(message.command, success);
}

void Firmware::on(const link::ReportRequest& message) {
  if (!is_me(message.target_system)) return;
  if (message.kind == static_cast<std::uint8_t>(link::ReportKind::kChecks)) next_check_ = 0;
  if (message.kind == static_cast<std::uint8_t>(link::ReportKind::kCounters)) send_counters();
}

}  // namespace rosflight::core
