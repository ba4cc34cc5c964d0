// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/uart.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kMinDivider = 16, kMaxDivider = 0xFFFF;
constexpr std::uint32_t kTolerancePercent = 2;
constexpr std::uint32_t kTwoStopBits = 2;

/// Nearest divider of the bus clock, or 0 if the rate is off by more than the tolerance.
std::uint32_t divider_for(std::uint32_t baud) {
  if (baud == 0) return 0;
  const std::uint32_t divider = (kBusClock_Hz + baud / 2) / baud;
  if (divider < kMinDivider || divider > kMaxDivider) return 0;
  const std::uint32_t got = kBusClock_Hz / divider;
  const std::uint32_t off = got > baud ? got - baud : baud - got;
  return off * 100u <= baud * kTolerancePercent ? divider : 0;
}

}  // namespace

hal::Time character_time(const parts::UartFormat& format) {
  const unsigned bits = 9u + (format.even_parity ? 1u : 0u) + format.stop_bits;
  return hal::Time{static_cast<std::int64_t>(bits * 1'000'000u / format.baud)};
}

bool Uart::open(const parts::UartFormat& format) {
  const std::uint32_t divider = divider_for(format.baud);
  if (divider == 0) return false;
  const Instance& uart = pins_.uart;
  open_gate(uart);
  modify(reg(uart, usart::CR1), usart::CR1_UE, 0);  // rates and format only while disabled
  reg(uart, usart::CR1) = 0;
  receive_.connect(
      {pins_.receive_request, DmaStream::Direction::kToMemory, true, false, false, true});
  if (sends()) {
    transmit_.connect(
        {pins_.receive_request + 1, DmaStream::Direction::kToRegister, false, true, false, true});
    make_alternate(pins_.transmit, pins_.function);
    enable_interrupt(transmit_.irq(), Priority::kBus);
  }
  make_alternate(pins_.receive, pins_.function, Pull::kUp);
  taken_ = 0;
  sending_ = false;
  reg(uart, usart::BRR) = divider;
  reg(uart, usart::CR2) = usart::CR2_STOP(format.stop_bits == 2 ? kTwoStopBits : 0) |
                          usart::CR2_RXINV(format.inverted) | usart::CR2_TXINV(format.inverted);
  reg(uart, usart::CR3) = usart::CR3_DMAR(1) | usart::CR3_DMAT(sends()) | usart::CR3_EIE(1);
  receive_.start(uart.base + usart::RDR, memory_.ring, memory_.ring_size);
  // Eight data bits and parity are nine bits on the wire.
  reg(uart, usart::CR1) = usart::CR1_UE(1) | usart::CR1_RE(1) | usart::CR1_TE(sends()) |
                          usart::CR1_IDLEIE(1) | usart::CR1_PCE(format.even_parity) |
                          usart::CR1_M0(format.even_parity);
  enable_interrupt(pins_.irq, Priority::kBus);
  return true;
}

std::size_t Uart::waiting() const {
  return (written() + memory_.ring_size - taken_) % memory_.ring_size;
}

std::size_t Uart::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, waiting());
  const volatile std::uint8_t* const ring = memory_.ring;
  for (std::size_t k = 0; k < count; ++k) {
    data[k] = ring[taken_];
    taken_ = taken_ + 1 == memory_.ring_size ? 0 : taken_ + 1;
  }
  return count;
}

void Uart::send(std::size_t count) {
  sending_ = true;
  transmit_.start(pins_.uart.base + usart::TDR, memory_.out, count);
}

Uart::Event Uart::on_interrupt() {
  constexpr std::uint32_t kErrors = usart::ICR_PECF.mask() | usart::ICR_FECF.mask() |
                                    usart::ICR_NECF.mask() | usart::ICR_ORECF.mask();
  const std::uint32_t status = reg(pins_.uart, usart::ISR);
  reg(pins_.uart, usart::ICR) = kErrors | usart::ICR_IDLECF.mask();
  const std::uint32_t back = reg(pins_.uart, usart::ISR);
  static_cast<void>(back);  // the write has arrived: the interrupt does not come again
  return {usart::ISR_IDLE.of(status) != 0, (status & kErrors) != 0};
}

void Uart::on_sent() {
  static_cast<void>(transmit_.clear_flags());
  sending_ = false;
}

// ---- listener

bool UartListener::open(const parts::UartFormat& format, parts::ByteReceiver& receiver) {
  const std::uint32_t masked = mask_bus();
  character_ = character_time(format);
  receiver_ = &receiver;
  const bool possible = uart_.open(format);
  unmask_bus(masked);
  return possible;
}

void UartListener::on_interrupt() {
  const Uart::Event event = uart_.on_interrupt();
  const hal::Time now = clock_.now();
  if (event.error) receiver_->line_error(now);
  std::array<std::uint8_t, 32> bytes{};
  while (const std::size_t count = uart_.read(bytes.data(), bytes.size())) {
    receiver_->receive(bytes.data(), count, event.idle ? now - character_ : now);
  }
}

}  // namespace rosflight::boards::stm32h7
