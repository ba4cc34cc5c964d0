// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "firmware/boards/linux/transmit_queue.hpp"
#include "firmware/boards/linux/wire.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// The serial port of the board over a pseudo terminal, UDP or TCP. Never blocks.
///
///     receive()  wire -> receive buffer        before a pass of the main loop
///     read(), write()                          in the pass, memory only
///     transmit() transmit queue -> wire        after it, most urgent frames first
///
/// A pass reads kReceiveChunk bytes at most, so a flood of bytes cannot hold up the control loop;
/// the rest waits for the next pass. While nobody is at the far end, what is sent is lost, as on a
/// bare plug.
class LinuxSerial final : public hal::Serial {
 public:
  static constexpr std::size_t kTransmitCapacity = 8192;
  static constexpr std::size_t kReceiveChunk = 4096;

  struct Counters {
    std::uint64_t bytes_received{};
    std::uint64_t bytes_sent{};
    std::uint64_t frames_dropped{};  ///< The transmit queue was full.
  };

  /// @throws base::LinkError  see open_wire().
  explicit LinuxSerial(const LinkAddress& address);

  /// Any rate of the one device: the operating system's files have none.
  bool open(std::uint32_t baud, std::uint8_t device) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;
  std::size_t writable() const override { return queue_.room(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;

  void receive();
  void transmit();
  /// There is more than one pass could read: make another soon.
  bool more() const { return received_size_ > readable_; }
  /// Adds what would make receive() or transmit() worth calling.
  void add_to(std::vector<pollfd>& set) const { wire_->add_to(set, begun_ < staged_size_); }
  /// While cut, no byte arrives, either way.
  void set_cut(bool cut) { cut_ = cut; }
  /// Forgets what waits in both directions, as a reset does.
  void clear();

  std::string where() const { return wire_->where(); }
  const Counters& counters() const { return counters_; }

 private:
  /// What waits for someone who has left, or for nobody, is not for the next one.
  void forget_old_peer();

  static constexpr std::size_t kMaxDatagram = 65536;
  /// Keeps datagrams below the common frame size of networks.
  static constexpr std::size_t kMaxSend = 1400;

  std::unique_ptr<Wire> wire_;
  TransmitQueue queue_{kTransmitCapacity};
  std::vector<std::uint8_t> received_;
  std::size_t received_size_{0};
  std::size_t readable_{0};  ///< Bytes of received_ that this pass may read.
  std::size_t read_{0};
  std::vector<std::uint8_t> staged_;  ///< Frames on their way to the operating system.
  std::size_t staged_size_{0};
  std::size_t begun_{0};  ///< Bytes of staged_ that it has taken.
  std::uint32_t peer_{0};
  Counters counters_;
  bool connected_{false};
  bool cut_{false};
};

}  // namespace rosflight::boards
