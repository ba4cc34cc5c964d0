// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

namespace rosflight::boards {

/// Makes 64 bits of a 32-bit counter that counts up and wraps. It must be read at least
/// once per turn of the counter (171 s at 25 MHz).
class WideCounter {
 public:
  /// The wide count goes on from 0, the counter now showing `raw`.
  void start(std::uint32_t raw) {
    last_ = raw;
    count_ = 0;
  }
  /// @param raw  what the counter shows now. @returns counts since start().
  std::uint64_t at(std::uint32_t raw) {
    count_ += static_cast<std::uint32_t>(raw - last_);  // right across the wrap
    last_ = raw;
    return count_;
  }

 private:
  std::uint32_t last_{0};
  std::uint64_t count_{0};
};

}  // namespace rosflight::boards
