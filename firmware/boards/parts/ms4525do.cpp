// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ms4525do.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr Time kPeriod{2'000};
constexpr int kReadings = 5;
constexpr std::size_t kPressureBytes = 2;
constexpr unsigned kGood = 0, kFault = 3;  // 2 is stale
constexpr std::uint8_t kFaultsInARow = 20;
constexpr float kPascalPerPsi = 6894.76f;

}  // namespace

Ms4525do::Ms4525do(Port& port) : Driver{"MS4525DO"}, port_{port}, period_{kPeriod} {}

float Ms4525do::pressure_Pa(float raw) {
  return ((raw - 1638.3f) / 6553.2f - 1.0f) * kPascalPerPsi;
}
float Ms4525do::temperature_K(float raw) {
  return kZeroCelsius_K + raw * 200.0f / 2047.0f - 50.0f;
}

bool Ms4525do::begin(Start /*how*/, Time now) {
  if (on_bus_) return false;
  faults_in_a_row_ = 0;
  count_ = 0;
  sum_ = 0.0f;
  period_.restart(now);
  return true;
}

void Ms4525do::step_start(Time /*now*/) {
  started();
}

void Ms4525do::step_running(Time now) {
  if (on_bus_ || !period_.due(now)) return;
  const bool last = count_ + 1 == kReadings;
  transfer_ = {nullptr, 0, in_.data(), last ? in_.size() : kPressureBytes, this};
  on_bus_ = port_.start(transfer_);
}

void Ms4525do::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  if (!good(result, end) || state() != PartState::kRunning) return;
  const unsigned status = in_[0] >> 6;
  if (status == kGood) {
    faults_in_a_row_ = 0;
    use_reading(end);
  } else if (status == kFault) {
    count_error();
    if (++faults_in_a_row_ >= kFaultsInARow) fail(end).add("fault reported by the part");
  }
}

void Ms4525do::use_reading(Time end) {
  if (count_ == 0) first_ = end;
  sum_ += static_cast<float>(be16(&in_[0]) & 0x3FFF);
  if (++count_ < kReadings) return;
  hal::DiffPressureSample sample;
  sample.stamp = first_ + (end - first_) / 2;
  sample.pressure_Pa = pressure_Pa(sum_ / static_cast<float>(kReadings));
  sample.temperature_K = temperature_K(static_cast<float>(be16(&in_[2]) >> 5));
  static_cast<void>(samples_.put(sample));
  count_ = 0;
  sum_ = 0.0f;
  well();
}

}  // namespace rosflight::boards::parts
