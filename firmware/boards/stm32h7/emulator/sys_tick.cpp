// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/sys_tick.hpp"

#include <utility>

namespace rosflight::boards::stm32h7::emulator {

void SysTick::reset() {
  control_ = reload_ = stopped_at_ = 0;
  wrapped_ = false;
  core_.set_due(*this, kNever);
}

void SysTick::set_cycle(Ticks cycle) {
  const std::uint32_t at = value();
  cycle_ = cycle;
  start_at(at);
}

/// What the register of the current value shows.
std::uint32_t SysTick::value() const {
  if (!counts()) return stopped_at_;
  const Ticks now = core_.now();
  return now >= zero_ ? 0 : static_cast<std::uint32_t>((zero_ - now + cycle_ - 1) / cycle_);
}

void SysTick::start_at(std::uint32_t value) {
  stopped_at_ = value;
  zero_ = core_.now() + cycle_ * value;
  // At 0 the reload value comes with the next cycle, and no request with it.
  if (value == 0) zero_ += period();
  schedule();
}

void SysTick::schedule() {
  core_.set_due(*this, counts() ? zero_ : kNever);
}

std::uint32_t SysTick::read(std::uint32_t offset) {
  switch (offset) {
    case kControl:
      return control_ | (std::exchange(wrapped_, false) ? kWrapped : 0U);
    case kReload:
      return reload_;
    case kValue:
      return value();
    default:
      return 0;  // CALIB: no reference clock
  }
}

void SysTick::write(std::uint32_t offset, std::uint32_t value) {
  constexpr std::uint32_t kBits = 0xFF'FFFFU;
  const std::uint32_t at = this->value();
  switch (offset) {
    case kControl:
      if ((value & kEnable) != 0 && (value & kOfProcessor) == 0)
        core_.complain("SysTick: the clock from outside of the processor is not modelled");
      control_ = value & (kEnable | kInterrupt | kOfProcessor);
      return start_at(at);
    case kReload:
      reload_ = value & kBits;
      return start_at(at);
    case kValue:  // any value clears it
      wrapped_ = false;
      return start_at(0);
    default:
      return;
  }
}

/// It has counted from 1 to 0.
void SysTick::event(Ticks now) {
  wrapped_ = true;
  if ((control_ & kInterrupt) != 0) nvic_.pend(kSysTick);
  zero_ = now + period();
  schedule();
}

}  // namespace rosflight::boards::stm32h7::emulator
