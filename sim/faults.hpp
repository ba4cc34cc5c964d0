// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/hal/time.hpp"

/// Things that break at a given time, for tests and for `--fault WHAT@TIME[:DURATION]`.
namespace rosflight::sim {

using hal::Time;

enum class FaultKind : std::uint8_t {
  kImu,  ///< The sensor stops delivering; likewise the next six.
  kMag,
  kBaro,
  kGnss,
  kDiffPressure,
  kRange,
  kBattery,
  kImuNan,          ///< IMU samples keep coming and are not numbers.
  kImuStuck,        ///< They repeat the last good values under new stamps.
  kRcSilence,       ///< The receiver sends nothing.
  kRcFrameLoss,     ///< Every receiver frame carries the frame-lost flag.
  kLinkCut,         ///< No byte arrives, either way.
  kCrash,           ///< The board's processor breaks down at this moment and starts again.
  kHang,            ///< The firmware hangs at this moment; the board's watchdog starts it again.
  kBaroStep,        ///< The barometer reads a height too high by `value` [m].
  kMagTurned,       ///< The magnetometer is turned by `value` about body z [rad].
  kAccelStep,       ///< `value` on top of an axis of the accelerometer [m/s^2].
  kGyroStep,        ///< `value` on top of an axis of the gyro [rad/s].
  kPitotBlocked,    ///< The pitot tube reads no pressure.
  kMotor,           ///< One motor gives only a part of its thrust.
  kGnssStep,        ///< The satellite receiver's position jumps `value` to the north [m].
  kGnssDelay,       ///< Its fixes arrive `value` later, under the stamp of their arrival [s].
  kLinkNoise,       ///< A share `value` of the bytes on the link have one bit turned over.
  kCompanionStall,  ///< The companion's program stands; bytes for it wait, as far as there is room.
  kServo,           ///< One control surface keeps the deflection that it has.
  kBatteryLow,      ///< No more than kLowCharge of the battery's charge is left.
  kMotionCapture,   ///< No pose of motion capture arrives.
};
inline constexpr std::size_t kFaultKinds = 27;
/// What kBatteryLow leaves of a full battery.
inline constexpr double kLowCharge = 0.15;

/// A fault in force for start <= t < end.
struct Fault {
  FaultKind kind{};
  std::size_t motor{};  ///< For kMotor: index from 0, likewise of the surface for kServo.
  double factor{1.0};   ///< For kMotor: share of the thrust that is left, 0..1.
  std::size_t axis{};   ///< For steps of the IMU: 0, 1, 2.
  double value{};       ///< For kinds with a size, in the unit of the kind.
  Time start{};
  Time end{Time::max()};
};

/// Reads one WHAT[=VALUE]@TIME[:DURATION], times in seconds. Without a duration it lasts to the
/// end.
/// @throws config::Error  one line with what was found and what is allowed.
Fault parse_fault(std::string_view text);

/// The names for WHAT, one "  name   what happens" line each, for --help.
std::string fault_help();

/// All faults of a run. Asking is a test of one bit while there is no fault of the kind.
class FaultSchedule {
 public:
  FaultSchedule() = default;
  /// @param faults  in any order.
  explicit FaultSchedule(std::vector<Fault> faults);

  /// A fault of that kind is in force at `t`.
  bool active(FaultKind kind, Time t) const {
    return (kinds_ & bit(kind)) != 0U && active_now(kind, t);
  }
  /// Sum of the values of a kind in force at t; of one axis for steps of the IMU.
  double value(FaultKind kind, Time t, std::size_t axis = 0) const {
    return (kinds_ & bit(kind)) == 0U ? 0.0 : value_now(kind, t, axis);
  }
  /// Share of its thrust that a motor gives at t: the product over its faults, 1 without any.
  double thrust_factor(std::size_t motor, Time t) const;
  /// A control surface is stuck at t.
  bool servo_stuck(std::size_t surface, Time t) const;
  /// Nothing is listed.
  bool empty() const { return kinds_ == 0U; }
  /// Some fault of this kind is listed, at whatever time.
  bool has(FaultKind kind) const { return (kinds_ & bit(kind)) != 0U; }

  const std::vector<Fault>& faults() const { return faults_; }

  void add(const Fault& fault);
  /// Those in force at `t`, and those to come, end.
  void end_all(Time t);

 private:
  static constexpr std::uint32_t bit(FaultKind kind) { return 1U << static_cast<unsigned>(kind); }
  bool active_now(FaultKind kind, Time t) const;
  double value_now(FaultKind kind, Time t, std::size_t axis) const;

  std::vector<Fault> faults_;
  std::uint32_t kinds_{0};
};

/// Each as parse_fault() reads it.
FaultSchedule parse_faults(const std::vector<std::string>& texts);

}  // namespace rosflight::sim
