// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/socket.hpp"

#include <array>
#include <cerrno>
#include <cstring>

namespace rosflight::boards {

Addresses look_up(const std::string& host, std::uint16_t port, int type) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = type;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (code != 0) {
    throw BoardError{"link: found host '" + host + "' (" + ::gai_strerror(code) +
                     "), allowed a name or address that can be found"};
  }
  return Addresses{list};
}

const addrinfo& preferred(const addrinfo& list) {
  for (const addrinfo* one = &list; one != nullptr; one = one->ai_next) {
    if (one->ai_family == AF_INET) return *one;
  }
  return list;
}

FileDescriptor bound_socket(const addrinfo& address, const std::string& link) {
  FileDescriptor socket{::socket(
      address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol)};
  if (!socket.valid()) throw BoardError{link + ": no socket: " + std::strerror(errno)};
  if (address.ai_socktype == SOCK_STREAM) {
    // Connections of a process that has ended do not block the port.
    const int on = 1;
    static_cast<void>(::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on));
  }
  const bool ok = ::bind(socket.get(), address.ai_addr, address.ai_addrlen) == 0 &&
                  (address.ai_socktype != SOCK_STREAM || ::listen(socket.get(), 1) == 0);
  if (!ok) {
    const std::string reason = std::strerror(errno);
    const std::string where = text_of(address.ai_addr, address.ai_addrlen);
    throw BoardError{link + " " + where + ": found '" + reason + "', allowed a free port"};
  }
  return socket;
}

std::string text_of(const sockaddr* address, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(address, size, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return "an unknown address";
  }
  const std::string name = host.data();
  const bool v6 = name.find(':') != std::string::npos;
  return (v6 ? "[" + name + "]" : name) + ":" + port.data();
}

std::string own_address(const FileDescriptor& socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (::getsockname(socket.get(), generic, &size) != 0) return "an unknown address";
  return text_of(generic, size);
}

}  // namespace rosflight::boards
