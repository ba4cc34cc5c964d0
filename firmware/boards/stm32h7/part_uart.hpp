// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/uart.hpp"

namespace rosflight::boards::stm32h7 {

/// A UART with a part at its far end that is spoken to: GNSS receivers. One message is on the wire at a
/// time; send() refuses another until it has left.
class PartUart final : public parts::UartPort {
 public:
  /// All must outlive this.
  PartUart(const Uart::Pins& pins, const Uart::Memory& memory, const hal::Clock& clock)
      : uart_{pins, memory}, clock_{clock} {}

  /// Gives received bytes to this; call it before the first set_format().
  void connect(parts::ByteReceiver& receiver) { receiver_ = &receiver; }

  bool send(const std::uint8_t* data, std::size_t size) override;
  bool set_format(const parts::UartFormat& format) override;
  bool idle() const override { return !uart_.sending() && uart_.line_is_quiet(); }

  void on_interrupt();
  void on_sent();
  /// Once per tick: hands on what has come while the line is never idle.
  void step();

 private:
  void hand_on(hal::Time last);

  Uart uart_;
  const hal::Clock& clock_;
  parts::ByteReceiver* receiver_{nullptr};
  hal::Time character_{};
};

}  // namespace rosflight::boards::stm32h7
