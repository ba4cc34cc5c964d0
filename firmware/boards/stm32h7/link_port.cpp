// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/link_port.hpp"

#include "firmware/boards/stm32h7/cpu.hpp"

namespace rosflight::boards::stm32h7 {

bool LinkPort::open(std::uint32_t baud, std::uint8_t device) {
  constexpr std::uint32_t kUsualBaud = 921'600;
  const std::uint32_t masked = mask_bus();
  parts::UartFormat format;
  format.baud = baud;
  const bool possible = device == 0 && uart_.open(format);
  if (!possible) {
    format.baud = kUsualBaud;
    static_cast<void>(uart_.open(format));
  }
  usb_.open(pins_.usb_minus, pins_.usb_plus);
  unmask_bus(masked);
  return possible;
}

bool LinkPort::write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  const std::uint32_t masked = mask_bus();
  const bool taken = queues_.put(data, size, qos);
  if (taken) send_next();
  unmask_bus(masked);
  return taken;
}

std::size_t LinkPort::read(std::uint8_t* data, std::size_t capacity) {
  return usb_.connected() ? usb_.read(data, capacity) : uart_.read(data, capacity);
}

/// As many frames as one transfer holds: a transfer of one frame each would leave the bus idle.
void LinkPort::send_next() {
  if (!usb_.connected()) {
    if (uart_.sending()) return;
    const std::size_t count = queues_.take(uart_.out(), uart_.out_size());
    if (count > 0) uart_.send(count);
    return;
  }
  if (usb_.sending()) return;
  std::size_t count = 0;
  while (count < transfer_.size()) {
    const std::size_t more = queues_.take(transfer_.data() + count, transfer_.size() - count);
    if (more == 0) break;
    count += more;
  }
  if (count > 0) usb_.send(transfer_.data(), count);
}

void LinkPort::on_uart_sent() {
  uart_.on_sent();
  send_next();
}

void LinkPort::on_usb() {
  usb_.on_interrupt();
  send_next();
}

void LinkPort::step() {
  usb_.step();
  send_next();
}

}  // namespace rosflight::boards::stm32h7
