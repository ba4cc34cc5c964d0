// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/elementary.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/constants.hpp"

namespace rosflight::core {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

}  // namespace

/// Octants: |t| <= tan(pi/8) after turning by pi/4 where needed, atan t by an odd polynomial.
float atan2(float y, float x) {
  constexpr float kTanPiBy8 = 0.41421356f;
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float most = ax < ay ? ay : ax;
  const float least = ax < ay ? ax : ay;
  if (most == 0.0f) return 0.0f;
  const bool turned = least > kTanPiBy8 * most;
  const float t = turned ? (least - most) / (least + most) : least / most;
  const float z = t * t;
  const float p = -0.333333319f +
                  z * (0.199995564f + z * (-0.142643957f + z * (0.107476336f - z * 0.0646273033f)));
  float angle = t + t * (z * p);
  if (turned) angle = 0.785398163f + angle;
  if (ax < ay) angle = 1.57079633f - angle;
  if (x < 0.0f) angle = static_cast<float>(base::kPi) - angle;
  return y < 0.0f ? -angle : angle;
}

float asin(float sine) {
  return atan2(sine, std::sqrt((1.0f - sine) * (1.0f + sine)));
}

/// x = k pi/2 + r in double precision, |r| <= pi/4, then polynomials in r^2.
SinCos sin_cos(float angle_rad) {
  constexpr float kMaxAngle_rad = 1e6f;
  if (!(std::abs(angle_rad) <= kMaxAngle_rad)) return {kNan, kNan};
  const auto x = static_cast<double>(angle_rad);
  const double turns = x * 0.63661977236758134;
  const auto k = static_cast<std::int32_t>(turns + (turns < 0.0 ? -0.5 : 0.5));
  const auto r = static_cast<float>(x - static_cast<double>(k) * 1.5707963267948966);
  const float z = r * r;
  const float sine =
      r + r * (z * (-0.166666667f +
                    z * (0.00833333179f + z * (-0.000198400415f + z * 2.72440317e-6f))));
  const float cosine =
      1.0f - 0.5f * z + z * z * (0.0416666645f + z * (-0.00138882794f + z * 2.45429013e-5f));
  switch (static_cast<std::uint32_t>(k) & 3u) {
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

/// 2^(y log2 x) in double precision: x = 2^k m with m in [sqrt 1/2, sqrt 2),
/// ln m = 2 artanh((m - 1)/(m + 1)), and a Taylor series for the fraction that is left.
float pow(float x, float y) {
  if (!(x >= 0.0f) || y != y) return kNan;
  if (x < std::numeric_limits<float>::min()) return 0.0f;
  if (x > std::numeric_limits<float>::max()) return x;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  auto k = static_cast<std::int32_t>(bits >> 23u) - 127;
  bits = (bits & 0x007F'FFFFu) | 0x3F80'0000u;
  float mantissa = 0.0f;
  std::memcpy(&mantissa, &bits, sizeof mantissa);
  auto m = static_cast<double>(mantissa);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++k;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double series = 1.0 / 13.0;
  for (int n = 11; n >= 1; n -= 2) series = 1.0 / n + z * series;
  constexpr double kLn2 = 0.69314718055994531;
  const double power = static_cast<double>(y) * (static_cast<double>(k) + 2.0 * s * series / kLn2);
  constexpr double kMaxPower = 127.0;
  if (power > kMaxPower) return std::numeric_limits<float>::infinity();
  if (power < -kMaxPower) return 0.0f;
  const auto whole = static_cast<std::int32_t>(power + (power < 0.0 ? -0.5 : 0.5));
  const double r = (power - static_cast<double>(whole)) * kLn2;
  double sum = 1.0;
  for (int n = 9; n >= 1; --n) sum = 1.0 + r / n * sum;
  const auto scale_bits = static_cast<std::uint64_t>(whole + 1023) << 52u;
  double scale = 0.0;
  std::memcpy(&scale, &scale_bits, sizeof scale);
  return static_cast<float>(sum * scale);
}

}  // namespace rosflight::core
