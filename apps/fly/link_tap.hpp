// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::apps {

enum class Direction : std::uint8_t { kToCompanion, kToBoard };

/// Sees every frame as its sender hands it to the cable; a log.
class LinkTap {
 public:
  virtual ~LinkTap() = default;
  /// @param taken  the cable had room for it.
  virtual void on_frame(Direction direction, hal::Time t, const std::uint8_t* data,
                        std::size_t size, bool taken) = 0;
};

}  // namespace rosflight::apps
