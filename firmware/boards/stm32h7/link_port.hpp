// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/frame_queues.hpp"
#include "firmware/boards/stm32h7/uart.hpp"
#include "firmware/boards/stm32h7/usb_port.hpp"

namespace rosflight::boards::stm32h7 {

/// The serial role: whole frames by urgency, over USB while a program on the host has the port open, and
/// over the UART otherwise. The image forwards the interrupts of both.
class LinkPort final : public hal::Serial {
 public:
  struct Pins {
    Uart::Pins uart;
    Pin usb_minus, usb_plus;
  };
  LinkPort(const Pins& pins, const Uart::Memory& memory) : pins_{pins}, uart_{pins.uart, memory} {}

  /// Opens both. @param baud  of the UART.
  bool open(std::uint32_t baud, std::uint8_t device) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;
  std::size_t writable() const override { return queues_.writable(); }
  bool carries_all() const override { return usb_.connected(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;
  /// More than what may have come since the last read(): a pass of the firmware takes a limited number of messages.
  bool has_left_over() const {
    constexpr std::size_t kSinceThen = 64;  // 0.2 ms at 3 Mbaud
    return usb_.connected() ? usb_.waiting() : uart_.waiting() > kSinceThen;
  }

  void on_uart() { static_cast<void>(uart_.on_interrupt()); }
  void on_uart_sent();
  void on_usb();
  /// Bus context, once per tick.
  void step();

 private:
  void send_next();

  Pins pins_;
  Uart uart_;
  UsbPort usb_;
  FrameQueues<4096> queues_;
  std::array<std::uint8_t, UsbPort::kMaxTransfer> transfer_{};
};

}  // namespace rosflight::boards::stm32h7
