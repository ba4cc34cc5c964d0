// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

namespace rosflight::boards::stm32h7 {

/// Backup memory: 4 KiB that survive a reset, and the power with a battery. RM0433 ch. 6.
inline constexpr std::uint32_t kBackupMemory = 0x3880'0000u;
inline constexpr std::uint32_t kBackupMemorySize = 4096;

/// Opens its clock gate and its write protection. It must also lie in an uncached region of the MPU:
/// a cache line is lost with the reset.
void open_backup_memory();

/// Asks start-up to enter ST's bootloader in ROM after the next reset: a word at the end of the backup memory, which is open.
void request_bootloader();
/// Before the clocks, because the bootloader expects them as after a reset: enters it if it was requested, once, and then does not
/// return. The backup memory is open. AN2606.
void enter_requested_bootloader();

/// What ended the last run; from RCC_RSR.
enum class ResetCause : std::uint8_t { kPowerOn, kPin, kSoftware, kWatchdog, kOther };
/// Reads and clears the flags, so call it once.
ResetCause take_reset_cause();

}  // namespace rosflight::boards::stm32h7
