// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/gyro_chain.hpp"

#include <cmath>
#include <limits>

namespace rosflight::core {
namespace {

constexpr float kSqrt2 = 1.41421356f;

float tangent(float angle_rad) {
  const SinCos x = sin_cos(angle_rad);
  return x.sin / x.cos;
}

}  // namespace

GyroChain::Refused GyroChain::configure(const Config& config) {
  const float highest_Hz = kMaxFrequencyRatio * config.sample_rate_Hz;
  const auto possible = [highest_Hz](float frequency_Hz) {  // false for NaN
    return frequency_Hz > 0.0f && frequency_Hz < highest_Hz;
  };
  sample_rate_Hz_ = config.sample_rate_Hz;
  low_pass_ = notch_ = Section{};
  if (possible(config.low_pass_Hz)) {
    const float w = tangent(kPi * config.low_pass_Hz / config.sample_rate_Hz);
    const float scale = 1.0f / (1.0f + kSqrt2 * w + w * w);
    low_pass_.on = true;
    low_pass_.b0 = w * w * scale;
    low_pass_.b1 = 2.0f * low_pass_.b0;
    low_pass_.a1 = 2.0f * (w * w - 1.0f) * scale;
    low_pass_.a2 = (1.0f - kSqrt2 * w + w * w) * scale;
  }
  if (possible(config.notch_Hz) && possible(config.notch_width_Hz)) {
    const float b = tangent(kPi * config.notch_width_Hz / config.sample_rate_Hz);
    const float scale = 1.0f / (1.0f + b);
    const float cosine = sin_cos(2.0f * kPi * config.notch_Hz / config.sample_rate_Hz).cos;
    notch_.on = true;
    notch_.b0 = scale;
    notch_.b1 = notch_.a1 = -2.0f * cosine * scale;
    notch_.a2 = 2.0f * scale - 1.0f;
  }
  // The largest number of a converter is a count short of full scale; 16 bits have 3e-5 of it.
  constexpr float kLastCount = 0.99995f;
  clip_rad_s_ = config.full_scale_rad_s > 0.0f ? kLastCount * config.full_scale_rad_s
                                               : std::numeric_limits<float>::max();
  settled_ = false;
  return {config.low_pass_Hz != 0.0f && !low_pass_.on, config.notch_Hz != 0.0f && !notch_.on};
}

Vector3 GyroChain::step(const Vector3& rate_rad_s) {
  const float largest = rate_rad_s.cwiseAbs().maxCoeff();
  const float sum = rate_rad_s.sum();
  if (!std::isfinite(sum)) return rate_rad_s;
  if (largest >= clip_rad_s_) ++clipped_;
  if (!settled_) {
    settled_ = true;
    low_pass_.settle(rate_rad_s);
    notch_.settle(rate_rad_s);
  }
  Vector3 y = rate_rad_s;
  if (low_pass_.on) y = low_pass_.step(y);
  if (notch_.on) y = notch_.step(y);
  return y;
}

float GyroChain::group_delay_s(float frequency_Hz) const {
  const bool sampled = frequency_Hz >= 0.0f && frequency_Hz < 0.5f * sample_rate_Hz_;
  if (!sampled) return 0.0f;  // or not a number
  const float angle = 2.0f * kPi * frequency_Hz / sample_rate_Hz_;
  float samples = 0.0f;
  if (low_pass_.on) samples += low_pass_.delay_samples(angle);
  if (notch_.on) samples += notch_.delay_samples(angle);
  return samples / sample_rate_Hz_;
}

void GyroChain::Section::settle(const Vector3& x) {
  // The steady state y = x: the gain of both filters at 0 Hz is 1.
  z2 = (b0 - a2) * x;
  z1 = (b1 - a1) * x + z2;
}

Vector3 GyroChain::Section::step(const Vector3& x) {
  const Vector3 y = b0 * x + z1;
  z1 = b1 * x - a1 * y + z2;
  z2 = b0 * x - a2 * y;
  return y;
}

float GyroChain::Section::delay_samples(float angle_rad) const {
  // -d(phase)/d(angle) of the numerator, which is symmetric, is one sample; that of 1/A(z) is
  // -Re( sum n a_n z^-n / sum a_n z^-n ).
  const SinCos e1 = sin_cos(angle_rad);
  const SinCos e2 = sin_cos(2.0f * angle_rad);
  const float re = 1.0f + a1 * e1.cos + a2 * e2.cos;
  const float im = -a1 * e1.sin - a2 * e2.sin;
  const float re_n = a1 * e1.cos + 2.0f * a2 * e2.cos;
  const float im_n = -a1 * e1.sin - 2.0f * a2 * e2.sin;
  return 1.0f - (re_n * re + im_n * im) / (re * re + im * im);
}

}  // namespace rosflight::core
