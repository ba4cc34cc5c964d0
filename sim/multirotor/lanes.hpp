// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstddef>

namespace rosflight::sim {

/// Four numbers worked on at once: two 16-byte vectors of the compiler, which every 64-bit
/// processor has and which stay in registers. Each lane does what a double does, so results do not
/// depend on the machine.
struct Lanes {
  using Pair [[gnu::vector_size(16)]] = double;

  Pair low;
  Pair high;

  Lanes() = default;  ///< Any numbers: clearing what is filled next would cost.
  /// The four numbers of two pairs.
  Lanes(Pair first, Pair second) : low{first}, high{second} {}
  /// The same in all lanes: a number is Lanes.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Lanes(double x) : low{x, x}, high{x, x} {}
  Lanes(double a, double b, double c, double d) : low{a, b}, high{c, d} {}

  double operator[](std::size_t i) const { return i < 2 ? low[i] : high[i - 2]; }
  /// Sets lane i, 0..3.
  void set(std::size_t i, double x) {
    Pair& pair = i < 2 ? low : high;
    pair[i % 2] = x;
  }
};

inline Lanes operator+(Lanes a, Lanes b) {
  return {a.low + b.low, a.high + b.high};
}
inline Lanes operator-(Lanes a, Lanes b) {
  return {a.low - b.low, a.high - b.high};
}
inline Lanes operator*(Lanes a, Lanes b) {
  return {a.low * b.low, a.high * b.high};
}
inline Lanes operator/(Lanes a, Lanes b) {
  return {a.low / b.low, a.high / b.high};
}
inline Lanes operator-(Lanes a) {
  return {-a.low, -a.high};
}

/// The larger number of each lane.
inline Lanes max(Lanes a, Lanes b) {
  return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}
/// The smaller number of each lane.
inline Lanes min(Lanes a, Lanes b) {
  return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
}
/// yes where x > 0, else no.
inline Lanes where_positive(Lanes x, Lanes yes, Lanes no) {
  const Lanes::Pair zero{};
  return {x.low > zero ? yes.low : no.low, x.high > zero ? yes.high : no.high};
}
/// The square root of each lane.
inline Lanes sqrt(Lanes a) {
  return {std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
/// The sum of all lanes, always in the same order.
inline double sum(Lanes a) {
  const Lanes::Pair s = a.low + a.high;
  return s[0] + s[1];
}

/// Four vectors.
struct Vector3Lanes {
  Lanes x, y, z;
};

}  // namespace rosflight::sim
