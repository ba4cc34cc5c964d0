// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rosflight::companion {

/// A link that cannot be: one line that names it and the reason.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Which link to open, as people write it:
///
///     serial:PATH[:BAUD]          8N1 without flow control; 921600 baud if not given
///     pty                         a new pseudo terminal; the peer opens its other end
///     udp:HOST:PORT[:LOCAL_PORT]  datagrams to and from HOST:PORT; here at LOCAL_PORT (14520)
///     udp:PORT                    waits here for a peer; for the next after 2 s of silence
///     tcp:HOST:PORT               connects there
///     tcp:PORT                    waits here for one peer at a time
///
/// A HOST with colons (IPv6) stands in brackets.
struct LinkSpec {
  enum class Kind : std::uint8_t { kSerial, kPty, kUdp, kUdpServer, kTcpClient, kTcpServer };

  Kind kind{Kind::kPty};
  std::string path;  ///< kSerial.
  std::uint32_t baud{921600};
  std::string host;  ///< kUdp, kTcpClient.
  std::uint16_t port{};
  std::uint16_t local_port{14520};  ///< kUdp.

  /// As it would be written.
  std::string text() const;
};

/// Throws LinkError.
LinkSpec parse_link(std::string_view text);

}  // namespace rosflight::companion
