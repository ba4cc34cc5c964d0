// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ist8308.hpp"

#include <algorithm>

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kIdentity = 0x00, kIdentityValue = 0x08;
constexpr std::uint8_t kStatus = 0x10, kReady = 0x01;
constexpr std::uint8_t kMode = 0x31, kSingle = 0x01;
constexpr std::uint8_t kReset = 0x32, kResetBit = 0x01;
constexpr std::uint8_t kRange = 0x34, kRange500uT = 0x00, kRangeMask = 0x01;
constexpr std::uint8_t kAveraging = 0x41, kSixteenTimes = 0x24, kAveragingMask = 0x3F;
constexpr float kScale_T = 1e-6f / 6.6f;

constexpr Time kPeriod{10'000};
constexpr Time kMeasurement{8'000};
constexpr std::uint8_t kLateTicks = 20;
constexpr std::uint8_t kSamplesBetweenChecks = 100;

}  // namespace

const std::array<SetupStep, Ist8308::kSteps> Ist8308::kSetup{
    {{SetupKind::kIdentity, kIdentity, kIdentityValue},
     {SetupKind::kWrite, kReset, kResetBit, 0xFF, 1000},
     {SetupKind::kAwait, kReset, 0, kResetBit, 50'000},
     {SetupKind::kConfigure, kRange, kRange500uT, kRangeMask},
     {SetupKind::kConfigure, kAveraging, kSixteenTimes, kAveragingMask}}};

Ist8308::Ist8308(Port& port, const Mounting& mounting)
    : Driver{"IST8308"},
      port_{port},
      mounting_{mounting},
      setup_{port, {0, 0}, kSetup},
      period_{kPeriod} {}

bool Ist8308::begin(Start how, Time now) {
  if (on_bus_) return false;
  stage_ = Stage::kIdle;
  until_check_ = kSamplesBetweenChecks;
  return setup_.begin(how, now);
}

void Ist8308::step_start(Time now) {
  if (!step_setup(setup_, now)) return;
  period_.restart(std::max(now, begun() + kMeasurement));
  started();
}

void Ist8308::step_running(Time now) {
  if (on_bus_) return;
  if (stage_ == Stage::kWaiting) {
    if (now - commanded_ >= kMeasurement) start(Stage::kResult, kStatus, 1, 7);
  } else if (period_.due(now)) {
    late_ = 0;
    start(Stage::kCommand, kMode, 2, 0);
  }
}

void Ist8308::start(Stage stage, std::uint8_t reg, std::size_t out, std::size_t in) {
  out_ = {reg, kSingle};
  transfer_ = {out_.data(), out, in_.data(), in, this};
  on_bus_ = port_.start(transfer_);
  if (on_bus_) stage_ = stage;
}

void Ist8308::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  const Stage ended = stage_;
  stage_ = Stage::kIdle;
  if (!good(result, end) || state() != PartState::kRunning) return;
  if (ended == Stage::kCommand) {
    commanded_ = end;
    stage_ = Stage::kWaiting;
  } else if (ended == Stage::kResult) {
    result_read(end);
  } else {
    check_setup(end);
  }
}

void Ist8308::result_read(Time end) {
  if ((in_[0] & kReady) == 0) {
    stage_ = Stage::kWaiting;
    if (++late_ >= kLateTicks) fail(end).add("no measurement, register 0x10 is ").hex(in_[0]);
    return;
  }
  hal::MagSample sample;
  sample.stamp = commanded_ + kMeasurement / 2;
  sample.field_T = mounting_.apply({kScale_T * static_cast<float>(le16(&in_[1])),
                                    kScale_T * static_cast<float>(le16(&in_[3])),
                                    -kScale_T * static_cast<float>(le16(&in_[5]))});
  static_cast<void>(samples_.put(sample));
  well();
  if (--until_check_ > 0) return;
  until_check_ = kSamplesBetweenChecks;
  start(Stage::kCheck, kRange, 1, in_.size());  // up to kAveraging
}

void Ist8308::check_setup(Time end) {
  const std::uint8_t averaging = in_[kAveraging - kRange];
  if ((in_[0] & kRangeMask) == kRange500uT && (averaging & kAveragingMask) == kSixteenTimes) return;
  fail(end).add("set-up lost, register 0x41 is ").hex(averaging);
}

}  // namespace rosflight::boards::parts
