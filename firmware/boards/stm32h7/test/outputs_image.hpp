// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstring>

#include "firmware/boards/common/firmware_glance.hpp"
#include "firmware/boards/stm32h7/board_start.hpp"
#include "firmware/boards/stm32h7/startup.hpp"
#include "firmware/boards/stm32h7/test/output_order.hpp"

namespace rosflight::boards::stm32h7 {

/// Stands in the place of image_main.hpp: instead of running the firmware, the board sets its outputs as it is
/// ordered over the link.
template <class Board>
class Image {
 public:
  Board& board() { return *board_.get(); }
  void record_fault(const FaultRegisters& /*registers*/) {}

  [[noreturn]] void run(const Oscillator& oscillator, typename Board::Memory& memory,
                        FirmwareGlance& /*shown*/) {
    start_board(board_, oscillator, memory);
    const hal::Board roles = board().roles();
    constexpr std::uint32_t kBaud = 921'600;
    static_cast<void>(roles.serial.open(kBaud, 0));
    asm volatile("cpsie i" ::: "memory");
    for (;;) {
      count_ += roles.serial.read(bytes_.data() + count_, bytes_.size() - count_);
      if (count_ == bytes_.size()) serve(roles);
      board().idle();
    }
  }

 private:
  void serve(const hal::Board& roles) {
    OutputOrder order;
    std::memcpy(&order, bytes_.data(), sizeof order);
    count_ = 0;
    const bool given = roles.outputs.configure(order.rates_hz);
    roles.outputs.write(order.values);
    const auto answer =
        static_cast<std::uint8_t>(given ? OutputOrder::kGiven : OutputOrder::kRefused);
    static_cast<void>(roles.serial.write(&answer, 1, hal::Serial::kOrdinary));
  }

  ObjectStorage<Board> board_;
  std::array<std::uint8_t, sizeof(OutputOrder)> bytes_{};
  std::size_t count_{0};
};

}  // namespace rosflight::boards::stm32h7
