// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/frame_queues.hpp"
#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::m7 {

/// The serial role on a CMSDK UART, driven by interrupts in both directions. Three transmit queues,
/// the most urgent frame next; a frame on its way is not interrupted. A received byte that finds
/// its queue full is lost and counted, as on any UART.
///
/// The image forwards its two interrupts to on_receive() and on_transmit().
class Uart final : public hal::Serial {
 public:
  struct Peripheral {
    std::uintptr_t base;
    unsigned receive_irq;
    unsigned transmit_irq;
  };
  static constexpr Peripheral kUart0{0x4000'4000u, 0, 1};
  static constexpr Peripheral kUart1{0x4000'5000u, 2, 3};

  explicit Uart(const Peripheral& peripheral) : peripheral_{peripheral} {}

  /// The one device there is, at any rate that the clock can be divided to (up to 1.5 Mbit/s).
  bool open(std::uint32_t baud, std::uint8_t device) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;
  std::size_t writable() const override { return queues_.writable(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;
  bool waiting() const { return !received_.empty(); }
  /// Everything written is out.
  bool idle() const;

  void on_receive();
  void on_transmit();

  struct Counters {
    std::uint32_t received{};
    std::uint32_t sent{};
    std::uint32_t overruns{};  ///< Received bytes without room.
  };
  const Counters& counters() const { return counters_; }
  std::uint32_t frames_dropped() const { return queues_.dropped(); }

 private:
  volatile std::uint32_t& data_register() const { return reg(peripheral_.base); }
  volatile std::uint32_t& state() const { return reg(peripheral_.base + 0x04u); }
  volatile std::uint32_t& control() const { return reg(peripheral_.base + 0x08u); }
  volatile std::uint32_t& interrupts() const { return reg(peripheral_.base + 0x0Cu); }
  volatile std::uint32_t& divider() const { return reg(peripheral_.base + 0x10u); }

  Peripheral peripheral_;
  ByteRing<8192> received_;
  FrameQueues<4096> queues_;
  Counters counters_{};
};

}  // namespace rosflight::boards::m7
