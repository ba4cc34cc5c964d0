// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/debug_unit.hpp"

#include <algorithm>
#include <iterator>

namespace rosflight::boards::stm32h7::emulator {
namespace {

struct Stop {
  const Instance& instance;
  std::uint32_t offset;
  const Field& bit;
};

const Stop kStops[] = {
    {TIM1, dbgmcu::APB2FZ1, dbgmcu::APB2FZ1_DBG_TIM1},
    {TIM2, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM2},
    {TIM3, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM3},
    {TIM4, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM4},
    {TIM5, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM5},
    {TIM6, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM6},
    {TIM7, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM7},
    {TIM8, dbgmcu::APB2FZ1, dbgmcu::APB2FZ1_DBG_TIM8},
    {TIM12, dbgmcu::APB1LFZ1, dbgmcu::APB1LFZ1_DBG_TIM12},
    {IWDG1, dbgmcu::APB4FZ1, dbgmcu::APB4FZ1_DBG_IWDG1},
};

}  // namespace

bool DebugUnit::stops(const Instance& instance) const {
  const auto* const found = std::find_if(std::begin(kStops), std::end(kStops),
                                         [&](const Stop& s) { return s.instance == instance; });
  return found != std::end(kStops) && found->bit.of(word(found->offset)) != 0;
}

void DebugUnit::reset() {
  constexpr std::uint32_t kDevice = 0x450;  // STM32H742, 743, 750 and 753
  Peripheral::reset();
  word(dbgmcu::IDC) =
      dbgmcu::IDC_DEV_ID(kDevice) | dbgmcu::IDC_REV_ID(static_cast<std::uint32_t>(revision_));
}

void DebugUnit::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (offset == dbgmcu::IDC) return complain("IDC can only be read");
  word(offset) = value;
}

}  // namespace rosflight::boards::stm32h7::emulator
