// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "base/transport/socket.hpp"

namespace rosflight::boards {

/// Host and port of a link. `type` is SOCK_DGRAM or SOCK_STREAM. @throws LinuxError  unknown host.
base::SocketAddress look_up(const base::LinkAddress& link, int type);

/// A socket that never blocks, bound to an address; `link` names it in an error.
/// @throws LinuxError  taken, or not of this machine.
base::FileDescriptor bound_socket(const base::SocketAddress& address, int type,
                                  const std::string& link);

}  // namespace rosflight::boards
