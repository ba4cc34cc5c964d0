// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/timers.hpp"

#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kMicrosecond = kTimerClock_Hz / 1'000'000u - 1u;  // prescaler

/// Prescaler and period take effect at an update, which EGR.UG makes.
void set_up(const Instance& timer, std::uint32_t prescaler, std::uint32_t period) {
  open_gate(timer);
  reg(timer, tim::CR1) = tim::CR1_URS(1);  // UG raises no flag
  reg(timer, tim::PSC) = prescaler;
  reg(timer, tim::ARR) = period;
  reg(timer, tim::EGR) = tim::EGR_UG(1);
  reg(timer, tim::SR) = 0;
}

}  // namespace

void stop_with_debugger() {
  reg(DBGMCU, dbgmcu::APB1LFZ1) = dbgmcu::APB1LFZ1_DBG_TIM2(1) | dbgmcu::APB1LFZ1_DBG_TIM3(1) |
                                  dbgmcu::APB1LFZ1_DBG_TIM4(1) | dbgmcu::APB1LFZ1_DBG_TIM5(1) |
                                  dbgmcu::APB1LFZ1_DBG_TIM6(1) | dbgmcu::APB1LFZ1_DBG_TIM7(1) |
                                  dbgmcu::APB1LFZ1_DBG_TIM12(1);
  reg(DBGMCU, dbgmcu::APB2FZ1) = dbgmcu::APB2FZ1_DBG_TIM1(1) | dbgmcu::APB2FZ1_DBG_TIM8(1);
  reg(DBGMCU, dbgmcu::APB4FZ1) = dbgmcu::APB4FZ1_DBG_IWDG1(1);
}

void start_microseconds() {
  set_up(TIM5, kMicrosecond, 0xFFFF'FFFFu);
  reg(TIM5, tim::CR1) = tim::CR1_URS(1) | tim::CR1_CEN(1);
}

void start_tick(std::uint32_t period_us) {
  set_up(TIM7, kMicrosecond, period_us - 1);
  reg(TIM7, tim::DIER) = tim::DIER_UIE(1);
  enable_interrupt(irq::TIM7, Priority::kBus);
  reg(TIM7, tim::CR1) = tim::CR1_URS(1) | tim::CR1_CEN(1);
}

void clear_tick() {
  reg(TIM7, tim::SR) = 0;
  const std::uint32_t back = reg(TIM7, tim::SR);
  static_cast<void>(back);  // the write has arrived: the interrupt does not come again
}

void start_square_wave(const Instance& timer, std::uint32_t period_us, std::uint32_t high_us) {
  constexpr std::uint32_t kPwm1 = 6;
  open_gate(timer);
  reg(timer, tim::CCMR1) = tim::CCMR1_OC1M(kPwm1);
  reg(timer, tim::CCR1) = high_us;
  reg(timer, tim::CCER) = tim::CCER_CC1E(1);
  set_up(timer, kMicrosecond, period_us - 1);
  reg(timer, tim::CR1) = tim::CR1_URS(1) | tim::CR1_CEN(1);
}

void Watchdog::start(std::uint32_t warning_us, std::uint32_t reset_ms) {
  constexpr std::uint32_t kUnlock = 0x5555, kStart = 0xCCCC;
  constexpr std::uint32_t kDivideBy32 = 3;  // 1 ms at 32 kHz
  set_up(TIM6, kMicrosecond, warning_us - 1);
  reg(TIM6, tim::DIER) = tim::DIER_UIE(1);
  enable_interrupt(irq::TIM6_DAC, Priority::kWarning);
  reg(TIM6, tim::CR1) = tim::CR1_URS(1) | tim::CR1_CEN(1);
  reg(IWDG1, iwdg::KR) = kStart;
  reg(IWDG1, iwdg::KR) = kUnlock;
  reg(IWDG1, iwdg::PR) = kDivideBy32;
  reg(IWDG1, iwdg::RLR) = reset_ms;
  feed();
}

void Watchdog::feed() {
  constexpr std::uint32_t kFeed = 0xAAAA;
  reg(TIM6, tim::EGR) = tim::EGR_UG(1);  // counts from 0 again
  reg(IWDG1, iwdg::KR) = kFeed;
}

}  // namespace rosflight::boards::stm32h7
