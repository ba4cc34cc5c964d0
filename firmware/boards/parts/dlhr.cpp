// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/dlhr.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::array<std::uint8_t, 3> kMeanOfTwo{0xAC, 0x00, 0x00};
constexpr std::uint8_t kIdle = 0x40;        // powered, not busy, no error
constexpr std::uint8_t kStatusBits = 0x65;  // powered, busy, memory and arithmetic error
constexpr Time kPeriod{10'000};
constexpr Time kMeasurement{5'200};
constexpr Time kWithoutEdge{8'000};
constexpr std::uint8_t kBadInARow = 20;

constexpr float kRange_Pa = 4981.8f;
constexpr float kFullScale = 16777216.0f;

}  // namespace

Dlhr::Dlhr(Port& port) : Driver{"DLHR"}, port_{port}, period_{kPeriod} {}

float Dlhr::pressure_Pa(std::uint32_t raw) {
  return 1.25f * kRange_Pa * (static_cast<float>(raw) / kFullScale - 0.1f);
}
float Dlhr::temperature_K(std::uint32_t raw) {
  return kZeroCelsius_K + 125.0f * static_cast<float>(raw) / kFullScale - 40.0f;
}

bool Dlhr::begin(Start /*how*/, Time now) {
  if (on_bus_) return false;
  stage_ = Stage::kIdle;
  bad_in_a_row_ = 0;
  period_.restart(now + kWithoutEdge);
  return true;
}

void Dlhr::step_start(Time /*now*/) {
  if (!on_bus_) start(Stage::kStatus, 0, 1);
}

void Dlhr::step_running(Time now) {
  if (on_bus_) return;
  if (stage_ == Stage::kWaiting) {
    if (now - commanded_ >= kWithoutEdge) start(Stage::kResult, 0, in_.size());
  } else if (period_.due(now)) {
    start(Stage::kCommand, kMeanOfTwo.size(), 0);
  }
}

void Dlhr::conversion_done(Time /*edge*/) {
  if (state() == PartState::kRunning && stage_ == Stage::kWaiting && !on_bus_) {
    start(Stage::kResult, 0, in_.size());
  }
}

void Dlhr::start(Stage stage, std::size_t out, std::size_t in) {
  transfer_ = {kMeanOfTwo.data(), out, in_.data(), in, this};
  on_bus_ = port_.start(transfer_);
  if (on_bus_) stage_ = stage;
}

void Dlhr::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  const Stage ended = stage_;
  stage_ = Stage::kIdle;
  if (state() == PartState::kStarting) {
    if (result != TransferResult::kDone) {
      fail(end).add(result == TransferResult::kNoAnswer ? "no answer" : "bus fault");
    } else if ((in_[0] & (kStatusBits & ~0x20u)) != kIdle) {
      fail(end).add("status ").hex(in_[0]).add(", expected ").hex(kIdle);
    } else {
      started();
    }
    return;
  }
  if (!good(result, end) || state() != PartState::kRunning) return;
  if (ended == Stage::kCommand) {
    commanded_ = end;
    stage_ = Stage::kWaiting;
  } else {
    result_read(end);
  }
}

void Dlhr::result_read(Time end) {
  if ((in_[0] & kStatusBits) != kIdle) {
    count_error();
    if (++bad_in_a_row_ >= kBadInARow)
      fail(end).add("status ").hex(in_[0]).add(", expected ").hex(kIdle);
    return;
  }
  bad_in_a_row_ = 0;
  hal::DiffPressureSample sample;
  sample.stamp = commanded_ + kMeasurement / 2;
  sample.pressure_Pa = pressure_Pa(be24(&in_[1]));
  sample.temperature_K = temperature_K(be24(&in_[4]));
  static_cast<void>(samples_.put(sample));
  well();
}

}  // namespace rosflight::boards::parts
