// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "sim/types.hpp"

namespace rosflight::flight {

enum class Direction : std::uint8_t { kToCompanion, kToAutopilot };

/// Receives a copy of every frame on the link and of what the board receives, such as a log or a meter.
class LinkTap {
 public:
  virtual ~LinkTap() = default;
  /// @param t  simulated time at which the sender hands the frame over.
  /// @param taken  false: the frame found no room and is lost.
  virtual void on_frame(Direction direction, hal::Time t, const std::uint8_t* data,
                        std::size_t size, bool taken) = 0;
  /// The firmware has read these bytes from its serial port.
  virtual void on_read(hal::Time /*t*/, const std::uint8_t* /*data*/, std::size_t /*size*/) {}
  /// The board receives samples and a receiver frame (nullptr: none). Of the firmware in this process.
  virtual void on_inputs(hal::Time /*t*/, const sim::SensorSamples& /*samples*/,
                         const hal::RcFrame* /*receiver*/) {}
};

}  // namespace rosflight::flight
