// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "web/server/access.hpp"
#include "web/server/admission.hpp"
#include "web/server/command_desk.hpp"
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
  /// Where its viewers' commands go; nullptr: they have none. Outlives the server.
  CommandDesk* desk{nullptr};
};

/// Serves the page to browsers, over HTTP, in a thread of its own: on 127.0.0.1 and [::1], or on
/// Access::listen.
///
/// Only GET and HEAD, only addresses of Contents. A request must name this server as Host, by the
/// address where it listens (421 otherwise: a foreign name that leads here), and if it has an Origin, as
/// that (403 otherwise: a foreign page); a WebSocket may also come from Admission::kApplications and
/// Access::origins, to look. At most kMaxClients connections; a request head has at most kMaxHead bytes
/// (431) and no body (413).
///
/// A token, 128 random bits of this start, is in address() after '#', which browsers send to nobody; there
/// is one to look and one to command. On this computer everybody may command.
/// Files of the page itself are free; other addresses of Contents want it as `Authorization: Bearer`
/// (401 otherwise), a WebSocket as its first message {"op":"token","token":"..."}.
///
/// A WebSocket at any address speaks the Foxglove protocol v1 (foxglove.hpp) and sends what is new in
/// Contents::live kRate_Hz times a second, to at most kMaxViewers (503). A viewer that reads slowly, or
/// is behind a slow network, misses states: no message is sent while more than kMaxOnTheWay bytes are not
/// confirmed by it, which any WebSocket does by itself. One that does not read is closed after
/// Access::silence; nobody waits for it. Its messages have at most kMaxMessage bytes.
class WebServer {
 public:
  static constexpr int kMaxClients = 64;
  static constexpr int kMaxViewers = 16;
  static constexpr int kRate_Hz = 60;
  static constexpr unsigned kMaxMessage = 65536;
  static constexpr unsigned kMaxOnTheWay = 65536;
  static constexpr unsigned kMaxHead = 8192;

  /// @throws std::system_error  it cannot listen there, for example because the port is taken.
  /// @throws std::invalid_argument  `listen` is no address of one interface.
  explicit WebServer(Contents contents, Access access = {});
  /// Closes all connections.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  /// What to type into a browser, with the token of that right if there is one.
  std::string address(Right right = Right::kLook) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rosflight::web::server
