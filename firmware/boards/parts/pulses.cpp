// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/pulses.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint32_t kMaxCounts = 65'536;
constexpr std::uint16_t kMinThrottle = 48, kMaxThrottle = 2047;
constexpr float kMicrosecondsPerSecond = 1e6f;

bool is_pwm(float rate_hz) {
  return rate_hz >= kMinPwm_hz && rate_hz <= kMaxPwm_hz;
}
bool is_dshot(float rate_hz) {
  return rate_hz >= kMinDshot_hz && rate_hz <= kMaxDshot_hz;
}

/// NaN becomes 0.
float limited(float value) {
  return value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
}

std::uint32_t rounded(float value) {
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
  return static_cast<std::uint32_t>(value + 0.5f);
}

}  // namespace

PulsePlan plan_pulses(const float* rates_hz, std::size_t channels, std::uint32_t timer_hz) {
  using Status = PulsePlan::Status;
  PulsePlan plan;
  for (std::size_t k = 0; k < channels; ++k) {
    const float rate = rates_hz[k];
    if (rate == 0.0f) continue;
    if (!is_pwm(rate) && !is_dshot(rate)) {
      plan.status = Status::kOutOfRange;
      continue;
    }
    if (plan.rate_hz != 0.0f && rate != plan.rate_hz && plan.status == Status::kOk) {
      plan.status = Status::kMixedRates;
    }
    if (plan.rate_hz == 0.0f || rate < plan.rate_hz) plan.rate_hz = rate;
  }
  if (plan.rate_hz == 0.0f) return plan;
  plan.kind = is_pwm(plan.rate_hz) ? PulseKind::kPwm : PulseKind::kDshot;
  const float undivided = static_cast<float>(timer_hz) / plan.rate_hz;
  if (plan.kind == PulseKind::kPwm) {
    plan.prescaler =
        static_cast<std::uint32_t>((undivided - 0.5f) / static_cast<float>(kMaxCounts));
  }
  const float divided_hz = static_cast<float>(timer_hz) / static_cast<float>(plan.prescaler + 1);
  plan.period = rounded(divided_hz / plan.rate_hz);
  plan.counts_per_us = divided_hz / kMicrosecondsPerSecond;
  return plan;
}

std::uint32_t pwm_counts(const PulsePlan& plan, float value) {
  return rounded((1000.0f + 1000.0f * limited(value)) * plan.counts_per_us);
}

std::uint16_t dshot_throttle(float value) {
  const float v = limited(value);
  if (v == 0.0f) return 0;
  constexpr auto kSpan = static_cast<float>(kMaxThrottle - kMinThrottle);
  return static_cast<std::uint16_t>(kMinThrottle + rounded(kSpan * v));
}

std::uint16_t dshot_frame(std::uint16_t throttle, bool telemetry) {
  const unsigned x = (throttle & 0x7FFu) << 1 | (telemetry ? 1u : 0u);
  const unsigned checksum = (x ^ x >> 4 ^ x >> 8) & 0xFu;
  return static_cast<std::uint16_t>(x << 4 | checksum);
}

std::array<std::uint16_t, kDshotCounts> dshot_counts(std::uint16_t frame, std::uint32_t period) {
  const auto one = static_cast<std::uint16_t>((period * 3 + 2) / 4);
  const auto zero = static_cast<std::uint16_t>((period * 3 + 4) / 8);
  std::array<std::uint16_t, kDshotCounts> counts{};
  for (unsigned k = 0; k < 16; ++k) counts[k] = (frame >> (15 - k) & 1) != 0 ? one : zero;
  return counts;
}

}  // namespace rosflight::boards::parts
