// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/firmware_glance.hpp"
#include "firmware/boards/stm32h7/board_start.hpp"
#include "firmware/boards/stm32h7/startup.hpp"

/// Stands in the place of image_main.hpp: the board runs the contract suites of the HAL instead of the
/// firmware, and writes what GoogleTest prints to its link.
namespace rosflight::boards::stm32h7 {

struct BoardUnderTest {
  hal::Board roles;
  const FlightBoard::Plan& plan;
};
/// These two are defined in contract_test.cpp.
BoardUnderTest& board_under_test();
[[noreturn]] void run_contracts(const BoardUnderTest& board);

template <class Board>
class Image {
 public:
  Board& board() { return *board_.get(); }
  void record_fault(const FaultRegisters& /*registers*/) {}

  [[noreturn]] void run(const Oscillator& oscillator, typename Board::Memory& memory,
                        FirmwareGlance& /*shown*/) {
    start_board(board_, oscillator, memory);
    run_contracts({board().roles(), board().plan()});
  }

 private:
  ObjectStorage<Board> board_;
};

}  // namespace rosflight::boards::stm32h7
