// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/common/byte_ring.hpp"
#include "firmware/boards/parts/usb_cdc.hpp"
#include "firmware/boards/stm32h7/pins.hpp"

namespace rosflight::boards::stm32h7 {

/// The full-speed USB device as a virtual serial port (OTG_FS with its own transceiver, no DMA, supply of
/// the bus not sensed). RM0433 ch. 57.
///
/// A cable that was pulled shows as a bus without frames for 3 ms (suspended); when it is back the host
/// resets the bus and enumerates again, and nothing here has to wait for either. All state belongs to the
/// bus context; the main loop calls read(), and send() with that context masked.
class UsbPort {
 public:
  /// Longest transfer: it fits its FIFO, so one call fills it.
  static constexpr std::size_t kMaxTransfer = 512;

  /// Supply, clock gate, pins, controller. Once.
  void open(const Pin& minus, const Pin& plus);
  /// Bus context, once per tick: the host sees the device when the controller has changed its mode, which
  /// takes 25 ms.
  void step();
  /// A program on the host has the port open and the cable is there.
  bool connected() const { return cdc_.open() && !suspended_; }
  bool sending() const { return sending_; }
  /// If connected and not sending. @param size  1..kMaxTransfer.
  void send(const std::uint8_t* data, std::size_t size);

  bool waiting() const { return !received_.empty(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity);

  void on_interrupt();

 private:
  static constexpr std::size_t kPacket = parts::UsbCdc::kPacketBytes;

  void start_device();
  void bus_reset();
  void open_endpoints();
  void take_received();
  void on_out_endpoints();
  void on_in_endpoints();
  void on_setup();
  void continue_answer();
  void send_packet_0(const std::uint8_t* data, std::size_t size);
  void accept_0();
  void stall_0();
  void accept_data();

  std::uint32_t changed_us_{0};
  bool started_{true};  ///< Or not opened yet.
  parts::UsbCdc cdc_;
  std::array<std::uint8_t, kPacket> control_{};  ///< What endpoint 0 received.
  std::size_t control_size_{0};
  const std::uint8_t* answer_{nullptr};  ///< What is left of the answer to the host.
  std::size_t answer_size_{0};
  bool answering_{false}, receiving_{false};
  ByteRing<2048> received_;
  volatile bool suspended_{true};
  volatile bool sending_{false};
  bool empty_packet_due_{false};  ///< After a transfer of whole packets: so the host sees its end.
  bool accepting_{false};         ///< The data endpoint takes a packet.
};

}  // namespace rosflight::boards::stm32h7
