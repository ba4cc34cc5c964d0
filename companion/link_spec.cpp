// SPDX-License-Identifier: BSD-3-Clause
#include "companion/link_spec.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace rosflight::companion {

namespace {

constexpr std::array<std::uint32_t, 14> kBauds = {9600,    19200,   38400,   57600,  115200,
                                                  230400,  460800,  500000,  576000, 921600,
                                                  1000000, 1500000, 2000000, 3000000};

[[noreturn]] void fail(std::string_view text, const std::string& found,
                       const std::string& allowed) {
  throw LinkError("link \"" + std::string(text) + "\": found " + found + ", allowed " + allowed);
}

template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = result.ec == std::errc{} && result.ptr == text.data() + text.size();
  return whole && value > 0 ? std::optional(value) : std::nullopt;
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

LinkSpec parse_serial(std::string_view whole, std::string_view rest) {
  LinkSpec spec;
  spec.kind = LinkSpec::Kind::kSerial;
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

LinkSpec parse_udp(std::string_view whole, std::string_view rest) {
  LinkSpec spec;
  if (rest.find(':') == std::string_view::npos) {
    spec.kind = LinkSpec::Kind::kUdpServer;
    spec.port = port(whole, rest);
    return spec;
  }
  spec.kind = LinkSpec::Kind::kUdp;
  spec.host = take_host(whole, rest);
  const std::size_t colon = rest.find(':');
  spec.port = port(whole, rest.substr(0, colon));
  if (colon != std::string_view::npos) {
    spec.local_port = port(whole, rest.substr(colon + 1));
  }
  return spec;
}

LinkSpec parse_tcp(std::string_view whole, std::string_view rest) {
  LinkSpec spec;
  const bool only_port = rest.find(':') == std::string_view::npos;
  spec.kind = only_port ? LinkSpec::Kind::kTcpServer : LinkSpec::Kind::kTcpClient;
  if (!only_port) {
    spec.host = take_host(whole, rest);
  }
  spec.port = port(whole, rest);
  return spec;
}

}  // namespace

LinkSpec parse_link(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
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

std::string LinkSpec::text() const {
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

}  // namespace rosflight::companion
