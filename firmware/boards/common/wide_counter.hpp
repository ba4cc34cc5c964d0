// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

namespace rosflight::boards {

/// Makes 64 bits of a 32-bit counter that counts up and wraps. It can be read in every context and masks nothing: what
/// it keeps are the half turns of the counter, one word that one interrupt writes. The counter's top bit says whether
/// that word is up to date, or one behind.
class WideCounter {
 public:
  /// The wide count goes on from 0, the counter now showing `raw`.
  void start(std::uint32_t raw) {
    half_turns_ = raw >> 31u;
    zero_ = raw;
  }
  /// From one periodic interrupt, at least twice per turn of the counter (every 85 s at 25 MHz).
  void keep(std::uint32_t raw) { half_turns_ = half_turns_at(half_turns_, raw); }
  /// @param read  a function that returns what the counter shows. @returns counts since start().
  template <class Read>
  std::uint64_t at(Read read) const {
    const std::uint32_t kept = half_turns_;  // before the counter: it may be behind but never ahead
    const std::uint32_t raw = read();
    const std::uint64_t turns = half_turns_at(kept, raw) / 2u;
    return (turns << 32u | raw) - zero_;
  }

 private:
  static std::uint32_t half_turns_at(std::uint32_t kept, std::uint32_t raw) {
    return kept + ((kept ^ raw >> 31u) & 1u);
  }

  volatile std::uint32_t half_turns_{0};
  std::uint64_t zero_{0};
};

}  // namespace rosflight::boards
