// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/uart_model.hpp"

#include <algorithm>
#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kTwoStopBits = 2;
constexpr std::uint32_t kBaudTolerancePercent = 3;

}  // namespace

UartModel::UartModel(Core& core, std::string name, const Instance& instance,
                     const ClockTree& clocks, const DmaRequests& dma, const UartWiring& wiring)
    : Peripheral{core, std::move(name), "USART", instance},
      clocks_{clocks},
      dma_{dma},
      wiring_{wiring} {}

void UartModel::reset() {
  Peripheral::reset();
  word(usart::ISR) = usart::ISR_TC.mask();
  received_bytes_.clear();
  waiting_.clear();
  shifting_ = false;
  sent_at_ = idle_at_ = kNever;
  schedule();  // what the far end sends goes on
}

// ---- rates

std::uint32_t UartModel::baud() const {
  const std::uint32_t divider = word(usart::BRR);
  return divider == 0 ? 0 : static_cast<std::uint32_t>(clocks_.apb_Hz() / divider);
}

parts::UartFormat UartModel::own_format() const {
  parts::UartFormat format;
  format.baud = baud();
  format.even_parity = usart::CR1_PCE.of(word(usart::CR1)) != 0;
  format.stop_bits = usart::CR2_STOP.of(word(usart::CR2)) == kTwoStopBits ? 2 : 1;
  format.inverted = usart::CR2_RXINV.of(word(usart::CR2)) != 0;
  return format;
}

bool UartModel::agrees(const parts::UartFormat& far) const {
  const parts::UartFormat own = own_format();
  const std::uint64_t off = own.baud > far.baud ? own.baud - far.baud : far.baud - own.baud;
  return off * 100 <= std::uint64_t{kBaudTolerancePercent} * far.baud &&
         own.even_parity == far.even_parity && own.inverted == far.inverted;
}

Ticks UartModel::byte_time(const parts::UartFormat& format) const {
  const unsigned bits = 9U + (format.even_parity ? 1U : 0U) + format.stop_bits;
  return format.baud == 0 ? kNever : bits * kTicksPerSecond / format.baud;
}

// ---- registers

std::uint32_t UartModel::status() const {
  std::uint32_t value = word(usart::ISR);
  if (!received_bytes_.empty()) value |= usart::ISR_RXNE_RXFNE.mask();
  if (waiting_.size() < depth()) value |= usart::ISR_TXE_TXFNF.mask();
  if (enabled() && usart::CR1_TE.of(word(usart::CR1)) != 0) value |= usart::ISR_TEACK.mask();
  if (enabled() && usart::CR1_RE.of(word(usart::CR1)) != 0) value |= usart::ISR_REACK.mask();
  return value;
}

std::uint32_t UartModel::read(std::uint32_t offset, unsigned /*size*/) {
  if (offset == usart::ISR) return status();
  if (offset != usart::RDR) return word(offset);
  if (received_bytes_.empty()) return 0;
  const std::uint8_t byte = received_bytes_.front();
  received_bytes_.pop_front();
  drive_line();
  return byte;
}

void UartModel::check_change(std::uint32_t offset, std::uint32_t value) const {
  if (!enabled()) return;
  std::uint32_t guarded = 0;
  if (offset == usart::BRR || offset == usart::CR2) guarded = ~0U;
  if (offset == usart::CR3)
    guarded = ~(usart::CR3_DMAR.mask() | usart::CR3_DMAT.mask() | usart::CR3_EIE.mask());
  if (offset == usart::CR1) {
    for (const Field& field : {usart::CR1_M0, usart::CR1_M1, usart::CR1_PCE, usart::CR1_PS,
                               usart::CR1_OVER8, usart::CR1_FIFOEN}) {
      guarded |= field.mask();
    }
  }
  if (((word(offset) ^ value) & guarded) != 0)
    complain("set up while enabled, offset " + std::to_string(offset));
}

void UartModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  check_change(offset, value);
  const bool was_enabled = enabled();
  switch (offset) {
    case usart::ICR:
      word(usart::ISR) &= ~value;
      break;
    case usart::TDR:
      if (waiting_.size() >= depth()) complain("TDR: written while full");
      put(static_cast<std::uint8_t>(value));
      break;
    default:
      word(offset) = value;
  }
  if (offset == usart::CR1 && enabled() && !was_enabled) {
    if (word(usart::BRR) < 16) complain("enabled with a divider below 16");
    if (usart::CR1_OVER8.of(value) != 0 || usart::CR1_M1.of(value) != 0)
      complain("format is not modelled");
    if (on_enable) on_enable();
  }
  if (offset == usart::CR1 && !enabled()) {
    received_bytes_.clear();
    waiting_.clear();
    shifting_ = false;
    sent_at_ = idle_at_ = kNever;
  }
  if (offset == usart::CR3 || offset == usart::CR1) pull();
  schedule();
  drive_line();
}

void UartModel::stream_started(std::uint32_t request) {
  if (request == wiring_.transmit_request) {
    pull();
    schedule();
  }
}

// ---- transmission

void UartModel::put(std::uint8_t byte) {
  word(usart::ISR) &= ~usart::ISR_TC.mask();
  if (shifting_) {
    waiting_.push_back(byte);
    return;
  }
  shifting_ = true;
  shifted_ = byte;
  sent_at_ = core().now() + byte_time(own_format());
}

/// The DMA fills what room there is.
void UartModel::pull() {
  if (!enabled() || usart::CR3_DMAT.of(word(usart::CR3)) == 0) return;
  while (waiting_.size() < depth() && dma_.served(wiring_.transmit_request)) {
    std::uint32_t element = 0;
    if (!dma_.move(wiring_.transmit_request, element)) return;
    put(static_cast<std::uint8_t>(element));
  }
}

void UartModel::depart() {
  ++sent_;
  shifting_ = false;
  sent_at_ = kNever;
  if (on_byte) on_byte(shifted_, baud());
  if (!waiting_.empty()) {
    const std::uint8_t next = waiting_.front();
    waiting_.pop_front();
    put(next);
  }
  pull();
  if (!shifting_) word(usart::ISR) |= usart::ISR_TC.mask();
}

// ---- reception

void UartModel::feed(const std::uint8_t* data, std::size_t count, const parts::UartFormat& format) {
  for (std::size_t k = 0; k < count; ++k) wire_.push_back({data[k], format});
  if (arrives_at_ == kNever && !wire_.empty()) arrives_at_ = core().now() + byte_time(format);
  schedule();
}

void UartModel::arrive() {
  const OnWire next = wire_.front();
  wire_.pop_front();
  const Ticks now = core().now();
  arrives_at_ = wire_.empty() ? kNever : now + byte_time(wire_.front().format);
  deliver(next.byte, next.format);
  if (!wire_.empty()) idle_at_ = kNever;
}

void UartModel::deliver(std::uint8_t byte, const parts::UartFormat& format) {
  if (!enabled() || usart::CR1_RE.of(word(usart::CR1)) == 0) return;
  if (!agrees(format)) {
    ++line_errors_;
    word(usart::ISR) |= usart::ISR_FE.mask();
    byte = static_cast<std::uint8_t>(~byte);
  }
  ++received_;
  // The start bit of a byte that follows would come within the first bit.
  idle_at_ = core().now() + byte_time(format) + byte_time(format) / 8;
  std::uint32_t element = byte;
  const bool by_dma = usart::CR3_DMAR.of(word(usart::CR3)) != 0;
  const bool lost = lost_in_ == 1;
  if (lost_in_ > 0) --lost_in_;
  const bool moved = !lost && by_dma && dma_.served(wiring_.receive_request) &&
                     dma_.move(wiring_.receive_request, element);
  if (lost || (!moved && received_bytes_.size() >= depth())) {
    ++overruns_;
    word(usart::ISR) |= usart::ISR_ORE.mask();
  } else if (!moved) {
    received_bytes_.push_back(byte);
  }
  drive_line();
  schedule();
}

void UartModel::event(Ticks now) {
  if (sent_at_ <= now) depart();
  if (arrives_at_ <= now) arrive();
  if (idle_at_ <= now) {
    idle_at_ = kNever;
    word(usart::ISR) |= usart::ISR_IDLE.mask();
  }
  drive_line();
  schedule();
}

void UartModel::schedule() {
  core().set_due(*this, std::min({sent_at_, arrives_at_, idle_at_}));
}

void UartModel::drive_line() {
  const std::uint32_t s = status(), control = word(usart::CR1);
  const auto asks = [s, control](const Field& flag, const Field& enable) {
    return flag.of(s) != 0 && enable.of(control) != 0;
  };
  const bool errors =
      usart::CR3_EIE.of(word(usart::CR3)) != 0 &&
      (s & (usart::ISR_FE.mask() | usart::ISR_NE.mask() | usart::ISR_ORE.mask())) != 0;
  core().set_line(wiring_.irq, errors || asks(usart::ISR_IDLE, usart::CR1_IDLEIE) ||
                                   asks(usart::ISR_RXNE_RXFNE, usart::CR1_RXNEIE_RXFNEIE) ||
                                   asks(usart::ISR_TC, usart::CR1_TCIE) ||
                                   asks(usart::ISR_TXE_TXFNF, usart::CR1_TXEIE_TXFNFIE));
}

}  // namespace rosflight::boards::stm32h7::emulator
