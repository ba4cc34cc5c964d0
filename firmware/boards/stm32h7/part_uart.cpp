// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/part_uart.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/cpu.hpp"

namespace rosflight::boards::stm32h7 {

bool PartUart::send(const std::uint8_t* data, std::size_t size) {
  const std::uint32_t masked = mask_bus();
  const bool taken = !uart_.sending() && size > 0 && size <= uart_.out_size();
  if (taken) {
    std::copy_n(data, size, uart_.out());
    uart_.send(size);
  }
  unmask_bus(masked);
  return taken;
}

bool PartUart::set_format(const parts::UartFormat& format) {
  const std::uint32_t masked = mask_bus();
  const bool possible = uart_.open(format);
  if (possible) character_ = character_time(format);
  unmask_bus(masked);
  return possible;
}

void PartUart::hand_on(hal::Time last) {
  std::array<std::uint8_t, 32> bytes{};
  while (const std::size_t count = uart_.read(bytes.data(), bytes.size())) {
    receiver_->receive(bytes.data(), count, last);
  }
}

void PartUart::on_interrupt() {
  const Uart::Event event = uart_.on_interrupt();
  const hal::Time now = clock_.now();
  if (event.error) receiver_->line_error(now);
  hand_on(event.idle ? now - character_ : now);
}

void PartUart::on_sent() {
  uart_.on_sent();
}

void PartUart::step() {
  constexpr std::size_t kMany = 64;  // of a ring of some hundred bytes
  if (uart_.waiting() >= kMany) hand_on(clock_.now());
}

}  // namespace rosflight::boards::stm32h7
