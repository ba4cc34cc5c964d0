// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/stm32h7/dma_stream.hpp"
#include "firmware/boards/stm32h7/pins.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::stm32h7 {

/// Time of one character on the wire.
hal::Time character_time(const parts::UartFormat& format);

/// A UART that receives by DMA into a ring and sends by DMA from a buffer. RM0433 ch. 48.
///
/// Its interrupt comes when the line has been idle for one character, and on line errors; that of the
/// transmit stream when a buffer has been taken. Bytes lost because the ring was not read in time are
/// not noticed: it holds 6 ms at 3 Mbaud.
class Uart {
 public:
  struct Pins {
    Instance uart;
    unsigned irq;
    Pin receive, transmit;
    unsigned function;                         ///< Alternate function of both pins.
    unsigned receive_stream, transmit_stream;  ///< One past the last stream: not used.
    std::uint32_t receive_request;             ///< The transmit request is the next number.
  };
  static constexpr unsigned kNoStream = 16;
  /// Memory for the DMA, of section .dma.
  struct Memory {
    std::uint8_t* ring;
    std::size_t ring_size;
    std::uint8_t* out;
    std::size_t out_size;
  };

  Uart(const Pins& pins, const Memory& memory)
      : pins_{pins},
        memory_{memory},
        receive_{pins.receive_stream},
        transmit_{pins.transmit_stream} {}

  /// Opens or reopens it; what was queued or received is lost.
  /// @returns false, and changes nothing, if the rate cannot be had within 2 %.
  bool open(const parts::UartFormat& format);
  /// Bytes in the ring that read() would return.
  std::size_t waiting() const;
  std::size_t read(std::uint8_t* data, std::size_t capacity);

  /// The buffer to fill before send(); valid if it is not sending.
  std::uint8_t* out() { return memory_.out; }
  std::size_t out_size() const { return memory_.out_size; }
  bool sending() const { return sending_; }
  /// The last stop bit has left.
  bool line_is_quiet() const { return usart::ISR_TC.of(reg(pins_.uart, usart::ISR)) != 0; }
  void send(std::size_t count);

  /// What the UART's own interrupt was for; clears it.
  struct Event {
    bool idle{};
    bool error{};
  };
  Event on_interrupt();
  /// Interrupt of the transmit stream.
  void on_sent();

 private:
  bool sends() const { return pins_.transmit_stream != kNoStream; }
  std::size_t written() const { return (memory_.ring_size - receive_.left()) % memory_.ring_size; }

  Pins pins_;
  Memory memory_;
  DmaStream receive_;
  DmaStream transmit_;
  std::size_t taken_{0};
  volatile bool sending_{false};
};

/// Gives what a UART receives to a decoder, in the bus context.
class UartListener {
 public:
  /// All must outlive this.
  UartListener(const Uart::Pins& pins, const Uart::Memory& memory, const hal::Clock& clock)
      : uart_{pins, memory}, clock_{clock} {}
  /// May be called again, with another decoder.
  bool open(const parts::UartFormat& format, parts::ByteReceiver& receiver);
  void on_interrupt();

 private:
  Uart uart_;
  const hal::Clock& clock_;
  parts::ByteReceiver* receiver_{nullptr};
  hal::Time character_{};
};

}  // namespace rosflight::boards::stm32h7
