// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

namespace rosflight::web::server {

/// A connection whose requests are written byte for byte as a test wants them.
class Client {
 public:
  /// @throws std::system_error  nobody listens there.
  explicit Client(std::uint16_t port, std::uint32_t address = INADDR_LOOPBACK)
      : socket_{::socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(port);
    there.sin_addr.s_addr = htonl(address);
    sockaddr generic{};
    static_assert(sizeof generic == sizeof there);
    std::memcpy(&generic, &there, sizeof there);
    if (::connect(socket_, &generic, sizeof generic) == 0) return;
    const int error = errno;
    ::close(socket_);
    throw std::system_error(error, std::generic_category());
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void write(const std::string& text) const {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  /// What the server sends, at least so many bytes unless it closes the connection before.
  std::string read_some(std::size_t least) const {
    return read_until([least](const std::string& all) { return all.size() >= least; });
  }
  /// What the server sends up to and with this text.
  std::string read_to(const std::string& text) const {
    return read_until(
        [&text](const std::string& all) { return all.find(text) != std::string::npos; });
  }
  /// What has come and was not read.
  std::string read_waiting() const {
    std::string all;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0;)
      all.append(buffer.data(), static_cast<std::size_t>(n));
    return all;
  }
  /// The head of an answer, and no byte of what follows.
  std::string read_head() const {
    std::string head;
    for (char c = 0; !head.ends_with("\r\n\r\n") && ::recv(socket_, &c, 1, 0) == 1;) head += c;
    return head;
  }
  /// All that the server sends until it closes the connection.
  std::string read() const {
    return read_until([](const std::string&) { return false; });
  }

 private:
  template <class Enough>
  std::string read_until(Enough enough) const {
    std::string all;
    std::array<char, 4096> buffer{};
    while (!enough(all)) {
      const ssize_t n = ::recv(socket_, buffer.data(), buffer.size(), 0);
      if (n <= 0) break;
      all.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return all;
  }

  int socket_;
};

}  // namespace rosflight::web::server
