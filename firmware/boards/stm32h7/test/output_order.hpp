// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <type_traits>

#include "firmware/hal/samples.hpp"

namespace rosflight::boards::stm32h7 {

/// What a test orders from the image of outputs_image.hpp, as bytes over the link. The image answers with one of
/// the two letters.
struct OutputOrder {
  static constexpr char kGiven = 'g';    ///< configure() accepted the rates.
  static constexpr char kRefused = 'r';  ///< It did not; the values are written all the same.

  hal::OutputRates rates_hz{};
  hal::OutputValues values{};
};
static_assert(std::is_trivially_copyable_v<OutputOrder>);

}  // namespace rosflight::boards::stm32h7
