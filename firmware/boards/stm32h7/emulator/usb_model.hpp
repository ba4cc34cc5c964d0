// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// The full-speed USB device (OTG_FS), packet by packet, without DMA. RM0433 ch. 57. The host is another
/// object: it plugs the cable and offers packets to endpoints.
///
/// Complains of: a start without 48 MHz, supply of the transceiver, device mode, or with FIFOs that
/// overlap; a FIFO written beyond its depth or read while empty; an endpoint enabled twice.
class UsbModel final : public Peripheral {
 public:
  static constexpr std::size_t kEndpoints = 3;
  using Packet = std::vector<std::uint8_t>;

  UsbModel(Core& core, const ClockTree& clocks, const PowerControl& power)
      : Peripheral{core, "OTG_FS", "OTG", USB2_OTG_FS}, clocks_{clocks}, power_{power} {
    for (std::uint32_t k = 0; k < kEndpoints; ++k) {
      describe("OTG_IN", in_at(k, 0));
      describe("OTG_OUT", out_at(k, 0));
    }
  }

  void reset() override;
  std::uint32_t size() const override { return 0x1000U * (kEndpoints + 1); }
  std::uint32_t bus_read(std::uint32_t offset, unsigned size) override;
  void bus_write(std::uint32_t offset, std::uint32_t value, unsigned size) override;

  // ---- the host's side
  /// The device has its pull-up on: a host can see it.
  bool attached() const { return attached_; }
  std::uint32_t address() const { return otg::DCFG_DAD.of(word(otg::DCFG)); }
  void reset_bus();
  void enumerated();
  void suspend();

  enum class Result : std::uint8_t { kDone, kNak, kStall };
  /// A set-up packet for endpoint 0: never refused.
  void send_setup(const std::array<std::uint8_t, 8>& setup);
  /// A packet to an endpoint.
  Result send(std::size_t endpoint, const Packet& packet);
  /// Asks an endpoint for a packet.
  Result receive(std::size_t endpoint, Packet& packet);
  /// Called when the device attaches: pins can be checked.
  std::function<void()> on_attach;

 private:
  struct Received {
    std::uint32_t endpoint{}, status{};
    Packet bytes;
  };
  static constexpr std::uint32_t in_at(std::size_t endpoint, std::uint32_t offset) {
    return 0x900U + 0x20U * static_cast<std::uint32_t>(endpoint) + offset;
  }
  static constexpr std::uint32_t out_at(std::size_t endpoint, std::uint32_t offset) {
    return 0xB00U + 0x20U * static_cast<std::uint32_t>(endpoint) + offset;
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t offset, std::uint32_t value);
  void write_device_control(std::uint32_t value);
  std::uint32_t pop_status();
  std::uint32_t pop_word();
  void push_word(std::size_t endpoint, std::uint32_t value);
  std::uint32_t interrupts() const;
  std::uint32_t endpoint_interrupts() const;
  std::uint32_t depth(std::size_t endpoint) const;
  void check_start();
  void raise(const Field& event);
  void drive_line();

  const ClockTree& clocks_;
  const PowerControl& power_;
  bool attached_{false};
  std::deque<Received> received_;     ///< The receive FIFO.
  std::deque<std::uint8_t> reading_;  ///< Bytes of the entry that was popped.
  std::array<std::deque<std::uint8_t>, kEndpoints> to_host_;  ///< FIFOs, in whole words.
};

}  // namespace rosflight::boards::stm32h7::emulator
