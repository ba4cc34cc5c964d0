// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace rosflight_sim {

/// At most one plugin for a link, whatever library it is in: an address in Linux's abstract name space, free again when this
/// object ends.
class BodyClaim {
 public:
  /// @param world, link  identify the link in this process. @throws std::runtime_error  one line.
  BodyClaim(const void* world, std::uint64_t link, const std::string& name)
      : socket_{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
    const std::string text = "rosflight_gazebo/" + std::to_string(::getpid()) + "/" +
                             std::to_string(reinterpret_cast<std::uintptr_t>(world)) + "/" +
                             std::to_string(link);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, text.data(), text.size());  // a leading 0: abstract
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) return;
    ::close(socket_);
    throw std::runtime_error("found another plugin of ours on " + name + ", allowed one");
  }
  ~BodyClaim() { ::close(socket_); }
  BodyClaim(const BodyClaim&) = delete;
  BodyClaim& operator=(const BodyClaim&) = delete;

 private:
  int socket_;
};

}  // namespace rosflight_sim
