// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstddef>
#include <cstring>

/// ROSFLIGHT_WIDE before the definition of a function compiles it twice, for processors with AVX2 too; which of the two
/// runs is chosen when the program is loaded. Both do the same operations in the same order and neither fuses any, so they
/// give the same bits. What such a function calls with Lanes must be inlined: processors with AVX2 pass them in another way.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ROSFLIGHT_WIDE [[gnu::flatten, gnu::target_clones("avx2", "default")]]
#else
#define ROSFLIGHT_WIDE
#endif
/// Before the definition of a function with Lanes: never called, always inlined.
#define ROSFLIGHT_INLINE [[gnu::always_inline]] inline

namespace rosflight::sim {

/// Four numbers worked on at once, by one instruction each in a ROSFLIGHT_WIDE function and by two elsewhere. Each lane
/// does what a double does, so results do not depend on the machine.
struct Lanes {
  static constexpr std::size_t kCount = 4;
  using Four [[gnu::vector_size(32)]] = double;
  using Two [[gnu::vector_size(16)]] = double;

  Four v;

  Lanes() = default;  ///< Any numbers: clearing what is filled next would cost.
  ROSFLIGHT_INLINE explicit Lanes(const Four& four) : v{four} {}
  /// The same in all lanes: a number is Lanes.
  // NOLINTNEXTLINE(google-explicit-constructor)
  ROSFLIGHT_INLINE Lanes(double x) : v{x - Four{}} {}  // a broadcast; no number changes less 0
  ROSFLIGHT_INLINE Lanes(double a, double b, double c, double d) : v{a, b, c, d} {}

  /// Four numbers that lie anywhere.
  ROSFLIGHT_INLINE static Lanes load(const double* from) {
    Lanes lanes;
    std::memcpy(&lanes.v, from, sizeof lanes.v);
    return lanes;
  }
  ROSFLIGHT_INLINE void store(double* to) const { std::memcpy(to, &v, sizeof v); }

  ROSFLIGHT_INLINE double operator[](std::size_t i) const { return v[i]; }
  /// Sets lane i, 0..3.
  ROSFLIGHT_INLINE void set(std::size_t i, double x) { v[i] = x; }
};

ROSFLIGHT_INLINE Lanes operator+(const Lanes& a, const Lanes& b) {
  return Lanes(a.v + b.v);
}
ROSFLIGHT_INLINE Lanes operator-(const Lanes& a, const Lanes& b) {
  return Lanes(a.v - b.v);
}
ROSFLIGHT_INLINE Lanes operator*(const Lanes& a, const Lanes& b) {
  return Lanes(a.v * b.v);
}
ROSFLIGHT_INLINE Lanes operator/(const Lanes& a, const Lanes& b) {
  return Lanes(a.v / b.v);
}
ROSFLIGHT_INLINE Lanes operator-(const Lanes& a) {
  return Lanes(-a.v);
}

/// The larger number of each lane.
ROSFLIGHT_INLINE Lanes max(const Lanes& a, const Lanes& b) {
  return Lanes(a.v > b.v ? a.v : b.v);
}
/// The smaller number of each lane.
ROSFLIGHT_INLINE Lanes min(const Lanes& a, const Lanes& b) {
  return Lanes(a.v < b.v ? a.v : b.v);
}
/// yes where x > 0, else no.
ROSFLIGHT_INLINE Lanes where_positive(const Lanes& x, const Lanes& yes, const Lanes& no) {
  return Lanes(x.v > Lanes::Four{} ? yes.v : no.v);
}
/// The square root of each lane.
ROSFLIGHT_INLINE Lanes sqrt(const Lanes& a) {
  return {std::sqrt(a.v[0]), std::sqrt(a.v[1]), std::sqrt(a.v[2]), std::sqrt(a.v[3])};
}
/// The sum of all lanes, always in the same order.
ROSFLIGHT_INLINE double sum(const Lanes& a) {
  const Lanes::Two s = Lanes::Two{a.v[0], a.v[1]} + Lanes::Two{a.v[2], a.v[3]};
  return s[0] + s[1];
}

/// Four vectors.
struct Vector3Lanes {
  Lanes x, y, z;
};

}  // namespace rosflight::sim
