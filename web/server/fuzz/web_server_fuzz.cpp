// SPDX-License-Identifier: BSD-3-Clause
// Any bytes of a client, over a connection: HTTP, and WebSocket behind its handshake. The server answers in its own words or closes,
// and gets to the end of every connection. "$PORT" in the input stands for the server's port, so that the name can be right.
// An input with "$TOKEN" goes to a second server, which wants a token, and the word stands for that of the right to command.
// After a head that ends in "websocket" the answer is awaited. Commands are answered by a thread, as by that of a vehicle.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>
#include <variant>

#include "web/server/web_server.hpp"

namespace {

using namespace rosflight::web::server;
using namespace std::chrono_literals;

constexpr auto kTurn = 50us;  // a command waits no longer for its answer
constexpr auto kAnswered = 4 * kTurn;

struct Server {
  explicit Server(const char* listen)
      : web{{{{"self", "/proc/self/exe"}}, {{"", "<p>page"}, {"offer.json", "{}"}}, &live, &desk},
            {.listen = listen}},
        port{std::to_string(web.port())} {
    const std::string address = web.address(Right::kCommand);
    if (*listen != 0) token = address.substr(address.find('#') + 1);
    desk.set_parameters({{{"A", 1.0, true}, {"B", 2.0, false}}, true});
    const std::size_t channel =
        live.add_channel({"/text", "std_msgs/msg/String", "string data", LiveData::Kind::kEvent});
    const std::array<std::uint8_t, 9> message{0, 1, 0, 0, 1, 0, 0, 0, 0};
    live.put(channel, 1, message);
    vehicle = std::jthread([this](const std::stop_token& end) {
      for (; !end.stop_requested(); std::this_thread::sleep_for(kTurn)) answer_commands();
    });
  }

  /// The viewer of the latest command has control.
  void answer_commands() {
    for (const CommandDesk::Command& command : desk.commands()) {
      if (std::holds_alternative<CommandDesk::Gone>(command.what)) continue;
      desk.answer({command.viewer, command.id, {{"A", 1.0, true, "set"}, {{}, {}, false, "no"}}});
      desk.set_control({command.viewer, true, false, 1.0});
    }
  }

  LiveData live;
  CommandDesk desk;
  WebServer web;
  std::string port;
  std::string token;
  std::jthread vehicle;
};

void replace_all(std::string& text, std::string_view word, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += by.size())
    text.replace(at, word.size(), by);
}

int connected(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(port);
  there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr generic{};
  std::memcpy(&generic, &there, sizeof there);
  const timeval timeout{20, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
  if (::connect(socket, &generic, sizeof generic) != 0) std::abort();
  return socket;
}

/// What the server sends until it closes the connection, there is enough of it, or, if asked for, an
/// answer's head has come. Time is up: abort.
std::string answer(int socket, bool head_only) {
  constexpr std::size_t kEnough = 65536;  // of a file
  std::string said;
  std::array<char, 4096> buffer{};
  while (said.size() < kEnough && !(head_only && said.find("\r\n\r\n") != std::string::npos)) {
    const ssize_t n = ::recv(socket, buffer.data(), buffer.size(), 0);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) std::abort();
    if (n <= 0) break;
    said.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return said;
}

/// A masked text "{}": answers that have come until then are sent after the complaint about it.
constexpr std::string_view kNudge("\x81\x82\0\0\0\0{}", 8);

void say(int socket, std::string_view text) {
  static_cast<void>(::send(socket, text.data(), text.size(), MSG_NOSIGNAL));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Server open("");
  static Server guarded("127.0.0.1");
  constexpr std::string_view kToken = "$TOKEN";
  std::string text(reinterpret_cast<const char*>(data), size);
  const Server& server = text.find(kToken) == std::string::npos ? open : guarded;
  replace_all(text, kToken, server.token);
  replace_all(text, "$PORT", server.port);
  constexpr std::string_view kHandshake = "websocket\r\n\r\n";
  const std::size_t handshake = text.find(kHandshake);
  const int socket = connected(server.web.port());
  std::string said;
  if (handshake != std::string::npos) {
    const std::size_t end = handshake + kHandshake.size();
    say(socket, text.substr(0, end));
    said = answer(socket, true);
    text.erase(0, end);
  }
  say(socket, text);
  if (handshake != std::string::npos) {
    std::this_thread::sleep_for(kAnswered);
    say(socket, kNudge);
    std::this_thread::sleep_for(kAnswered);
  }
  ::shutdown(socket, SHUT_WR);
  said += answer(socket, false);
  ::close(socket);
  if (!said.empty() && said.rfind("HTTP/1.", 0) != 0) std::abort();
  return 0;
}
