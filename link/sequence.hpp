// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "link/codec.hpp"

namespace rosflight::link {

/// Counts frames of the peer that did not arrive, by their sequence numbers (one byte, wrapping).
///
/// Urgent frames overtake others in the sender's queues, so a number up to half the circle back
/// belongs to a frame that was counted as missing and arrived late.
class SequenceWatch {
 public:
  /// Call it before the frame is added to counters.frames_received: the first one sets the start.
  void count(std::uint8_t sequence, Codec::Counters& counters) {
    constexpr unsigned kHalfCircle = 128;
    const auto ahead = static_cast<std::uint8_t>(sequence - expected_);
    if (counters.frames_received == 0) {
      expected_ = static_cast<std::uint8_t>(sequence + 1);
    } else if (ahead < kHalfCircle) {
      counters.sequence_gaps += ahead;
      expected_ = static_cast<std::uint8_t>(sequence + 1);
    } else if (counters.sequence_gaps > 0) {
      --counters.sequence_gaps;
    }
  }

 private:
  std::uint8_t expected_{0};
};

}  // namespace rosflight::link
