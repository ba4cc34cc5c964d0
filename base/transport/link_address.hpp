// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rosflight::base {

/// A link that cannot be: one line that names it and the reason.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One end of a byte link. parse_link() reads that of a companion
///
///     serial:PATH[:BAUD]          8N1 without flow control; 921600 baud if not given
///     pty                         a new pseudo terminal; the peer opens its other end
///     udp:HOST:PORT[:LOCAL_PORT]  datagrams to and from HOST:PORT; here at LOCAL_PORT (14520)
///     udp:PORT                    waits here for a peer; for the next after 2 s of silence
///     tcp:HOST:PORT               connects there
///     tcp:PORT                    waits here for one peer at a time
///
/// and parse_board_link() that of a simulated board, which is the server of the pair
///
///     pty                         a new pseudo terminal
///     pty:PATH                    the same, with a symbolic link PATH to it
///     udp:HOST:PORT               datagrams to HOST:PORT, from a port of its own
///     tcp:PORT                    one client at a time on 127.0.0.1:PORT
///     tcp:HOST:PORT               the same on another address of this machine, such as 0.0.0.0
///
/// HOST is a name, an IPv4 address or an IPv6 address in brackets.
struct LinkAddress {
  enum class Kind : std::uint8_t { kSerial, kPty, kUdp, kUdpServer, kTcpClient, kTcpServer };
  /// ROSflight 2.x's simulator listens and sends on these two.
  static constexpr std::uint16_t kGroundPort = 14520;
  static constexpr std::uint16_t kBoardPort = 14525;

  Kind kind{Kind::kPty};
  std::string path;  ///< Path of the device, or of the symbolic link to a pty; empty: none.
  std::uint32_t baud{921600};
  std::string host;                       ///< kTcpServer: address to listen on; empty: all.
  std::uint16_t port{};                   ///< 0 (board's TCP): any free one.
  std::uint16_t local_port{kGroundPort};  ///< kUdp; 0: any free one.

  /// Text that parse_link() reads.
  std::string text() const;
};

/// @throws LinkError  one line with the text, what was found and what is allowed.
LinkAddress parse_link(std::string_view text);
/// Own port of a UDP link: kBoardPort if the far end is kGroundPort, otherwise any free one.
/// @throws LinkError  as parse_link().
LinkAddress parse_board_link(std::string_view text);

}  // namespace rosflight::base
