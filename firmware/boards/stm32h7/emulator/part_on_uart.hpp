// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/emulator/part_on_spi.hpp"
#include "firmware/boards/stm32h7/emulator/uart_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A part at the far end of a UART.
class PartOnUart final : public Timed {
 public:
  /// All must outlive this.
  PartOnUart(Core& core, UartModel& uart, parts::models::UartPart& part)
      : core_{core}, uart_{uart}, part_{part} {
    uart_.on_byte = [this](std::uint8_t byte, std::uint32_t baud) {
      part_.advance(part_time(core_.now()));
      part_.receive(byte, nominal(baud));
      advance();
    };
  }

  /// Injects a fault: what it sends does not arrive.
  void set_mute(bool mute) { mute_ = mute; }
  /// Injects a fault: one bit of the next byte is inverted.
  void flip_bit() { flips_ = true; }

  void event(Ticks /*now*/) override { advance(); }
  void advance() {
    part_.advance(part_time(core_.now()));
    std::uint8_t byte = 0;
    parts::UartFormat format;
    hal::Time end{};
    while (part_.take(byte, format.baud, end)) {
      constexpr std::uint8_t kFlippedBit = 0x40;
      if (std::exchange(flips_, false)) byte = static_cast<std::uint8_t>(byte ^ kFlippedBit);
      if (!mute_) uart_.deliver(byte, format);
    }
    const hal::Time next = part_.next_event();
    if (next == parts::models::kNever) return core_.set_due(*this, kNever);
    core_.set_due(*this, static_cast<Ticks>(next.count()) * kTicksPerMicrosecond);
  }

 private:
  /// The usual rate that the chip's divider comes within 2 % of, since a part compares exactly.
  static std::uint32_t nominal(std::uint32_t baud) {
    for (const std::uint32_t usual :
         {9'600U, 38'400U, 57'600U, 115'200U, 230'400U, 460'800U, 921'600U}) {
      if (baud * 50ULL >= usual * 49ULL && baud * 50ULL <= usual * 51ULL) return usual;
    }
    return baud;
  }

  Core& core_;
  UartModel& uart_;
  parts::models::UartPart& part_;
  bool mute_{false};
  bool flips_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
