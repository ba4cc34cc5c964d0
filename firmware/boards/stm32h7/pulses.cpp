// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/pulses.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr float kMaxRate_hz = 490.0f;
constexpr float kMinRate_hz = 1.0f;  // below, a period has no prescaler
constexpr float kShortest_us = 1000.0f, kSpan_us = 1000.0f;
constexpr std::uint32_t kPwm1 = 6;

/// NaN becomes 0.
float clamped(float value) {
  return value > 0.0f ? std::min(value, 1.0f) : 0.0f;
}

std::uint32_t rounded(float value) {
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
  return static_cast<std::uint32_t>(value + 0.5f);
}

}  // namespace

bool Pulses::configure(const hal::OutputRates& rates_hz) {
  disable();
  bool ok = true;
  for (std::size_t k = 0; k < count_; ++k) {
    const auto same = [this, k](const Channel& c) { return c.timer == channels_[k].timer; };
    if (std::any_of(channels_, channels_ + k, same)) continue;  // the timer has been set up
    float rate = -1.0f;
    for (std::size_t j = k; j < count_; ++j) {
      if (!same(channels_[j])) continue;
      float wanted = rates_hz[j];
      const bool possible = wanted == 0.0f || (wanted >= kMinRate_hz && wanted <= kMaxRate_hz);
      if (!possible) wanted = kMaxRate_hz;
      ok = ok && possible && (rate < 0.0f || rate == wanted);
      rate = rate < 0.0f ? wanted : std::min(rate, wanted);
    }
    start_timer(k, rate);
  }
  enabled_ = true;
  return ok;
}

/// All channels on the timer of channel `first`.
void Pulses::start_timer(std::size_t first, float rate_hz) {
  const Instance& timer = channels_[first].timer;
  open_gate(timer);
  reg(timer, tim::CR1) = tim::CR1_URS(1);
  std::uint32_t modes[2] = {0, 0};
  std::uint32_t enables = 0;
  std::uint32_t prescaler = 0;
  if (rate_hz > 0.0f) {
    const std::uint32_t period = rounded(static_cast<float>(kTimerClock_Hz) / rate_hz);
    prescaler = (period - 1) >> 16u;
    reg(timer, tim::PSC) = prescaler;
    reg(timer, tim::ARR) = period / (prescaler + 1) - 1;
  }
  constexpr float kTicksPerMicrosecond = static_cast<float>(kTimerClock_Hz) * 1e-6f;
  for (std::size_t k = first; k < count_; ++k) {
    const Channel& c = channels_[k];
    if (!(c.timer == timer)) continue;
    const std::uint32_t mode = tim::CCMR1_OC1M(kPwm1) | tim::CCMR1_OC1PE(1);
    modes[c.channel / 2] |= mode << (c.channel % 2 == 0 ? 0u : 8u);
    enables |= 1u << (4u * c.channel);
    ticks_per_us_[k] =
        rate_hz > 0.0f ? kTicksPerMicrosecond / static_cast<float>(prescaler + 1) : 0.0f;
    set_compare(k, 0);
  }
  reg(timer, tim::CCMR1) = modes[0];
  reg(timer, tim::CCMR2) = modes[1];
  reg(timer, tim::CCER) = enables;
  reg(timer, tim::EGR) = tim::EGR_UG(1);  // prescaler, period and compare values take effect
  if (channels_[first].advanced) reg(timer, tim::BDTR) = tim::BDTR_MOE(1);
  if (rate_hz > 0.0f) reg(timer, tim::CR1) = tim::CR1_URS(1) | tim::CR1_ARPE(1) | tim::CR1_CEN(1);
  for (std::size_t k = first; k < count_; ++k) {
    if (channels_[k].timer == timer) make_alternate(channels_[k].pin, channels_[k].function);
  }
}

void Pulses::set_compare(std::size_t index, std::uint32_t ticks) {
  const Channel& c = channels_[index];
  reg(c.timer, tim::CCR1 + 4u * c.channel) = ticks;
}

void Pulses::write(const hal::OutputValues& values) {
  if (!enabled_) return;
  for (std::size_t k = 0; k < count_; ++k) {
    const float us = kShortest_us + kSpan_us * clamped(values[k]);
    set_compare(k, rounded(us * ticks_per_us_[k]));
  }
}

void Pulses::disable() {
  if (!enabled_) return;
  enabled_ = false;
  for (std::size_t k = 0; k < count_; ++k) set_compare(k, 0);
}

}  // namespace rosflight::boards::stm32h7
