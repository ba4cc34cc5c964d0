// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/socket.hpp"

#include <cerrno>
#include <cstring>

#include "firmware/boards/linux/linux_error.hpp"

namespace rosflight::boards {

base::SocketAddress look_up(const base::LinkAddress& link, int type) {
  try {
    return base::look_up(link.host, link.port, type);
  } catch (const base::LinkError& error) {
    throw LinuxError{"link: found host '" + link.host + "' (" + error.what() +
                     "), allowed a name or address that can be found"};
  }
}

base::FileDescriptor bound_socket(const base::SocketAddress& address, int type,
                                  const std::string& link) {
  base::FileDescriptor socket = base::new_socket(address.family(), type);
  if (!socket.valid()) throw LinuxError{link + ": no socket: " + std::strerror(errno)};
  if (!base::bind_socket(socket, address, type)) {
    const std::string reason = std::strerror(errno);
    throw LinuxError{link + " " + address.text() + ": found '" + reason + "', allowed a free port"};
  }
  return socket;
}

}  // namespace rosflight::boards
