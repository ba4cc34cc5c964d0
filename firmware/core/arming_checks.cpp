// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/arming_checks.hpp"

#include <algorithm>

namespace rosflight::core {
namespace {

constexpr bool in_order() {
  for (std::size_t k = 0; k < kCheckCount; ++k) {
    if (static_cast<std::size_t>(kChecks[k].check) != k) return false;
  }
  return true;
}
static_assert(in_order(), "kChecks stands in the order of Check");

bool failed(Check check, const CheckInputs& in) {
  const auto bit = [&in](Error error) {
    return (in.errors & static_cast<std::uint16_t>(error)) != 0;
  };
  switch (check) {
    case Check::kMixer:
      return bit(Error::kInvalidMixer);
    case Check::kEscCalibration:
      return in.esc_calibration;
    case Check::kImu:
      return bit(Error::kImuNotResponding);
    case Check::kTime:
      return bit(Error::kTimeGoingBackwards);
    case Check::kCalibration:
      return bit(Error::kUncalibratedImu);
    case Check::kEstimator:
      return bit(Error::kUnhealthyEstimator);
    case Check::kReceiver:
      return bit(Error::kRcLost);
    case Check::kFailsafe:
      return bit(Error::kInvalidFailsafe);
    case Check::kThrottle:
      return !in.throttle_low;
    case Check::kOverride:
      return !in.override_ok;
    case Check::kStill:
      return !in.still;
    case Check::kLevel:
      return !in.level;
    case Check::kSensors:
      return in.sensor_silent;
    case Check::kStorage:
      return !in.storage_healthy;
    case Check::kLoopTime:
      return !in.loop_in_time;
    case Check::kBatteryKnown:
      return in.motor_model_unusable;
    case Check::kBattery:
      return in.battery_low;
  }
  return true;
}

Verdict consequence(const CheckRow& row, const CheckInputs& in) {
  if (row.check == Check::kLevel && in.level_refuses) return Verdict::kRefuses;
  if (row.check == Check::kBattery && in.battery_refuses) return Verdict::kRefuses;
  if (row.check == Check::kLoopTime && in.shares_processor) return Verdict::kWarning;
  return row.verdict;
}

}  // namespace

CheckResults run_checks(const CheckInputs& in) {
  CheckResults results;
  for (const CheckRow& row : kChecks) {
    const bool bad = failed(row.check, in);
    results.verdict[static_cast<std::size_t>(row.check)] =
        bad ? consequence(row, in) : Verdict::kPass;
  }
  return results;
}

bool CheckResults::ready() const {
  return std::none_of(verdict.begin(), verdict.end(),
                      [](Verdict v) { return v == Verdict::kRefuses; });
}

}  // namespace rosflight::core
