// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/core/sensors.hpp"
#include "firmware/core/state_machine.hpp"

namespace rosflight::core {

/// The checks before arming on the ground, in the order of the list that users see.
enum class Check : std::uint8_t {
  kMixer,
  kEscCalibration,
  kImu,
  kTime,
  kCalibration,
  kEstimator,
  kReceiver,
  kFailsafe,
  kThrottle,
  kOverride,
  kStill,
  kLevel,
  kSensors,
  kStorage,
  kLoopTime,
  kBatteryKnown,
  kBattery,
};
inline constexpr std::size_t kCheckCount = 17;

enum class Verdict : std::uint8_t { kPass = 0, kWarning = 1, kRefuses = 2 };

/// One row of the list.
struct CheckRow {
  Check check;
  const char* name;  ///< At most 16 characters.
  const char* text;  ///< The reason, at most 34 characters; follows "Unable to arm: ".
  Verdict verdict;   ///< Result of a failed check, unless a parameter changes it.
};

/// The list before arming. CHECK_LEVEL and CHECK_BATTERY turn the warnings of level and battery into
/// refusals. The loop time only warns where other programs share the processor.
// clang-format off
inline constexpr std::array<CheckRow, kCheckCount> kChecks{{
    {Check::kMixer,          "mixer",        "invalid mixer",                    Verdict::kRefuses},
    {Check::kEscCalibration, "ESC mixer",    "ESC calibration mixer chosen",     Verdict::kWarning},
    {Check::kImu,            "IMU",          "IMU not responding",               Verdict::kRefuses},
    {Check::kTime,           "IMU time",     "time going backwards",             Verdict::kRefuses},
    {Check::kCalibration,    "calibration",  "IMU not calibrated",               Verdict::kRefuses},
    {Check::kEstimator,      "estimator",    "unhealthy estimator",              Verdict::kRefuses},
    {Check::kReceiver,       "receiver",     "RC signal lost",                   Verdict::kRefuses},
    {Check::kFailsafe,       "failsafe",     "FAILSAFE_THR not set",             Verdict::kRefuses},
    {Check::kThrottle,       "throttle",     "throttle not low",                 Verdict::kRefuses},
    {Check::kOverride,       "override",     "throttle override switch is off",  Verdict::kRefuses},
    {Check::kStill,          "still",        "vehicle is being moved",           Verdict::kRefuses},
    {Check::kLevel,          "level",        "vehicle is not level",             Verdict::kWarning},
    {Check::kSensors,        "sensors",      "no samples from",                  Verdict::kRefuses},
    {Check::kStorage,        "storage",      "stored parameters damaged",        Verdict::kRefuses},
    {Check::kLoopTime,       "loop time",    "main loop too slow",               Verdict::kRefuses},
    {Check::kBatteryKnown,   "battery seen", "no battery or motor parameters",   Verdict::kRefuses},
    {Check::kBattery,        "battery",      "battery is low",                   Verdict::kWarning},
}};
// clang-format on

/// Sensors besides the IMU. A sensor that has delivered one sample must go on delivering them.
enum class Aid : std::uint8_t { kMag, kBaro, kDiffPressure, kRange, kGnss, kBattery };
inline constexpr std::size_t kAidCount = 6;
inline constexpr std::array<const char*, kAidCount> kAidNames{"mag",   "baro", "airspeed",
                                                              "range", "GNSS", "battery"};

/// Records which sensors have delivered samples, and which of them have stopped.
class SensorWatch {
 public:
  static constexpr Time kSilence = hal::milliseconds(3000);  ///< Slowest sensor: 1 Hz.

  /// Once per pass.
  void step(Time now, const Measurements& m) {
    if (!m.new_aid) return;
    if (m.new_mag) answered(Aid::kMag, now);
    if (m.new_baro) answered(Aid::kBaro, now);
    if (m.new_diff_pressure) answered(Aid::kDiffPressure, now);
    if (m.new_range) answered(Aid::kRange, now);
    if (m.new_gnss) answered(Aid::kGnss, now);
    if (m.new_battery) answered(Aid::kBattery, now);
  }
  /// A sample has been received since power-up.
  bool answered(Aid aid) const { return ever_[static_cast<std::size_t>(aid)]; }
  /// Samples were received, but none for longer than kSilence.
  bool silent(Aid aid, Time now) const {
    const auto k = static_cast<std::size_t>(aid);
    return ever_[k] && now - last_[k] > kSilence;
  }

 private:
  void answered(Aid aid, Time now) {
    ever_[static_cast<std::size_t>(aid)] = true;
    last_[static_cast<std::size_t>(aid)] = now;
  }
  std::array<Time, kAidCount> last_{};
  std::array<bool, kAidCount> ever_{};
};

/// The inputs of the checks.
struct CheckInputs {
  std::uint16_t errors{};  ///< The error word.
  bool esc_calibration{};
  bool throttle_low{true};
  bool override_ok{true};  ///< TAKE_MIN_THR is set, or the throttle override switch is on.
  bool still{true};
  bool level{true};
  bool sensor_silent{};
  bool storage_healthy{true};
  bool loop_in_time{true};
  bool motor_model_unusable{};  ///< The motor model is wanted and has no battery or no thrust.
  bool battery_low{};
  bool level_refuses{};     ///< CHECK_LEVEL.
  bool battery_refuses{};   ///< CHECK_BATTERY.
  bool shares_processor{};  ///< The loop time depends on other programs.
};

/// The list with a verdict for each row.
struct CheckResults {
  std::array<Verdict, kCheckCount> verdict{};
  /// No check refuses; warnings are allowed.
  bool ready() const;
  /// Marks a check as passed.
  void pass(Check check) { verdict[static_cast<std::size_t>(check)] = Verdict::kPass; }
  /// The verdict of one check.
  Verdict of(Check check) const { return verdict[static_cast<std::size_t>(check)]; }
};

/// Evaluates every check of the list.
CheckResults run_checks(const CheckInputs& in);

}  // namespace rosflight::core
