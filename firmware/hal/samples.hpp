// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "firmware/hal/time.hpp"

/// Samples of the sensors: plain structs in SI units, board axes x forward, y right, z down.
/// `stamp` is the time of the measurement on the board clock, not of its arrival.
namespace rosflight::hal {

using Vec3 = std::array<float, 3>;

struct ImuSample {
  Time stamp{};
  Vec3 accel_m_s2{};  ///< Specific force; level and at rest (0, 0, -9.80665).
  Vec3 gyro_rad_s{};
  float temperature_K{298.15f};
};

/// The control loop needs no shorter steps [s]. Of samples that come faster it takes the mean of as many as cover this,
/// so a board may wake the main loop for as many at once.
inline constexpr float kShortestImuStep_s = 8e-4f;

struct MagSample {
  Time stamp{};
  Vec3 field_T{};
  float temperature_K{};
};

struct BaroSample {
  Time stamp{};
  float pressure_Pa{};  ///< Absolute static pressure.
  float temperature_K{};
};

struct DiffPressureSample {
  Time stamp{};
  float pressure_Pa{};  ///< Pitot minus static, signed.
  float temperature_K{};
};

enum class RangeKind : std::uint8_t { kSonar = 0, kLidar = 1 };

struct RangeSample {
  Time stamp{};
  float range_m{};
  float min_m{};
  float max_m{};
  RangeKind kind{RangeKind::kSonar};
};

enum class GnssFix : std::uint8_t {
  kNone = 0,
  kDeadReckoning = 1,
  k2d = 2,
  k3d = 3,
  kGnssPlusDeadReckoning = 4,
  kTimeOnly = 5
};

struct GnssSample {
  Time stamp{};           ///< Time of validity.
  std::int64_t unix_s{};  ///< Unix time of validity, whole seconds.
  std::int32_t unix_ns{};
  GnssFix fix{GnssFix::kNone};
  std::uint8_t satellites{};
  double latitude_deg{};
  double longitude_deg{};
  float height_msl_m{};
  Vec3 velocity_ned_m_s{};
  float horizontal_accuracy_m{};
  float vertical_accuracy_m{};
  float speed_accuracy_m_s{};
};

struct BatterySample {
  Time stamp{};
  float voltage_V{};
  float current_A{};
};

/// One frame of the pilot's receiver. Channels are fractions, 0..1 for the standard 1000..2000 us.
struct RcFrame {
  static constexpr std::size_t kMaxChannels = 24;
  Time stamp{};
  std::array<float, kMaxChannels> channels{};
  std::uint8_t channel_count{};  ///< How many of `channels` the receiver delivers.
  bool frame_lost{false};        ///< The receiver missed this radio frame.
  bool failsafe{false};          ///< The receiver lost the transmitter.
  std::uint8_t rssi{255};        ///< Strength of the signal, 0..254; 255: not known.
};

inline constexpr std::size_t kOutputs = 14;
/// Commands to the actuators, 0..1 each (servo centre 0.5).
using OutputValues = std::array<float, kOutputs>;

inline constexpr std::size_t kRatedOutputs = 10;
/// Pulse rates of the mixer's channels [Hz]: 0..490 PWM, 150 000..1 200 000 DShot; 0: a level.
using OutputRates = std::array<float, kRatedOutputs>;

}  // namespace rosflight::hal
