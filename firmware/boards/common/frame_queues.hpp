// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "firmware/boards/common/byte_ring.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// Whole frames on their way to a serial port, by urgency: the most urgent goes next, one that has
/// begun is not interrupted. The main loop puts, an interrupt takes; put() is called with that
/// interrupt masked.
template <std::size_t N>
class FrameQueues {
 public:
  /// @returns false if it does not fit, or is empty; it is counted then.
  bool put(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
    Queue& queue = queues_[hal::Serial::class_of(qos)];
    if (size == 0 || size + kHeader > queue.room()) {
      ++dropped_;
      return false;
    }
    const std::uint8_t header[kHeader] = {static_cast<std::uint8_t>(size & 0xFFu),
                                          static_cast<std::uint8_t>(size >> 8u)};
    queue.put(header, kHeader);
    queue.put(data, size);
    return true;
  }
  /// Bytes of ordinary frames that fit.
  std::size_t writable() const {
    const std::size_t room = queues_.back().room();
    return room > kHeader ? room - kHeader : 0;
  }
  bool empty() const {
    return remaining_ == 0 &&
           std::all_of(queues_.begin(), queues_.end(), [](const Queue& q) { return q.empty(); });
  }
  /// Up to `capacity` bytes of the frame that goes next. @returns the number, 0 if none waits.
  std::size_t take(std::uint8_t* data, std::size_t capacity) {
    if (remaining_ == 0 && !begin_next()) return 0;
    const std::size_t count = std::min(remaining_, capacity);
    queues_[sending_].take(data, count);
    remaining_ -= count;
    return count;
  }
  std::uint32_t dropped() const { return dropped_; }

 private:
  static constexpr std::size_t kHeader = 2;  ///< The frame's size, before each frame.
  using Queue = ByteRing<N>;

  bool begin_next() {
    const auto* const next =
        std::find_if(queues_.begin(), queues_.end(), [](const Queue& q) { return !q.empty(); });
    if (next == queues_.end()) return false;
    sending_ = static_cast<std::size_t>(next - queues_.begin());
    remaining_ = static_cast<std::size_t>(next->peek(0)) | static_cast<std::size_t>(next->peek(1))
                                                               << 8u;
    queues_[sending_].drop(kHeader);
    return true;
  }

  std::array<Queue, hal::Serial::kClasses> queues_;
  std::size_t sending_{0};    ///< Queue of the frame on its way.
  std::size_t remaining_{0};  ///< Bytes of that frame not sent yet.
  std::uint32_t dropped_{0};
};

}  // namespace rosflight::boards
