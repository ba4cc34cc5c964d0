// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/activation.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace rosflight::core {
namespace {

/// e^x - 1 for 0 <= x <= 18. With x = k ln 2 + r, |r| <= ln 2/2:  2^k (e^r - 1) + (2^k - 1),
/// e^r - 1 by the first seven terms of its Taylor series, whose remainder is below 2e-8 of it. ln 2
/// in two parts, the first of nine bits: k times it is exact.
float exp_minus_1(float x) {
  constexpr float kLn2 = 0.693359375f;
  constexpr float kLn2Rest = -2.12194440e-4f;
  // x / ln 2 + 0.5 is not negative: the cast rounds it down, to the nearest k.
  const float above = x * 1.44269504f + 0.5f;
  const auto k = static_cast<std::int32_t>(above);
  const auto whole = static_cast<float>(k);
  const float r = (x - whole * kLn2) - whole * kLn2Rest;
  const float series =
      0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r / 5040))));
  const auto bits = static_cast<std::uint32_t>(k + 127) << 23u;
  float scale = 0.0f;
  std::memcpy(&scale, &bits, sizeof scale);
  return scale * (r + r * r * series) + (scale - 1.0f);
}

}  // namespace

/// (e^2x - 1)/(e^2x + 1), which differs from 1 by less than half a bit from 9 on.
float tanh(float x) {
  constexpr float kOneFrom = 9.1f;
  const float size = std::abs(x);
  if (size != size) return x;
  float value = 1.0f;
  if (size < kOneFrom) {
    const float e = exp_minus_1(2.0f * size);
    value = e / (e + 2.0f);
  }
  return x < 0.0f ? -value : value;
}

float sigmoid(float x) {
  return 0.5f + 0.5f * tanh(0.5f * x);
}

}  // namespace rosflight::core
