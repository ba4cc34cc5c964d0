// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/socket.h>

#include <string>

#include "base/file_descriptor.hpp"
#include "base/transport/link_address.hpp"

/// UDP and TCP sockets that never block. `type` is SOCK_DGRAM or SOCK_STREAM.
namespace rosflight::base {

struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size{sizeof(sockaddr_storage)};

  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }                    // NOLINT
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }  // NOLINT
  int family() const { return storage.ss_family; }
  /// "127.0.0.1:14520", "[::1]:14520".
  std::string text() const;
};

/// Looks up a host; may ask a name server. Prefers IPv4, which most programs mean by "localhost".
/// @throws LinkError  unknown host; the text is the reason alone, the caller adds the link.
SocketAddress look_up(const std::string& host, std::uint16_t port, int type);

/// Every address of this machine.
SocketAddress any_address(int family, std::uint16_t port);
/// Where this machine receives from a far end: on loopback for loopback, otherwise on every address.
SocketAddress own_side(const SocketAddress& far_end, std::uint16_t port);
/// What a socket is bound to.
SocketAddress own_address(const FileDescriptor& socket);

/// Not valid() with errno set if there can be none.
FileDescriptor new_socket(int family, int type);
/// Binds and, for TCP, listens for one client; connections of a process that has ended do not block
/// the port. @returns false with errno set if the address is taken or not of this machine.
bool bind_socket(const FileDescriptor& socket, const SocketAddress& address, int type);

void set_option(const FileDescriptor& socket, int level, int option, int value);
/// The next client of a listening socket, without delay of small packets. Not valid() if none waits.
FileDescriptor accept_client(const FileDescriptor& listener);
/// An error that goes away by itself: nothing waits, no room, interrupted.
bool would_block(int error);

}  // namespace rosflight::base
