// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/iis2mdc.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kIdentity = 0x4F, kIdentityValue = 0x40;
constexpr std::uint8_t kA = 0x60, kSoftReset = 0x20, kReboot = 0x40;
constexpr std::uint8_t kIdle = 0x83;    // temperature compensated, idle
constexpr std::uint8_t kSingle = 0x81;  // one measurement, then idle
constexpr std::uint8_t kB = 0x61, kOffsetCancel = 0x12;
constexpr std::uint8_t kC = 0x62, kPinAndBlockUpdate = 0x31;  // I2C off, data ready to the pin
constexpr std::uint8_t kRead = 0x80;
constexpr std::size_t kStatus = 0x67 - kA, kField = 0x68 - kA, kTemperature = 0x6E - kA;
constexpr std::uint8_t kReady = 0x08;

constexpr float kScale_T = 1.5e-7f;
constexpr Time kMeasurement{9'700};
constexpr Time kLost{100'000};
constexpr std::uint8_t kLateTicks = 20;

}  // namespace

const std::array<SetupStep, Iis2mdc::kSteps> Iis2mdc::kSetup{
    {{SetupKind::kIdentity, kIdentity, kIdentityValue},
     {SetupKind::kWrite, kA, kSoftReset, 0xFF, 1000},
     {SetupKind::kWrite, kA, kReboot, 0xFF, 25'000},
     {SetupKind::kIdentity, kIdentity, kIdentityValue},
     {SetupKind::kConfigure, kB, kOffsetCancel, 0x1F},
     {SetupKind::kConfigure, kC, kPinAndBlockUpdate, 0x3F},
     {SetupKind::kConfigure, kA, kIdle, 0x80}}};

Iis2mdc::Iis2mdc(Port& port, const Mounting& mounting)
    : Driver{"IIS2MDC"}, port_{port}, mounting_{mounting}, setup_{port, {kRead, 0}, kSetup} {}

bool Iis2mdc::begin(Start how, Time now) {
  if (on_bus_) return false;
  stage_ = Stage::kIdle;
  have_previous_ = false;
  return setup_.begin(how, now);
}

void Iis2mdc::step_start(Time now) {
  if (step_setup(setup_, now)) started();
}

void Iis2mdc::step_running(Time now) {
  if (on_bus_) return;
  if (stage_ != Stage::kWaiting) {
    if (now - begun() >= kMeasurement) command();
  } else if (now - commanded_ >= kMeasurement) {
    stage_ = Stage::kResult;
    out_[0] = kA | kRead;
    transfer_ = {out_.data(), 1, in_.data(), in_.size(), this};
    on_bus_ = port_.start(transfer_);
  }
}

void Iis2mdc::command() {
  stage_ = Stage::kCommand;
  late_ = 0;
  out_ = {kA, kSingle};
  transfer_ = {out_.data(), 2, nullptr, 0, this};
  on_bus_ = port_.start(transfer_);
}

void Iis2mdc::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  const Stage ended = stage_;
  stage_ = Stage::kIdle;
  if (!good(result, end) || state() != PartState::kRunning) return;
  if (ended == Stage::kCommand) {
    commanded_ = end;
    stage_ = Stage::kWaiting;
  } else {
    result_read(end);
  }
}

void Iis2mdc::result_read(Time end) {
  const std::uint8_t c = in_[kC - kA];
  if (in_[kB - kA] != kOffsetCancel || c != kPinAndBlockUpdate) {
    fail(end).add("set-up lost, register 0x62 is ").hex(c);
  } else if ((in_[kStatus] & kReady) == 0) {
    stage_ = Stage::kWaiting;
    if (++late_ >= kLateTicks) fail(end).add("no measurement, register 0x67 is ").hex(in_[kStatus]);
  } else {
    use_result();
    command();
  }
}

/// A measurement without one shortly before has no partner to cancel its offset.
void Iis2mdc::use_result() {
  const hal::Vec3 field{kScale_T * static_cast<float>(le16(&in_[kField])),
                        kScale_T * static_cast<float>(le16(&in_[kField + 2])),
                        -kScale_T * static_cast<float>(le16(&in_[kField + 4]))};
  const bool pair = have_previous_ && commanded_ - previous_commanded_ < kLost;
  if (pair) {
    hal::MagSample sample;
    sample.stamp = previous_commanded_ + (commanded_ + kMeasurement - previous_commanded_) / 2;
    sample.field_T =
        mounting_.apply({0.5f * (field[0] + previous_[0]), 0.5f * (field[1] + previous_[1]),
                         0.5f * (field[2] + previous_[2])});
    sample.temperature_K =
        kZeroCelsius_K + 25.0f + static_cast<float>(le16(&in_[kTemperature])) / 8.0f;
    static_cast<void>(samples_.put(sample));
    well();
  }
  previous_ = field;
  previous_commanded_ = commanded_;
  have_previous_ = true;
}

}  // namespace rosflight::boards::parts
