// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/link_address.hpp"

#include <charconv>

#include "firmware/boards/linux/board_error.hpp"

namespace rosflight::boards {
namespace {

BoardError bad(std::string_view text, const std::string& why) {
  return BoardError{"link '" + std::string{text} + "': " + why +
                    ", allowed pty, pty:PATH, udp:HOST:PORT, tcp:PORT, tcp:HOST:PORT"};
}

std::uint16_t port_of(std::string_view text, std::string_view digits, unsigned lowest) {
  unsigned port = 0;
  const char* end = digits.data() + digits.size();
  const auto [used, code] = std::from_chars(digits.data(), end, port);
  constexpr unsigned kHighest = 65535;
  if (code != std::errc{} || used != end || port < lowest || port > kHighest) {
    throw bad(text, "found port '" + std::string{digits} + "'");
  }
  return static_cast<std::uint16_t>(port);
}

/// "HOST:PORT" with the brackets of an IPv6 address taken off.
std::string host_of(std::string_view text, std::string_view host) {
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    throw bad(text, "found an address with ':' outside brackets");
  }
  if (host.empty()) throw bad(text, "found no host");
  return std::string{host};
}

}  // namespace

LinkAddress LinkAddress::parse(std::string_view text) {
  LinkAddress address;
  if (text == "pty") return address;
  const std::size_t colon = text.find(':');
  const std::string_view scheme = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  const std::size_t last = rest.rfind(':');
  if (scheme == "pty") {
    if (rest.empty()) throw bad(text, "found no path");
    address.path = rest;
  } else if (scheme == "udp") {
    address.kind = Kind::kUdp;
    if (last == std::string_view::npos) throw bad(text, "found no port");
    address.host = host_of(text, rest.substr(0, last));
    address.port = port_of(text, rest.substr(last + 1), 1);
    address.listen = address.port == kGroundPort ? kBoardPort : std::uint16_t{0};
  } else if (scheme == "tcp") {
    address.kind = Kind::kTcp;
    const bool has_host = last != std::string_view::npos;
    address.host = has_host ? host_of(text, rest.substr(0, last)) : "127.0.0.1";
    address.port = port_of(text, has_host ? rest.substr(last + 1) : rest, 0);
  } else {
    throw bad(text, "found '" + std::string{scheme} + "'");
  }
  return address;
}

}  // namespace rosflight::boards
