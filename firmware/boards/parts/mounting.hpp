// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

#include "firmware/hal/samples.hpp"

namespace rosflight::boards::parts {

/// How a part sits on its board, in steps of a right angle: component k of the board axes
/// (front, right, down) is sign[k] times component from[k] of the part's own axes.
struct Mounting {
  std::array<std::uint8_t, 3> from{0, 1, 2};
  std::array<float, 3> sign{1.0f, 1.0f, 1.0f};

  hal::Vec3 apply(const hal::Vec3& part) const {
    return {sign[0] * part[from[0]], sign[1] * part[from[1]], sign[2] * part[from[2]]};
  }
};

}  // namespace rosflight::boards::parts
