// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/timer_model.hpp"

#include <algorithm>
#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kForcedLow = 4, kForcedHigh = 5;
constexpr std::uint32_t kPwm1 = 6;  // active while the counter is below the compare value

}  // namespace

TimerModel::TimerModel(Core& core, std::string name, const Instance& instance,
                       const ClockTree& clocks, unsigned irq, Kind kind, const DmaRequests* dma,
                       std::uint32_t update_request)
    : Peripheral{core, std::move(name), "TIM", instance},
      clocks_{clocks},
      irq_{irq},
      kind_{kind},
      dma_{dma},
      update_request_{update_request} {}

void TimerModel::reset() {
  Peripheral::reset();
  word(tim::ARR) = kind_ == Kind::kWide ? 0xFFFF'FFFFU : 0xFFFFU;
  active_reload_ = word(tim::ARR);
  active_prescaler_ = stopped_at_ = 0;
  active_compare_.fill(0);
  throttle_.fill(0);
  frames_.fill(0);
  high_ = {};
  for (auto& train : train_) train.clear();
  if (on_change) on_change();
}

std::uint32_t TimerModel::count() const {
  if (!counts()) return stopped_at_;
  return static_cast<std::uint32_t>((core().now() - zero_) / tick() %
                                    (std::uint64_t{active_reload_} + 1));
}

std::uint32_t TimerModel::mode(std::size_t channel) const {
  const std::uint32_t modes = word(channel < 2 ? tim::CCMR1 : tim::CCMR2);
  return (channel % 2 == 0 ? tim::CCMR1_OC1M : tim::CCMR1_OC2M).of(modes);
}

bool TimerModel::preloads(std::size_t channel) const {
  const std::uint32_t modes = word(channel < 2 ? tim::CCMR1 : tim::CCMR2);
  return (channel % 2 == 0 ? tim::CCMR1_OC1PE : tim::CCMR1_OC2PE).of(modes) != 0;
}

/// The output is enabled, so the pin is driven.
bool TimerModel::drives(std::size_t channel) const {
  const bool enabled = (word(tim::CCER) >> (4 * channel) & 1U) != 0;
  const bool main_output = kind_ != Kind::kAdvanced || tim::BDTR_MOE.of(word(tim::BDTR)) != 0;
  return enabled && main_output;
}

bool TimerModel::forces(std::size_t channel) const {
  return mode(channel) == kForcedLow || mode(channel) == kForcedHigh;
}

bool TimerModel::forced_high(std::size_t channel) const {
  return drives(channel) && mode(channel) == kForcedHigh;
}

Ticks TimerModel::pulse(std::size_t channel) const {
  if (!counts() || !drives(channel) || mode(channel) != kPwm1) return 0;
  return std::min(tick() * active_compare_[channel], period());
}

std::uint32_t TimerModel::read(std::uint32_t offset, unsigned /*size*/) {
  return offset == tim::CNT ? count() : word(offset);
}

void TimerModel::write_control(std::uint32_t value) {
  const Field allowed[] = {tim::CR1_CEN, tim::CR1_UDIS, tim::CR1_URS, tim::CR1_OPM, tim::CR1_ARPE};
  std::uint32_t known = 0;
  for (const Field& field : allowed) known |= field.mask();
  if ((value & ~known) != 0) complain("CR1: counting mode is not modelled");
  const bool ran = counts();
  const std::uint32_t at = count();
  word(tim::CR1) = value;
  if (counts() && !ran) {
    zero_ = core().now() - Ticks{at} * tick();
    if (on_start) on_start();
  }
  if (!counts() && ran) stopped_at_ = at;
}

void TimerModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  switch (offset) {
    case tim::CR1:
      write_control(value);
      break;
    case tim::SR:
      word(offset) &= value;  // written 0 clears
      break;
    case tim::EGR:
      if (tim::EGR_UG.of(value) != 0) update(true);
      break;
    case tim::CNT:
      stopped_at_ = value;
      zero_ = core().now() - Ticks{value} * tick();
      break;
    case tim::SMCR:
    case tim::CR2:
      if (value != 0) complain("slave and master modes are not modelled");
      break;
    case tim::DIER:
      if ((value & ~(tim::DIER_UIE.mask() | tim::DIER_CC1IE.mask() | tim::DIER_UDE.mask())) != 0)
        complain("DIER: not modelled");
      word(offset) = value;
      break;
    default:
      word(offset) = value;
  }
  if (offset == tim::ARR && tim::CR1_ARPE.of(word(tim::CR1)) == 0) {
    const std::uint32_t at = count();
    active_reload_ = value;
    zero_ = core().now() - Ticks{at} * tick();
  }
  if (offset >= tim::CCR1 && offset <= tim::CCR4) {
    const std::size_t channel = (offset - tim::CCR1) / 4;
    written_[channel] = core().now();
    if (!preloads(channel) || !counts()) active_compare_[channel] = value;
  }
  schedule();
  drive_line();
  if (on_change) on_change();
}

/// An update event: the values that wait take effect.
void TimerModel::update(bool by_software) {
  active_prescaler_ = word(tim::PSC);
  active_reload_ = word(tim::ARR);
  for (std::size_t k = 0; k < kChannels; ++k) {
    active_compare_[k] = word(tim::CCR1 + 4 * static_cast<std::uint32_t>(k));
  }
  if (by_software) {
    stopped_at_ = 0;
    zero_ = core().now();
  }
  if (!by_software || tim::CR1_URS.of(word(tim::CR1)) == 0) word(tim::SR) |= tim::SR_UIF.mask();
}

/// An event at the next wrap, if it changes anything.
void TimerModel::schedule() {
  bool waits = tim::DIER_UIE.of(word(tim::DIER)) != 0 || active_prescaler_ != word(tim::PSC) ||
               active_reload_ != word(tim::ARR);
  for (std::size_t k = 0; k < kChannels && !waits; ++k) {
    waits = active_compare_[k] != word(tim::CCR1 + 4 * static_cast<std::uint32_t>(k));
  }
  if (makes_dshot()) {
    waits = waits || (dma_ != nullptr && dma_->served(update_request_));
    for (const auto& train : train_) waits = waits || !train.empty();
    for (const std::uint32_t compare : active_compare_) waits = waits || compare != 0;
  }
  if (!counts() || !waits) return core().set_due(*this, kNever);
  const Ticks since = core().now() - zero_;
  core().set_due(*this, zero_ + (since / period() + 1) * period());
}

void TimerModel::event(Ticks now) {
  const Ticks whole = (now - zero_) / period() * period();
  zero_ += whole;
  if (makes_dshot()) note_bit();
  update(false);
  if (makes_dshot()) burst();
  if (tim::CR1_OPM.of(word(tim::CR1)) != 0) {
    word(tim::CR1) &= ~tim::CR1_CEN.mask();
    stopped_at_ = 0;
  }
  schedule();
  drive_line();
}

/// The compare values of the period after the one that begins now.
void TimerModel::burst() {
  const std::uint32_t control = word(tim::DCR);
  const std::uint32_t first = tim::DCR_DBA.of(control), count = tim::DCR_DBL.of(control) + 1;
  if (dma_ == nullptr || !dma_->served(update_request_)) return;
  for (std::uint32_t k = 0; k < count; ++k) {
    std::uint32_t value = 0;
    if (!dma_->move(update_request_, value)) return complain("its burst ends within a period");
    write(4 * (first + k), value, 4);
  }
}

/// The period that has ended is one bit on each channel, or low.
void TimerModel::note_bit() {
  for (std::size_t k = 0; k < kChannels; ++k) {
    if (forces(k)) continue;
    if (active_compare_[k] != 0) {
      train_[k].push_back(active_compare_[k]);
    } else if (!train_[k].empty()) {
      take_frame(k);
      train_[k].clear();
    }
  }
}

/// High for 3/4 of a period is a 1, for 3/8 a 0; four bits of checksum at the end.
void TimerModel::take_frame(std::size_t channel) {
  if (train_[channel].size() != kDshotBits) {
    return complain("DShot: a train of " + std::to_string(train_[channel].size()) + " bits");
  }
  std::uint32_t frame = 0;
  for (const std::uint32_t high : train_[channel]) {
    const bool one = 16 * high > 9 * (active_reload_ + 1);
    frame = frame << 1U | std::uint32_t{one};
  }
  const std::uint32_t x = frame >> 4U;
  if (((x ^ x >> 4U ^ x >> 8U) & 0xFU) != (frame & 0xFU)) return complain("DShot: wrong checksum");
  throttle_[channel] = x >> 1U;
  std::copy(train_[channel].begin(), train_[channel].end(), high_[channel].begin());
  ++frames_[channel];
}

void TimerModel::drive_line() {
  core().set_line(irq_,
                  tim::DIER_UIE.of(word(tim::DIER)) != 0 && tim::SR_UIF.of(word(tim::SR)) != 0);
}

}  // namespace rosflight::boards::stm32h7::emulator
