// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <netdb.h>
#include <sys/socket.h>

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/boards/linux/board_error.hpp"
#include "firmware/boards/linux/file_descriptor.hpp"

/// What the two kinds of sockets share.
namespace rosflight::boards {

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

/// Looks a host up; may ask a name server. `type` is SOCK_DGRAM or SOCK_STREAM.
/// @throws BoardError  unknown host.
Addresses look_up(const std::string& host, std::uint16_t port, int type);

/// The first IPv4 address of a list, or its first: what most tools take for "localhost".
const addrinfo& preferred(const addrinfo& list);

/// A non-blocking socket bound to an address. @throws BoardError  taken, or not of this machine.
FileDescriptor bound_socket(const addrinfo& address, const std::string& link);

/// "127.0.0.1:14520", "[::1]:14520".
std::string text_of(const sockaddr* address, socklen_t size);
/// The same of a bound socket.
std::string own_address(const FileDescriptor& socket);

}  // namespace rosflight::boards
