// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/transport/link_address.hpp"

namespace rosflight::boards {

using base::LinkAddress;

/// What carries the bytes of a serial port: a file of the operating system that never blocks.
class Wire {
 public:
  virtual ~Wire() = default;

  /// Looks who came and who left. Call it before a round of receive() and send().
  /// @returns whether there is a far end; without one, there is nobody to send to, though what the
  /// last one sent may still be waiting.
  virtual bool refresh() = 0;
  /// Changes when another far end takes the place of the one before: what was begun for the old
  /// one must not be continued.
  virtual std::uint32_t peer() const = 0;
  /// @returns the number of bytes copied, 0 if nothing waits. Datagrams come one at a time; those
  /// larger than `capacity` are cut.
  virtual std::size_t receive(std::uint8_t* data, std::size_t capacity) = 0;
  /// @returns how many bytes the operating system took; what it can never take counts as taken.
  virtual std::size_t send(const std::uint8_t* data, std::size_t size) = 0;
  /// What to wait for: bytes, a new far end and, if `sending`, room.
  virtual void add_to(std::vector<pollfd>& set, bool sending) const = 0;
  /// Where the far end finds this end, as key=value words.
  virtual std::string where() const = 0;
};

/// @throws LinuxError  the address cannot be had: taken, unknown, not of this machine.
std::unique_ptr<Wire> open_wire(const LinkAddress& address);
std::unique_ptr<Wire> open_pty(const LinkAddress& address);
std::unique_ptr<Wire> open_udp(const LinkAddress& address);
std::unique_ptr<Wire> open_tcp(const LinkAddress& address);

}  // namespace rosflight::boards
