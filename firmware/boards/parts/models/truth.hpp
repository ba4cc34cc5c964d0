// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "firmware/hal/time.hpp"

namespace rosflight::boards::parts::models {

/// What an IMU is exposed to, in the axes of the part.
struct ImuTruth {
  std::array<double, 3> accel_m_s2{};
  std::array<double, 3> gyro_rad_s{};
  double temperature_K{298.15};
};

/// What a magnetometer is exposed to, in the axes of the part.
struct MagTruth {
  std::array<double, 3> field_T{};
  double temperature_K{298.15};
};
using MagExposure = std::function<MagTruth(hal::Time)>;

/// Rounded and limited to 16 bits.
inline std::int16_t to_counts(double value) {
  return static_cast<std::int16_t>(std::clamp(std::lround(value), -32768l, 32767l));
}

/// What a differential pressure sensor is exposed to.
struct DiffPressureTruth {
  double pressure_Pa{};
  double temperature_K{298.15};
};
using DiffPressureExposure = std::function<DiffPressureTruth(hal::Time)>;

}  // namespace rosflight::boards::parts::models
