// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace rosflight::boards::parts::fuzz {

/// Bytes that end where a block of the heap ends, so that the sanitizer sees a read beyond them; without an allocation for
/// each, which took half of the time.
class ExactBlock {
 public:
  /// @param size  <= kMost. Valid until the next call.
  const std::uint8_t* holding(const std::uint8_t* data, std::size_t size) {
    std::uint8_t* const begin = block_.get() + kMost - size;
    std::copy_n(data, size, begin);
    return begin;
  }
  static constexpr std::size_t kMost = 2048;

 private:
  std::unique_ptr<std::uint8_t[]> block_{new std::uint8_t[kMost]};
};

}  // namespace rosflight::boards::parts::fuzz
