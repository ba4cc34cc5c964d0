// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "firmware/hal/samples.hpp"

/// Values that tests of several units feed.
namespace rosflight::core {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr hal::Vec3 kLevel{0.0f, 0.0f, -9.80665f};  ///< The accelerometer at rest.

}  // namespace rosflight::core
