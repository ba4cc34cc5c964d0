// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/backup_domain.hpp"

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {

void open_backup_memory() {
  modify(reg(PWR, pwr::CR1), pwr::CR1_DBP, 1);
  modify(reg(RCC, rcc::AHB4ENR), rcc::AHB4ENR_BKPRAMEN, 1);
  const std::uint32_t back = reg(RCC, rcc::AHB4ENR);
  static_cast<void>(back);
}

ResetCause take_reset_cause() {
  const std::uint32_t flags = reg(RCC, rcc::RSR);
  reg(RCC, rcc::RSR) = rcc::RSR_RMVF(1);
  // Each reset also pulls the reset pin, and power-on is a brown-out: from the rarest to the commonest.
  if (rcc::RSR_PORRSTF.of(flags) != 0) return ResetCause::kPowerOn;
  if (rcc::RSR_IWDG1RSTF.of(flags) != 0) return ResetCause::kWatchdog;
  if (rcc::RSR_SFTRSTF.of(flags) != 0) return ResetCause::kSoftware;
  return rcc::RSR_PINRSTF.of(flags) != 0 ? ResetCause::kPin : ResetCause::kOther;
}

}  // namespace rosflight::boards::stm32h7
