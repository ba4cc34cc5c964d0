// SPDX-License-Identifier: BSD-3-Clause
#include "base/transport/link_address.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace rosflight::base {

namespace {

constexpr std::array<std::uint32_t, 14> kBauds = {9600,    19200,   38400,   57600,  115200,
                                                  230400,  460800,  500000,  576000, 921600,
                                                  1000000, 1500000, 2000000, 3000000};

[[noreturn]] void fail(std::string_view text, const std::string& found,
                       const std::string& allowed) {
  throw LinkError("link \"" + std::string(text) + "\": found " + found + ", allowed " + allowed);
}

template <class T>
std::optional<T> number(std::string_view text, T min = 1) {
  T value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = result.ec == std::errc{} && result.ptr == text.data() + text.size();
  return whole && value >= min ? std::optional(value) : std::nullopt;
}

std::uint16_t port(std::string_view whole, std::string_view text) {
  const auto value = number<std::uint16_t>(text);
  if (!value) {
    fail(whole, text.empty() ? "no port" : "port \"" + std::string(text) + "\"",
         "a port from 1 to 65535");
  }
  return *value;
}

/// Cuts the host off `rest`; what follows it stays, without its colon.
std::string take_host(std::string_view whole, std::string_view& rest) {
  const bool bracketed = !rest.empty() && rest.front() == '[';
  const std::size_t end = bracketed ? rest.find(']') : rest.find(':');
  const std::size_t after = bracketed && end != std::string_view::npos ? end + 1 : end;
  const std::string host(bracketed && end != std::string_view::npos ? rest.substr(1, end - 1)
                                                                    : rest.substr(0, end));
  if (after == std::string_view::npos || after >= rest.size() || rest[after] != ':' ||
      host.empty()) {
    fail(whole, "no host and port", "HOST:PORT");
  }
  rest.remove_prefix(after + 1);
  return host;
}

/// What follows the colon; nothing if there is none.
std::string_view after(std::string_view text, std::size_t colon) {
  return colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
}

[[noreturn]] void fail_board(std::string_view text, const std::string& found) {
  throw LinkError("link '" + std::string(text) + "': found " + found +
                  ", allowed pty, pty:PATH, udp:HOST:PORT, tcp:PORT, tcp:HOST:PORT");
}

std::uint16_t board_port(std::string_view whole, std::string_view text, std::uint16_t min) {
  const auto value = number<std::uint16_t>(text, min);
  if (!value) fail_board(whole, "port '" + std::string(text) + "'");
  return *value;
}

/// Without the brackets of an IPv6 address.
std::string board_host(std::string_view whole, std::string_view host) {
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    fail_board(whole, "an address with ':' outside brackets");
  }
  if (host.empty()) fail_board(whole, "no host");
  return std::string(host);
}

LinkAddress parse_serial(std::string_view whole, std::string_view rest) {
  LinkAddress spec;
  spec.kind = LinkAddress::Kind::kSerial;
  const std::size_t colon = rest.rfind(':');
  spec.path = rest.substr(0, colon);
  if (spec.path.empty()) {
    fail(whole, "no device", "serial:PATH[:BAUD], for instance serial:/dev/ttyACM0:921600");
  }
  if (colon != std::string_view::npos) {
    const std::string_view text = rest.substr(colon + 1);
    const auto baud = number<std::uint32_t>(text);
    if (!baud || std::find(kBauds.begin(), kBauds.end(), *baud) == kBauds.end()) {
      std::string allowed;
      for (const std::uint32_t b : kBauds) {
        allowed += (allowed.empty() ? "" : " ") + std::to_string(b);
      }
      fail(whole, "baud rate \"" + std::string(text) + "\"", allowed);
    }
    spec.baud = *baud;
  }
  return spec;
}

LinkAddress parse_udp(std::string_view whole, std::string_view rest) {
  LinkAddress spec;
  if (rest.find(':') == std::string_view::npos) {
    spec.kind = LinkAddress::Kind::kUdpServer;
    spec.port = port(whole, rest);
    return spec;
  }
  spec.kind = LinkAddress::Kind::kUdp;
  spec.host = take_host(whole, rest);
  const std::size_t colon = rest.find(':');
  spec.port = port(whole, rest.substr(0, colon));
  if (colon != std::string_view::npos) {
    spec.local_port = port(whole, rest.substr(colon + 1));
  }
  return spec;
}

LinkAddress parse_tcp(std::string_view whole, std::string_view rest) {
  LinkAddress spec;
  const bool only_port = rest.find(':') == std::string_view::npos;
  spec.kind = only_port ? LinkAddress::Kind::kTcpServer : LinkAddress::Kind::kTcpClient;
  if (!only_port) {
    spec.host = take_host(whole, rest);
  }
  spec.port = port(whole, rest);
  return spec;
}

}  // namespace

LinkAddress parse_link(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest = after(text, colon);
  if (kind == "serial") {
    return parse_serial(text, rest);
  }
  if (kind == "udp") {
    return parse_udp(text, rest);
  }
  if (kind == "tcp") {
    return parse_tcp(text, rest);
  }
  if (text == "pty") {
    return {};
  }
  fail(text, "\"" + std::string(kind) + "\"",
       "serial:PATH[:BAUD], pty, udp:HOST:PORT[:LOCAL_PORT], udp:PORT, tcp:HOST:PORT or tcp:PORT");
}

LinkAddress parse_board_link(std::string_view text) {
  LinkAddress address;
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest = after(text, colon);
  const std::size_t last = rest.rfind(':');
  if (kind == "pty") {
    address.path = rest;
    if (colon != std::string_view::npos && rest.empty()) fail_board(text, "no path");
  } else if (kind == "udp") {
    address.kind = LinkAddress::Kind::kUdp;
    if (last == std::string_view::npos) fail_board(text, "no port");
    address.host = board_host(text, rest.substr(0, last));
    address.port = board_port(text, rest.substr(last + 1), 1);
    const bool usual = address.port == LinkAddress::kGroundPort;
    address.local_port = usual ? LinkAddress::kBoardPort : std::uint16_t{0};
  } else if (kind == "tcp") {
    address.kind = LinkAddress::Kind::kTcpServer;
    const bool has_host = last != std::string_view::npos;
    address.host = has_host ? board_host(text, rest.substr(0, last)) : "127.0.0.1";
    address.port = board_port(text, has_host ? rest.substr(last + 1) : rest, 0);
  } else {
    fail_board(text, "'" + std::string(kind) + "'");
  }
  return address;
}

std::string LinkAddress::text() const {
  const std::string shown_host = host.find(':') == std::string::npos ? host : "[" + host + "]";
  switch (kind) {
    case Kind::kSerial:
      return "serial:" + path + ":" + std::to_string(baud);
    case Kind::kPty:
      return "pty";
    case Kind::kUdp:
      return "udp:" + shown_host + ":" + std::to_string(port) + ":" + std::to_string(local_port);
    case Kind::kUdpServer:
      return "udp:" + std::to_string(port);
    case Kind::kTcpClient:
      return "tcp:" + shown_host + ":" + std::to_string(port);
    case Kind::kTcpServer:
      return "tcp:" + std::to_string(port);
  }
  return {};
}

}  // namespace rosflight::base
