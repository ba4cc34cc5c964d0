// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/constants.hpp"

/// Types that guidance and control of all vehicles share. Double precision, SI, radians.
/// W = local north-east-down, B = body front-right-down, q_WB takes B coordinates to W. Nothing
/// here depends on the link, on ROS or on a clock: time is an argument in seconds.
namespace rosflight::autonomy {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
using base::kPi;
using base::kRadPerDeg;

enum class WaypointType : std::uint8_t { kHold = 0, kGoto = 1 };

/// Meaning of the channels of a FirmwareCommand; the numbers are those of the link's offboard command.
enum class FirmwareMode : std::uint8_t {
  kPassThrough = 0,              ///< u = Fx, Fy, Fz [N], Qx, Qy, Qz [N m].
  kRatesThrottle = 1,            ///< u = throttle x, y, z, roll, pitch, yaw rate [rad/s].
  kRollPitchYawrateThrottle = 2  ///< u = throttle x, y, z, roll, pitch [rad], yaw rate [rad/s].
};

inline constexpr std::size_t kFirmwareAxes = 10;
inline constexpr std::uint16_t kIgnoreAll =
    0x3FF;  ///< No channel is valid: the pilot flies the vehicle.

/// A command to the flight controller, in the precision of the link.
struct FirmwareCommand {
  FirmwareMode mode{FirmwareMode::kPassThrough};
  std::uint16_t ignore{};  ///< Bit k set: channel k is not valid.
  std::array<float, kFirmwareAxes> u{};
};

/// Which axes the pilot controls, from the firmware's override word.
struct PilotOverride {
  bool roll_pitch{};
  bool yaw{};
  bool throttle{};

  /// Bits as in ROSflight 2.x: 0x01 attitude switch, 0x02 throttle switch, 0x04 0x08 0x10 sticks X
  /// Y Z, 0x20 lower throttle wins, 0x40 0x80 0x100 0x200 offboard roll, pitch, yaw, throttle not
  /// active.
  static PilotOverride from_word(std::uint16_t word) {
    return {(word & 0x0CDU) != 0, (word & 0x111U) != 0, (word & 0x222U) != 0};
  }
  bool any() const { return roll_pitch || yaw || throttle; }
};

/// Who controls the axes, over the time.
///
/// A flight controller that restarted, or missed some commands, reports the offboard axes as not
/// active until the next command arrives. For kHandover_s that is no pilot's decision: autonomy
/// that held its position for it would brake as hard as it can.
class OverrideWatch {
 public:
  static constexpr double kHandover_s = 0.25;

  PilotOverride step(std::uint16_t word, double dt_s) {
    constexpr unsigned kNotActive = 0x3C0U;
    const bool by_pilot = (word & ~kNotActive) != 0;
    left_s_ = word == 0 ? kHandover_s : by_pilot ? 0.0 : left_s_ - dt_s;
    return left_s_ > 0.0 ? PilotOverride{} : PilotOverride::from_word(word);
  }

 private:
  double left_s_{0.0};
};

/// Status that the flight controller sends.
struct Status {
  bool armed{};
  bool offboard{};  ///< At least one channel of the offboard command is in force.
  std::uint16_t rc_override{};
  double battery_voltage_V{};  ///< <= 0: unknown, the nominal voltage is assumed.
  bool failsafe{};  ///< The receiver is lost: the flight controller flies its own command.
  double battery_current_A{};
  bool battery_fresh{};  ///< Voltage and current were measured lately.
  double silent_s{};     ///< Since anything arrived from it (GapWatch).
};

}  // namespace rosflight::autonomy
