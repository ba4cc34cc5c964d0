// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// Frames that wait for the wire: urgent before timely before ordinary, in each class in the order
/// they came. Bounded in bytes over all classes; takes its memory at construction.
class TransmitQueue {
 public:
  static constexpr std::size_t kMaxFrame = 1024;

  explicit TransmitQueue(std::size_t capacity);

  /// @param qos  As hal::Serial::class_of() has it.
  /// @returns false, with nothing queued, for an empty or too large frame or without room.
  bool push(const std::uint8_t* data, std::size_t size, std::uint8_t qos);
  /// Moves whole frames to `data` as long as they fit. @returns their bytes.
  std::size_t take(std::uint8_t* data, std::size_t capacity);
  void clear();

  std::size_t size() const { return size_; }
  std::size_t room() const { return capacity_ - size_; }
  bool empty() const { return size_ == 0; }

 private:
  /// Bytes of frames, each behind its size in two bytes, in a ring.
  struct Class {
    std::vector<std::uint8_t> ring;
    std::size_t first{0};
    std::size_t used{0};
  };
  static void put(Class& c, const std::uint8_t* data, std::size_t count);
  static void peek(const Class& c, std::uint8_t* data, std::size_t count, std::size_t skip);

  std::size_t capacity_;
  std::size_t size_{0};
  std::array<Class, hal::Serial::kClasses> classes_;
};

}  // namespace rosflight::boards
