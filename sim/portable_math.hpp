// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/constants.hpp"

/// Elementary functions built from +, -, *, / and the square root (exact by IEEE 754) alone, so
/// that every machine and compiler gives the same bits. The C library's own may differ between
/// versions and between processors with and without fused multiply-add. Relative error below 4e-16
/// (exp, log) and 1e-15 |y log x| (pow), absolute error of sine and cosine below 3e-16 for |x| <
/// 1e5. log and pow take normal positive x; exp is 0 below -700 and infinite above 709, sine and
/// cosine are NaN beyond 1e15; a NaN gives a NaN.
namespace rosflight::sim::portable {

inline constexpr double kLn2High =
    0x1.62e42fee00000p-1;  // 33 bits: k * kLn2High is exact for |k| < 2^20
inline constexpr double kLn2Low = 0x1.a39ef35793c76p-33;

/// e^x by x = k ln 2 + r and the Taylor polynomial of degree 13 in |r| <= 0.35, in Estrin's order.
constexpr double exp(double x) {
  if (!(x > -700.0)) return x < 0.0 ? 0.0 : x;
  if (x > 709.0) return std::numeric_limits<double>::infinity();
  const double scaled = x * 1.4426950408889634;
  const auto k = static_cast<std::int64_t>(scaled + (scaled < 0.0 ? -0.5 : 0.5));
  const auto kd = static_cast<double>(k);
  const double r = (x - kd * kLn2High) - kd * kLn2Low;
  const double r2 = r * r;
  const double r4 = r2 * r2;
  const double r8 = r4 * r4;
  const double low = 0.5 + r / 6.0 + r2 * (1.0 / 24.0 + r / 120.0);
  const double mid =
      (1.0 / 720.0 + r * (1.0 / 5040.0)) + r2 * (1.0 / 40320.0 + r * (1.0 / 362880.0));
  const double high = (1.0 / 3628800.0 + r * (1.0 / 39916800.0)) +
                      r2 * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0));
  const double poly = 1.0 + (r + r2 * (low + r4 * mid + r8 * high));
  const auto power = std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52U);
  return poly * power;
}

/// Natural logarithm by x = 2^k m, m in [sqrt 1/2, sqrt 2), and log m = 2 artanh((m - 1)/(m + 1)).
constexpr double log(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto k = static_cast<std::int64_t>(bits >> 52U) - 1023;
  double m = std::bit_cast<double>((bits & 0x000F'FFFF'FFFF'FFFFU) | 0x3FF0'0000'0000'0000U);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++k;
  }
  const auto kd = static_cast<double>(k);
  const double f = m - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  const double z2 = z * z;
  const double z4 = z2 * z2;
  const double low = (1.0 / 3.0 + z * (1.0 / 5.0)) + z2 * (1.0 / 7.0 + z * (1.0 / 9.0));
  const double mid = (1.0 / 11.0 + z * (1.0 / 13.0)) + z2 * (1.0 / 15.0 + z * (1.0 / 17.0));
  const double high = (1.0 / 19.0 + z * (1.0 / 21.0)) + z2 * (1.0 / 23.0);
  const double tail = 2.0 * s * z * (low + z4 * mid + z4 * z4 * high);
  return kd * kLn2High + (2.0 * s + (tail + kd * kLn2Low));
}

/// x^y for x > 0.
constexpr double pow(double x, double y) {
  return exp(y * log(x));
}

struct SinCos {
  double sin;
  double cos;
};

/// Sine and cosine by x = k pi/2 + r and the Taylor polynomials of degrees 17 and 16 in |r| <=
/// pi/4.
constexpr SinCos sin_cos(double x) {
  constexpr double kPiHalfHigh =
      0x1.921fb50000000p+0;  // 26 bits: k * kPiHalfHigh is exact for |k| < 2^27
  constexpr double kPiHalfMiddle = 0x1.110b460000000p-26;
  constexpr double kPiHalfLow = 0x1.1a62633145c07p-54;
  if (x <= -1e15 || x >= 1e15 || x != x) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    return {kNan, kNan};
  }
  const double scaled = x * 0.63661977236758134;
  const auto k = static_cast<std::int64_t>(scaled + (scaled < 0.0 ? -0.5 : 0.5));
  const auto kd = static_cast<double>(k);
  const double r = ((x - kd * kPiHalfHigh) - kd * kPiHalfMiddle) - kd * kPiHalfLow;
  const double z = r * r;
  double s = 0.0;
  double c = 0.0;
  for (int n = 16; n >= 2; n -= 2) {
    s = z / static_cast<double>(n * (n + 1)) * (1.0 - s);
    c = z / static_cast<double>(n * (n - 1)) * (1.0 - c);
  }
  const double sine = r * (1.0 - s);
  const double cosine = 1.0 - c;
  switch (static_cast<std::uint64_t>(k) & 3U) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// Angle of the point (x, y) from the x axis, in (-pi, pi]; 0 for the origin. Two half-angle steps
/// bring the tangent below 0.2, the series to the 23rd power does the rest.
inline double atan2(double y, double x) {
  using base::kPi;
  const double ax = std::abs(x);
  const double ay = std::abs(y);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double t = ay < ax ? ay / ax : ax / ay;
  t = t / (1.0 + std::sqrt(1.0 + t * t));
  t = t / (1.0 + std::sqrt(1.0 + t * t));
  const double z = t * t;
  double series = 0.0;
  for (int n = 23; n >= 1; n -= 2) series = 1.0 / static_cast<double>(n) - z * series;
  double angle = 4.0 * t * series;
  if (ay >= ax) angle = 0.5 * kPi - angle;
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

}  // namespace rosflight::sim::portable
