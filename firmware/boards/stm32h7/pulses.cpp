// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/pulses.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

/// Modes of a channel's output: forced low or high, or high while the counter is below the compare value, which
/// is low while that is 0.
constexpr std::uint32_t kForcedLow = 4, kForcedHigh = 5, kPwm1 = 6;
/// Bits in which they differ; of these only the lowest is set in kForcedHigh, none in kForcedLow.
constexpr std::uint32_t kModeBits = 3;
/// 18 bits of the slowest DShot: a frame on its way is not cut.
constexpr std::uint32_t kLongestTrain_us = 120;
static_assert((kPwm1 & ~kModeBits) == kForcedLow && kForcedHigh == (kForcedLow | 1u));

}  // namespace

bool Pulses::configure(const hal::OutputRates& rates_hz) {
  disable();
  std::uint32_t levels = 0;
  bool ok = true;
  for (std::size_t g = 0; g < kMaxGroups; ++g) {
    std::array<float, kTimerChannels> rates{};
    std::size_t members = 0;
    for (std::size_t k = 0; k < pins_.count; ++k) {
      if (!(channel(k).timer == pins_.groups[g].timer)) continue;
      group_of_[k] = static_cast<std::uint8_t>(g);
      rates[members++] = rates_hz[k];
      levels |= std::uint32_t{rates_hz[k] == 0.0f} << k;
    }
    plans_[g] = parts::plan_pulses(rates.data(), members, kTimerClock_Hz);
    ok = ok && plans_[g].status == parts::PulsePlan::Status::kOk;
    start_timer(g);
  }
  levels_ = static_cast<std::uint16_t>(levels);
  enabled_ = true;
  return ok;
}

void Pulses::start_timer(std::size_t group) {
  const auto& [timer, stream, request] = pins_.groups[group];
  const parts::PulsePlan& plan = plans_[group];
  const bool runs = plan.kind != parts::PulseKind::kOff;
  open_gate(timer);
  reg(timer, tim::CR1) = tim::CR1_URS(1);
  reg(timer, tim::DIER) = 0;
  DmaStream{stream}.connect(
      {request, DmaStream::Direction::kToRegister, false, false, false, false, true});
  if (runs) {
    reg(timer, tim::PSC) = plan.prescaler;
    reg(timer, tim::ARR) = plan.period - 1;
  }
  std::uint32_t modes[2] = {0, 0};
  std::uint32_t enables = 0;
  bool advanced = false;
  for (std::size_t k = 0; k < pins_.count; ++k) {
    const Channel& c = channel(k);
    if (!(c.timer == timer)) continue;
    const std::uint32_t mode = tim::CCMR1_OC1M(kPwm1) | tim::CCMR1_OC1PE(1);
    modes[c.channel / 2] |= mode << (c.channel % 2 == 0 ? 0u : 8u);
    enables |= 1u << (4u * c.channel);
    advanced = c.advanced;
    reg(timer, tim::CCR1 + 4u * c.channel) = 0;
  }
  reg(timer, tim::CCMR1) = modes[0];
  reg(timer, tim::CCMR2) = modes[1];
  reg(timer, tim::CCER) = enables;
  reg(timer, tim::EGR) = tim::EGR_UG(1);  // prescaler, period and compare values take effect
  if (advanced) reg(timer, tim::BDTR) = tim::BDTR_MOE(1);
  if (plan.kind == parts::PulseKind::kDshot) {
    constexpr std::uint32_t kFromCcr1 = tim::CCR1 / 4u;
    reg(timer, tim::DCR) = tim::DCR_DBA(kFromCcr1) | tim::DCR_DBL(kTimerChannels - 1);
    reg(timer, tim::DIER) = tim::DIER_UDE(1);
  }
  if (runs) reg(timer, tim::CR1) = tim::CR1_URS(1) | tim::CR1_ARPE(1) | tim::CR1_CEN(1);
  for (std::size_t k = 0; k < pins_.count; ++k) {
    if (channel(k).timer == timer) make_alternate(channel(k).pin, channel(k).function);
  }
}

void Pulses::write(const hal::OutputValues& values) {
  if (!enabled_) return;
  set_levels(values);
  for (std::size_t g = 0; g < kMaxGroups; ++g) {
    if (plans_[g].kind == parts::PulseKind::kDshot) write_frames(g, values);
  }
  for (std::size_t k = 0; k < pins_.count; ++k) {
    const parts::PulsePlan& plan = plans_[group_of_[k]];
    if (plan.kind != parts::PulseKind::kPwm) continue;
    const Channel& c = channel(k);
    reg(c.timer, tim::CCR1 + 4u * c.channel) = parts::pwm_counts(plan, values[k]);
  }
}

void Pulses::set_levels(const hal::OutputValues& values) const {
  for (std::size_t k = 0; k < pins_.count; ++k) {
    if ((levels_ >> k & 1u) == 0) continue;
    const Channel& c = channel(k);
    volatile std::uint32_t& modes = reg(c.timer, tim::CCMR1 + 4u * (c.channel / 2u));
    const std::uint32_t lsb = tim::CCMR1_OC1M.lsb + 8u * (c.channel % 2u);
    modes = (modes & ~(kModeBits << lsb)) | std::uint32_t{values[k] >= kHighLevel} << lsb;
  }
}

void Pulses::write_frames(std::size_t group, const hal::OutputValues& values) {
  const Group& here = pins_.groups[group];
  DmaStream stream{here.stream};
  if (stream.runs()) return;
  Burst& burst = memory_.bursts[group];
  burst.fill(0);
  for (std::size_t k = 0; k < pins_.count; ++k) {
    const Channel& c = channel(k);
    if (!(c.timer == here.timer)) continue;
    const std::uint16_t frame = parts::dshot_frame(parts::dshot_throttle(values[k]), false);
    const auto counts = parts::dshot_counts(frame, plans_[group].period);
    for (std::size_t bit = 0; bit < counts.size(); ++bit) {
      burst[kTimerChannels * bit + c.channel] = counts[bit];
    }
  }
  stream.connect(
      {here.request, DmaStream::Direction::kToRegister, false, false, false, false, true});
  stream.start(here.timer.base + tim::DMAR, burst.data(), burst.size());
}

void Pulses::disable() {
  if (!enabled_) return;
  enabled_ = false;
  const auto sends = [](const Group& group) { return DmaStream{group.stream}.runs(); };
  if (std::any_of(pins_.groups.begin(), pins_.groups.end(), sends)) wait_us(kLongestTrain_us);
  for (const Group& each : pins_.groups) {
    DmaStream stream{each.stream};
    if (stream.runs()) stream.stop();
  }
  for (std::size_t k = 0; k < pins_.count; ++k) {
    reg(channel(k).timer, tim::CCR1 + 4u * channel(k).channel) = 0;
  }
  set_levels({});
}

}  // namespace rosflight::boards::stm32h7
