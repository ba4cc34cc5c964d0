// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "messages/rosflight_log_msgs.hpp"
#include "sim/types.hpp"

/// What a board received as a message, and back, to the bit.
namespace rosflight::messages {

/// What a board received in one step of the simulation.
struct StepInputs {
  hal::Time time{};
  sim::SensorSamples samples;
  std::optional<hal::RcFrame> receiver;
  std::vector<std::uint8_t> bytes;  ///< That its firmware read from the serial port.
};

/// Appends what the sensors and the receiver (nullptr: nothing) delivered at `now`.
/// @param delay_us  `now` after the input before it.
void append(const sim::SensorSamples& samples, const hal::RcFrame* receiver, hal::Time now,
            std::uint32_t delay_us, rosflight_log_msgs::BoardInputs& out);
void append(std::span<const std::uint8_t> bytes, std::uint32_t delay_us,
            rosflight_log_msgs::BoardInputs& out);

/// Adds the inputs of a message to `steps`, a step for each time, in their order.
/// @param start  stamp of the message in simulated time.
/// @returns false for a message whose parts do not fit together.
bool append_to(std::vector<StepInputs>& steps, hal::Time start,
               const rosflight_log_msgs::BoardInputs& in);

}  // namespace rosflight::messages
