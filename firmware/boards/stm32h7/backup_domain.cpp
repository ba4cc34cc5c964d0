// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/backup_domain.hpp"

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kBootloader = 0x1FF0'9800u;  // its vector table; AN2606
constexpr std::uint32_t kRequested = 0xB007'10ADu;   // any word that memory does not hold by chance
constexpr std::uint32_t kRequest = kBackupMemory + kBackupMemorySize - 8;

}  // namespace

void open_backup_memory() {
  modify(reg(PWR, pwr::CR1), pwr::CR1_DBP, 1);
  modify(reg(RCC, rcc::AHB4ENR), rcc::AHB4ENR_BKPRAMEN, 1);
  const std::uint32_t back = reg(RCC, rcc::AHB4ENR);
  static_cast<void>(back);
}

/// The second word pushes the first out of the write buffer of the memory's error correction (AN5342).
void request_bootloader() {
  memory_at<volatile std::uint32_t>(kRequest) = kRequested;
  memory_at<volatile std::uint32_t>(kRequest + 4) = 0;
}

void enter_requested_bootloader() {
  auto& request = memory_at<volatile std::uint32_t>(kRequest);
  if (request != kRequested) return;
  request = 0;
  memory_at<volatile std::uint32_t>(kRequest + 4) = 0;
  const std::uint32_t stack = memory_at<const volatile std::uint32_t>(kBootloader);
  const std::uint32_t entry = memory_at<const volatile std::uint32_t>(kBootloader + 4);
  asm volatile("dsb\n msr msp, %0\n isb\n bx %1" ::"r"(stack), "r"(entry) : "memory");
  __builtin_unreachable();
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
