// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace rosflight::boards::parts {

/// Samples on their way from the bus context to the main loop: one puts, the other takes, nobody
/// locks. Holds N; a further one replaces the newest, which is counted as dropped, so that a main loop that
/// was away finds the newest last. The oldest may be being read: the bus context interrupts the main loop,
/// never the reverse.
template <class Sample, std::uint32_t N = 4>
class Handover {
  static_assert(N > 1 && (N & (N - 1)) == 0, "the counters wrap, and the newest is not the oldest");

 public:
  /// Bus context. @returns false if it replaced another one.
  bool put(const Sample& sample) {
    const std::uint32_t put = put_.load(std::memory_order_relaxed);
    if (put - taken_.load(std::memory_order_acquire) == N) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      samples_[(put - 1) % N] = sample;
      return false;
    }
    samples_[put % N] = sample;
    put_.store(put + 1, std::memory_order_release);
    return true;
  }
  /// Main loop. The oldest sample; false, and `sample` untouched, if there is none.
  bool take(Sample& sample) {
    const std::uint32_t taken = taken_.load(std::memory_order_relaxed);
    if (put_.load(std::memory_order_acquire) == taken) return false;
    sample = samples_[taken % N];
    taken_.store(taken + 1, std::memory_order_release);
    return true;
  }
  /// Samples that were put since the start, those that were dropped not counted.
  std::uint32_t count() const { return put_.load(std::memory_order_relaxed); }
  std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::array<Sample, N> samples_{};
  std::atomic<std::uint32_t> put_{0};
  std::atomic<std::uint32_t> taken_{0};
  std::atomic<std::uint32_t> dropped_{0};
};

}  // namespace rosflight::boards::parts
