// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/qemu_m7/uart.hpp"

#include <algorithm>

namespace rosflight::boards::m7 {
namespace {

constexpr std::uint32_t kTransmitFull = 1u;
constexpr std::uint32_t kReceiveFull = 2u;
constexpr std::uint32_t kTransmitInterrupt = 1u;
constexpr std::uint32_t kReceiveInterrupt = 2u;
constexpr std::uint32_t kEnableAll = 0xFu;  // transmitter, receiver, and their interrupts
constexpr std::uint32_t kMinDivider = 16;

}  // namespace

bool Uart::open(std::uint32_t baud, std::uint8_t device) {
  const std::uint32_t wanted = baud == 0 ? 0 : kClock_Hz / baud;
  const bool possible = wanted >= kMinDivider && device == 0;
  constexpr std::uint32_t kUsualBaud = 921'600;
  divider() = possible ? wanted : kClock_Hz / kUsualBaud;
  interrupts() = 0xFu;
  control() = kEnableAll;
  enable_interrupt(peripheral_.receive_irq);
  enable_interrupt(peripheral_.transmit_irq);
  return possible;
}

bool Uart::write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  {
    const InterruptGuard guard;
    if (!queues_.put(data, size, qos)) return false;
  }
  pend_interrupt(peripheral_.transmit_irq);
  return true;
}

bool Uart::idle() const {
  const InterruptGuard guard;
  return queues_.empty();
}

std::size_t Uart::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, received_.size());
  for (std::size_t k = 0; k < count; ++k) data[k] = received_.take();
  return count;
}

void Uart::on_receive() {
  // Acknowledged first, and for as long as there are bytes: one that comes in between the two
  // accesses would otherwise lose its interrupt, and no other would ever follow.
  while ((state() & kReceiveFull) != 0) {
    interrupts() = kReceiveInterrupt;
    const auto byte = static_cast<std::uint8_t>(data_register());
    ++counters_.received;
    if (received_.room() == 0) {
      ++counters_.overruns;
    } else {
      received_.put(&byte, 1);
    }
  }
  interrupts() = kReceiveInterrupt;
  if ((state() & kReceiveFull) != 0) pend_interrupt(peripheral_.receive_irq);
}

void Uart::on_transmit() {
  interrupts() = kTransmitInterrupt;
  std::uint8_t byte = 0;
  while ((state() & kTransmitFull) == 0 && queues_.take(&byte, 1) == 1) {
    data_register() = byte;
    ++counters_.sent;
  }
}

}  // namespace rosflight::boards::m7
