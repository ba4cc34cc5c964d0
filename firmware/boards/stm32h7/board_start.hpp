// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/object_storage.hpp"
#include "firmware/boards/stm32h7/backup_domain.hpp"
#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/flight_board.hpp"

namespace rosflight::boards::stm32h7 {

/// From the end of start-up on: clocks, memory system, and the board with its buses and interrupts.
/// @returns whether the power has come on, after which nothing in memory is valid.
template <class Board>
bool start_board(ObjectStorage<Board>& board, const Oscillator& oscillator,
                 typename Board::Memory& memory) {
  constexpr std::uint32_t kSram3Size = 0x8000u;
  constexpr std::uint32_t kAxiSram = 0x2400'0000u, kAxiSramSize = 0x8'0000u;
  repair_old_silicon();
  open_backup_memory();
  enter_requested_bootloader();
  start_clocks(oscillator);
  open_gate(kSram3);
  make_uncached(0, kSram3.base, kSram3Size);
  make_uncached(1, kBackupMemory, kBackupMemorySize);
  // The flight record: a dirty cache line would be lost with a reset.
  make_uncached(2, kAxiSram, kAxiSramSize);
  Board::map_memory(3);
  start_memory_system();
  stop_with_debugger();
  start_microseconds();
  open_ports();
  const bool cold = take_reset_cause() == ResetCause::kPowerOn;
  board.make(memory, cold ? parts::Start::kCold : parts::Start::kWarm).open();
  return cold;
}

}  // namespace rosflight::boards::stm32h7
