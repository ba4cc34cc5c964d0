// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "web/server/live_data.hpp"

namespace rosflight::web::server {

/// What a browser may get: each address is listed, so no request reaches another file.
struct Contents {
  /// Files by their address, such as "flight/flight.mcap"; read when they are asked for, in ranges
  /// if the client wants.
  std::map<std::string, std::filesystem::path> files;
  /// Texts by their address, such as "offer.json". "" is the page itself.
  std::map<std::string, std::string> texts;
  /// Something that runs, for the WebSocket; nullptr: there is none. Outlives the server.
  const LiveData* live{nullptr};
};

/// Serves the page to browsers on this computer, over HTTP on 127.0.0.1 and [::1], in a thread of its
/// own.
///
/// Only GET and HEAD, only addresses of Contents. A request must name this server as Host (421
/// otherwise: a foreign name that leads here), and if it has an Origin, as that (403 otherwise: a
/// foreign page). At most kMostClients connections; one that is silent for kSilence_s is closed;
/// a request head has at most kLargestHead bytes.
///
/// A WebSocket at any address speaks the Foxglove protocol v1 (foxglove.hpp) and sends what is new in
/// Contents::live kRate_Hz times a second, to at most kMostViewers. A viewer that does not read
/// misses states and is closed after kSilence_s; nobody waits for it. Its messages have at most
/// kLargestMessage bytes.
class WebServer {
 public:
  static constexpr int kMostClients = 64;
  static constexpr int kMostViewers = 16;
  static constexpr int kRate_Hz = 60;
  static constexpr int kSilence_s = 30;
  static constexpr unsigned kLargestMessage = 65536;
  static constexpr unsigned kLargestHead = 8192;

  /// @param port  0: a free one.
  /// @throws std::system_error  the port cannot be listened to, for example because it is taken.
  explicit WebServer(Contents contents, std::uint16_t port = 0);
  /// Closes all connections.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  /// What to type into a browser.
  std::string address() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosflight::web::server
