// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <deque>
#include <functional>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

struct UartWiring {
  std::uint32_t receive_request{};
  std::uint32_t transmit_request{};
  unsigned irq{};
};

/// USART, asynchronous, 8 data bits, with and without FIFO. RM0433 ch. 48.
///
/// Bytes take their time on the wire. A far end with another rate (off by more than 3 %), parity or
/// polarity is received as framing errors, as on a real line. Complains of: BRR, CR2, CR3 or the
/// format written while enabled; a lost byte (overrun); functions that are not modelled.
class UartModel final : public Peripheral {
 public:
  UartModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
            const DmaRequests& dma, const UartWiring& wiring);

  void reset() override;
  void event(Ticks now) override;

  /// The far end sends: the bytes follow on the wire behind those that wait.
  void feed(const std::uint8_t* data, std::size_t count, const parts::UartFormat& format);
  /// A byte whose stop bit ends now, of a far end that keeps its own time.
  void deliver(std::uint8_t byte, const parts::UartFormat& format);
  /// Injects a fault: the byte behind the next `after` is not fetched in time.
  void lose_byte(unsigned after) { lost_in_ = after + 1; }
  /// A byte has left: its stop bit ended now.
  std::function<void(std::uint8_t byte, std::uint32_t baud)> on_byte;
  /// Called when the UART is enabled: pins can be checked.
  std::function<void()> on_enable;
  /// The controller started a stream for this request.
  void stream_started(std::uint32_t request);

  std::uint64_t received() const { return received_; }
  std::uint64_t sent() const { return sent_; }
  std::uint64_t overruns() const { return overruns_; }
  std::uint64_t line_errors() const { return line_errors_; }

 private:
  struct OnWire {
    std::uint8_t byte{};
    parts::UartFormat format;
  };
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void check_change(std::uint32_t offset, std::uint32_t value) const;
  bool enabled() const { return usart::CR1_UE.of(word(usart::CR1)) != 0; }
  std::uint32_t baud() const;
  bool agrees(const parts::UartFormat& far) const;
  std::size_t depth() const { return usart::CR1_FIFOEN.of(word(usart::CR1)) != 0 ? 16 : 1; }
  Ticks byte_time(const parts::UartFormat& format) const;
  parts::UartFormat own_format() const;
  std::uint32_t status() const;
  void put(std::uint8_t byte);
  void pull();
  void arrive();
  void depart();
  void schedule();
  void drive_line();

  const ClockTree& clocks_;
  const DmaRequests& dma_;
  UartWiring wiring_;
  std::deque<OnWire> wire_;
  std::deque<std::uint8_t> received_bytes_, waiting_;
  bool shifting_{false};
  unsigned lost_in_{0};  ///< The injected loss, as bytes from now; 0: none.
  std::uint8_t shifted_{0};
  Ticks sent_at_{kNever}, arrives_at_{kNever}, idle_at_{kNever};
  std::uint64_t received_{0}, sent_{0}, overruns_{0}, line_errors_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
