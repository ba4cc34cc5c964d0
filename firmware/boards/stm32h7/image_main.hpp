// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <type_traits>

#include "firmware/boards/common/glance_main.hpp"
#include "firmware/boards/common/place.hpp"
#include "firmware/boards/stm32h7/backup_domain.hpp"
#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/flight_board.hpp"
#include "firmware/boards/stm32h7/startup.hpp"
// What it speaks.
#include ROSFLIGHT_BOARD_LINK

namespace rosflight::boards::stm32h7 {

/// Board, link and firmware put together. One in an image, static, because interrupt handlers must find
/// it; all zero at start.
template <class Board>
class Image {
 public:
  Board& board() { return *board_.get(); }

  /// Of board_fault().
  void record_fault(const FaultRegisters& registers) {
    if (Autopilot* const autopilot = autopilot_.get()) autopilot->firmware.record_fault(registers);
  }

  /// From the end of start-up on: clocks, memory system, board, firmware, main loop.
  [[noreturn]] void run(const Oscillator& oscillator, typename Board::Memory& memory,
                        FirmwareGlance& shown) {
    constexpr std::uint32_t kSram3Size = 0x8000u;
    start_clocks(oscillator);
    open_gate(kSram3);
    open_backup_memory();
    make_uncached(0, kSram3.base, kSram3Size);
    make_uncached(1, kBackupMemory, kBackupMemorySize);
    Board::map_memory(2);
    start_memory_system();
    start_microseconds();
    open_ports();
    const bool cold = take_reset_cause() == ResetCause::kPowerOn;
    Board& here = board_.make(memory, cold ? parts::Start::kCold : parts::Start::kWarm);
    here.open();
    core::Firmware& firmware = autopilot_.make(here.roles()).firmware;
    firmware.start();
    here.start_watchdog();
    for (;;) {
      firmware.run();
      glance(firmware, shown);
      here.maintain(firmware.state().armed());
      here.idle();
    }
  }

 private:
  struct Autopilot {
    explicit Autopilot(const hal::Board& board)
        : link{make_link<BoardLink>(board.serial)}, firmware{board, link.codec} {}
    template <class Link>
    static Link make_link([[maybe_unused]] hal::Serial& port) {
      if constexpr (std::is_constructible_v<Link, hal::Serial&>) {
        return Link(port);
      } else {
        return Link{};
      }
    }
    BoardLink link;
    core::Firmware firmware;
  };
  Place<Board> board_;
  Place<Autopilot> autopilot_;
};

}  // namespace rosflight::boards::stm32h7
