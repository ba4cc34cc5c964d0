// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace rosflight::boards {

/// Where the serial port of the board comes out.
///
///     pty              a new pseudo terminal
///     pty:PATH         the same, with a symbolic link PATH to it
///     udp:HOST:PORT    datagrams to HOST:PORT, from a port of its own
///     tcp:PORT         one client at a time on 127.0.0.1:PORT
///     tcp:HOST:PORT    the same on another address of this machine, such as 0.0.0.0
///
/// HOST is a name, an IPv4 address or an IPv6 address in brackets.
struct LinkAddress {
  enum class Kind : std::uint8_t { kPty, kUdp, kTcp };
  /// ROSflight 2.x's simulator listens and sends on these two.
  static constexpr std::uint16_t kGroundPort = 14520;
  static constexpr std::uint16_t kBoardPort = 14525;

  Kind kind{Kind::kPty};
  std::string path;  ///< Of the symbolic link; empty: none.
  std::string host;
  std::uint16_t port{};    ///< 0 (TCP): any free one.
  std::uint16_t listen{};  ///< UDP: own port; 0: any free one.

  /// Own port of a UDP link: kBoardPort if the far end is kGroundPort, otherwise any free one.
  /// @throws BoardError  one line with the text and what is allowed.
  static LinkAddress parse(std::string_view text);
};

}  // namespace rosflight::boards
