// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <type_traits>

#include "firmware/boards/common/flight_record_main.hpp"
#include "firmware/boards/common/glance_main.hpp"
#include "firmware/boards/common/temperature_main.hpp"
#include "firmware/boards/stm32h7/board_start.hpp"
#include "firmware/boards/stm32h7/startup.hpp"
// What it speaks.
#include ROSFLIGHT_IMAGE_LINK

extern "C" {
// NOLINTNEXTLINE(bugprone-dynamic-static-initializers): of the linker
extern std::uint8_t board_record_begin[], board_record_end[];
}

namespace rosflight::boards::stm32h7 {

/// Board, link and firmware put together. One in an image, static, because interrupt handlers must find
/// it; all zero at start.
template <class Board>
class Image {
 public:
  Board& board() { return *board_.get(); }

  /// Called by board_fault().
  void record_fault(const FaultRegisters& registers) {
    if (Autopilot* const autopilot = autopilot_.get()) autopilot->firmware.record_fault(registers);
  }

  /// From the end of start-up on: clocks, memory system, board, firmware, main loop.
  [[noreturn]] void run(const Oscillator& oscillator, typename Board::Memory& memory,
                        FirmwareGlance& shown) {
    const bool cold = start_board(board_, oscillator, memory);
    Board& here = board();
    const hal::Board roles = here.roles();
    parts::FlightRecord record{board_record_begin,
                               static_cast<std::size_t>(board_record_end - board_record_begin)};
    FlightRecorder recorder{record, record.attach(cold, roles.clock.now()), roles.clock.now()};
    Autopilot& autopilot = autopilot_.make(roles, record);
    core::Firmware& firmware = autopilot.firmware;
    firmware.start();
    here.start_watchdog();
    parts::TemperatureWatch temperature;
    for (;;) {
      firmware.run();
      glance(firmware, shown);
      const bool armed = firmware.state().armed();
      const hal::Time now = roles.clock.now();
      recorder.step(firmware, now);
      const float temperature_K = here.temperature_K();
      report_temperature(temperature.step(temperature_K, armed, now), temperature_K, firmware,
                         record, now);
      if constexpr (Board::kHasBuzzer) {
        here.sound(
            {armed, firmware.state().failsafe(), firmware.battery_low(), firmware.faults() > 0},
            now);
      }
      autopilot.codec.serve(roles.serial, armed);
      here.maintain(armed);
      here.idle();
    }
  }

 private:
  struct Autopilot {
    Autopilot(const hal::Board& board, parts::FlightRecord& record)
        : link{make_link<ImageLink>(board.serial)},
          codec{link.codec, record, board.clock},
          firmware{board, codec} {}
    template <class Link>
    static Link make_link([[maybe_unused]] hal::Serial& port) {
      if constexpr (std::is_constructible_v<Link, hal::Serial&>) {
        return Link(port);
      } else {
        return Link{};
      }
    }
    ImageLink link;
    RecordingCodec codec;
    core::Firmware firmware;
  };
  ObjectStorage<Board> board_;
  ObjectStorage<Autopilot> autopilot_;
};

}  // namespace rosflight::boards::stm32h7
