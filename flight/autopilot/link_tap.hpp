// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::flight {

enum class Direction : std::uint8_t { kToCompanion, kToAutopilot };

/// Receives a copy of every frame on the link, such as a log or a meter.
class LinkTap {
 public:
  virtual ~LinkTap() = default;
  /// @param t  simulated time at which the sender hands the frame over.
  /// @param taken  false: the frame found no room and is lost.
  virtual void on_frame(Direction direction, hal::Time t, const std::uint8_t* data,
                        std::size_t size, bool taken) = 0;
};

}  // namespace rosflight::flight
