// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>

namespace rosflight_sim {

/// At most one simulator of a namespace in a ROS domain on this machine: two would answer each other's topics.
///
/// Held as a listening socket in Linux's abstract name space, so it is free again however the process ends, and nothing is left in
/// the file system. Another machine in the same domain is not seen.
class OnlyOne {
 public:
  /// @param name_space  of the node, as "/" or "/alpha".
  /// @throws std::runtime_error  one line with the process that was first.
  explicit OnlyOne(const std::string& name_space) : socket_{open()} {
    const char* const domain = std::getenv("ROS_DOMAIN_ID");
    const std::string where = std::string(domain == nullptr || *domain == '\0' ? "0" : domain);
    const Address address = Address::of("rosflight_sim/" + where + name_space);
    const auto* const generic = reinterpret_cast<const sockaddr*>(&address.name);
    if (::bind(socket_, generic, address.size) == 0) {
      static_cast<void>(::listen(socket_, 1));
      return;
    }
    const int error = errno;
    ::close(socket_);
    if (error != EADDRINUSE) throw std::system_error(error, std::generic_category(), "simulator");
    throw std::runtime_error("found another simulator in ROS domain " + where + ", namespace " +
                             name_space + owner(address) +
                             ", allowed one: end it, or choose another ROS_DOMAIN_ID or namespace");
  }
  ~OnlyOne() { ::close(socket_); }
  OnlyOne(const OnlyOne&) = delete;
  OnlyOne& operator=(const OnlyOne&) = delete;

 private:
  struct Address {
    sockaddr_un name{};
    socklen_t size{};

    static Address of(std::string text) {
      Address address;
      constexpr std::size_t kRoom = sizeof address.name.sun_path - 1;
      if (text.size() > kRoom)
        text = text.substr(0, kRoom / 2) + std::to_string(std::hash<std::string>{}(text));
      address.name.sun_family = AF_UNIX;
      std::memcpy(address.name.sun_path + 1, text.data(), text.size());  // a leading 0: abstract
      address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
      return address;
    }
  };

  static int open() {
    const int made = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (made < 0) throw std::system_error(errno, std::generic_category(), "simulator");
    return made;
  }

  /// " (process 123)" of who listens there; empty if it does not say.
  static std::string owner(const Address& address) {
    const int asking = open();
    ucred who{};
    socklen_t size = sizeof who;
    const bool known =
        ::connect(asking, reinterpret_cast<const sockaddr*>(&address.name), address.size) == 0 &&
        ::getsockopt(asking, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0;
    ::close(asking);
    return known ? " (process " + std::to_string(who.pid) + ")" : "";
  }

  int socket_;
};

}  // namespace rosflight_sim
