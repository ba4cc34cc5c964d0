// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::core {

/// Numbers from a seed, the same on every machine: SplitMix64 (Steele, Lea and Flood 2014,
/// "Fast Splittable Pseudorandom Number Generators", fig. 14).
class Random {
 public:
  explicit Random(std::uint64_t seed = 0) : state_{seed} {}

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// 0..n-1; n > 0.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((next() >> 32) * n) >> 32);
  }
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(next() % static_cast<std::uint64_t>(high - low + 1));
  }
  float uniform(float low, float high) {
    constexpr float kUnit = 1.0f / 16'777'216.0f;  // 2^-24
    return low + (high - low) * (static_cast<float>(next() >> 40) * kUnit);
  }
  bool chance(float probability) { return uniform(0.0f, 1.0f) < probability; }
  template <class Value, std::size_t n>
  const Value& pick(const std::array<Value, n>& values) {
    return values[below(static_cast<std::uint32_t>(n))];
  }

 private:
  std::uint64_t state_;
};

}  // namespace rosflight::core
