// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace rosflight::web::server {

/// Where a WebServer listens, and for how long it bears with a client.
struct Access {
  std::uint16_t port{0};  ///< 0: a free one.
  /// Address of one network interface, such as 192.168.0.7, for other computers: then data are given
  /// only to those who know the token. Empty: this computer alone, without a token.
  std::string listen;
  std::chrono::milliseconds silence{30'000};  ///< Then a connection is closed.
  std::chrono::milliseconds handshake{
      10'000};  ///< For the start of a WebSocket, and for the token.
  /// Origins of further pages whose WebSockets may look, such as https://example.org.
  // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers leave it out
  std::vector<std::string> origins{};
};

}  // namespace rosflight::web::server
