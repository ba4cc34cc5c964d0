// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace rosflight::boards {

/// Bytes between an interrupt and the main loop: one of them puts, the other takes, nobody locks.
/// The counters run freely; their difference is what waits. N is a power of two.
template <std::size_t N>
class ByteRing {
  static_assert((N & (N - 1)) == 0 && N > 0);

 public:
  std::size_t size() const { return put_ - taken_; }
  std::size_t room() const { return N - size(); }
  bool empty() const { return put_ == taken_; }

  /// `count` <= room(). Visible to the taker all at once.
  void put(const std::uint8_t* data, std::size_t count) {
    const std::uint32_t first = put_;
    const std::size_t place = first % N;
    const std::size_t until_end = std::min(count, N - place);
    std::copy_n(data, until_end, bytes_.begin() + place);
    std::copy_n(data + until_end, count - until_end, bytes_.begin());
    std::atomic_thread_fence(std::memory_order_seq_cst);
    put_ = first + static_cast<std::uint32_t>(count);
  }
  /// `skip` < size().
  std::uint8_t peek(std::size_t skip = 0) const { return bytes_[(taken_ + skip) % N]; }
  /// `count` <= size().
  void drop(std::size_t count) {
    std::atomic_thread_fence(std::memory_order_seq_cst);
    taken_ = taken_ + static_cast<std::uint32_t>(count);
  }
  std::uint8_t take() {
    const std::uint8_t byte = peek();
    drop(1);
    return byte;
  }
  /// `count` <= size().
  void take(std::uint8_t* data, std::size_t count) {
    const std::size_t place = taken_ % N;
    const std::size_t until_end = std::min(count, N - place);
    std::copy_n(bytes_.begin() + place, until_end, data);
    std::copy_n(bytes_.begin(), count - until_end, data + until_end);
    drop(count);
  }

 private:
  std::array<std::uint8_t, N> bytes_{};
  volatile std::uint32_t put_{0};
  volatile std::uint32_t taken_{0};
};

}  // namespace rosflight::boards
