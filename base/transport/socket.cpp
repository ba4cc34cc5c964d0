// SPDX-License-Identifier: BSD-3-Clause
#include "base/transport/socket.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace rosflight::base {

SocketAddress look_up(const std::string& host, std::uint16_t port, int type) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = type;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (code != 0 || list == nullptr) throw LinkError(::gai_strerror(code));
  const addrinfo* chosen = list;
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    if (one->ai_family == AF_INET) {
      chosen = one;
      break;
    }
  }
  SocketAddress address;
  std::memcpy(&address.storage, chosen->ai_addr, chosen->ai_addrlen);
  address.size = chosen->ai_addrlen;
  ::freeaddrinfo(list);
  return address;
}

SocketAddress any_address(int family, std::uint16_t port) {
  SocketAddress address;
  address.storage.ss_family = static_cast<sa_family_t>(family);
  address.size = family == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  // Zero is "any" in both families, and the port stands at the same place.
  static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
  reinterpret_cast<sockaddr_in&>(address.storage).sin_port = htons(port);  // NOLINT
  return address;
}

SocketAddress own_side(const SocketAddress& far_end, std::uint16_t port) {
  const auto& v4 = reinterpret_cast<const sockaddr_in&>(far_end.storage);   // NOLINT
  const auto& v6 = reinterpret_cast<const sockaddr_in6&>(far_end.storage);  // NOLINT
  constexpr std::uint32_t kLoopbackNet = 127;
  const bool loopback = far_end.family() == AF_INET6
                            ? IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr)
                            : ntohl(v4.sin_addr.s_addr) >> 24U == kLoopbackNet;
  if (!loopback) return any_address(far_end.family(), port);
  SocketAddress own = far_end;
  reinterpret_cast<sockaddr_in&>(own.storage).sin_port = htons(port);  // NOLINT
  return own;
}

FileDescriptor new_socket(int family, int type) {
  return FileDescriptor{::socket(family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
}

bool bind_socket(const FileDescriptor& socket, const SocketAddress& address, int type) {
  if (type == SOCK_STREAM) set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1);
  return ::bind(socket.get(), address.get(), address.size) == 0 &&
         (type != SOCK_STREAM || ::listen(socket.get(), 1) == 0);
}

void set_option(const FileDescriptor& socket, int level, int option, int value) {
  static_cast<void>(::setsockopt(socket.get(), level, option, &value, sizeof value));
}

FileDescriptor accept_client(const FileDescriptor& listener) {
  FileDescriptor client{::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
  if (client.valid()) set_option(client, IPPROTO_TCP, TCP_NODELAY, 1);
  return client;
}

bool would_block(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

std::string SocketAddress::text() const {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(get(), size, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return "an unknown address";
  }
  const std::string name = host.data();
  const bool v6 = name.find(':') != std::string::npos;
  return (v6 ? "[" + name + "]" : name) + ":" + port.data();
}

SocketAddress own_address(const FileDescriptor& socket) {
  SocketAddress address;
  if (::getsockname(socket.get(), address.get(), &address.size) != 0) return {};
  return address;
}

}  // namespace rosflight::base
