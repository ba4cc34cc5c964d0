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
constexpr std::uint32_t kSmallestDivider = 16;

}  // namespace

bool Uart::open(std::uint32_t baud, std::uint8_t device) {
  const std::uint32_t wanted = baud == 0 ? 0 : kClock_Hz / baud;
  const bool possible = wanted >= kSmallestDivider && device == 0;
  constexpr std::uint32_t kUsualBaud = 921'600;
  divider() = possible ? wanted : kClock_Hz / kUsualBaud;
  interrupts() = 0xFu;
  control() = kEnableAll;
  enable_interrupt(place_.receive_irq);
  enable_interrupt(place_.transmit_irq);
  return possible;
}

bool Uart::write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  Queue& q = queue(qos);
  if (size == 0 || size + kFrameHeader > q.room()) {
    ++counters_.frames_dropped;
    return false;
  }
  const std::uint8_t header[kFrameHeader] = {static_cast<std::uint8_t>(size & 0xFFu),
                                             static_cast<std::uint8_t>(size >> 8u)};
  {
    const InterruptGuard guard;  // header and frame together
    q.put(header, kFrameHeader);
    q.put(data, size);
  }
  pend_interrupt(place_.transmit_irq);
  return true;
}

std::size_t Uart::writable() const {
  const std::size_t room = queues_.back().room();
  return room > kFrameHeader ? room - kFrameHeader : 0;
}

bool Uart::idle() const {
  const InterruptGuard guard;
  return remaining_ == 0 &&
         std::all_of(queues_.begin(), queues_.end(), [](const Queue& q) { return q.empty(); });
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
  if ((state() & kReceiveFull) != 0) pend_interrupt(place_.receive_irq);
}

void Uart::on_transmit() {
  interrupts() = kTransmitInterrupt;
  std::uint8_t byte = 0;
  while ((state() & kTransmitFull) == 0 && next_byte(byte)) {
    data_register() = byte;
    ++counters_.sent;
  }
}

bool Uart::next_byte(std::uint8_t& byte) {
  if (remaining_ == 0) {
    const auto* const next =
        std::find_if(queues_.begin(), queues_.end(), [](const Queue& q) { return !q.empty(); });
    if (next == queues_.end()) return false;
    sending_ = static_cast<std::size_t>(next - queues_.begin());
    remaining_ = static_cast<std::size_t>(next->peek(0)) | static_cast<std::size_t>(next->peek(1))
                                                               << 8u;
    queues_[sending_].drop(kFrameHeader);
  }
  byte = queues_[sending_].take();
  --remaining_;
  return true;
}

}  // namespace rosflight::boards::m7
