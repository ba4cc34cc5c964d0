// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/file_descriptor.hpp"
#include "firmware/boards/linux/linux_serial.hpp"

/// The other end of a serial port over a pty, UDP or TCP, on this machine, with bounded waits.
namespace rosflight::boards {

using Bytes = std::vector<std::uint8_t>;

/// Far longer than a loaded machine needs; a test that waits so long has failed.
inline constexpr int kTimeout_ms = 20'000;
/// Long enough for bytes that should not come.
inline constexpr int kSilence_ms = 50;

/// A folder that goes with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rosflight-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Value of a word "key=value" of where().
inline std::string word(const std::string& words, const std::string& key) {
  const std::size_t at = (" " + words).find(" " + key + "=");
  EXPECT_NE(at, std::string::npos) << key << " in " << words;
  const std::size_t first = at + key.size() + 1;
  return words.substr(first, words.find(' ', first) - first);
}

inline std::uint16_t port_in(const std::string& address) {
  return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

inline sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

inline base::FileDescriptor open_slave(const std::string& name) {
  return base::FileDescriptor{::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)};
}

inline base::FileDescriptor connect_tcp(std::uint16_t port) {
  base::FileDescriptor fd{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address = loopback(port);
  if (::connect(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) fd.close();
  if (fd.valid()) ::fcntl(fd.get(), F_SETFL, O_NONBLOCK);
  return fd;
}

/// Bound to a port of its own, not yet connected.
inline base::FileDescriptor bound_udp(std::uint16_t& port) {
  base::FileDescriptor fd{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  sockaddr_in address = loopback(0);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(fd.get(), generic, size), 0);
  EXPECT_EQ(::getsockname(fd.get(), generic, &size), 0);
  port = ntohs(address.sin_port);
  return fd;
}

/// One open serial port and its far end.
struct Pair {
  static Pair of(LinkAddress::Kind kind) {
    Pair pair;
    if (kind == LinkAddress::Kind::kUdp) {
      std::uint16_t port = 0;
      pair.far = bound_udp(port);
      pair.near = std::make_unique<LinuxSerial>(
          base::parse_board_link("udp:127.0.0.1:" + std::to_string(port)));
      sockaddr_in address = loopback(port_in(word(pair.near->where(), "listen")));
      EXPECT_EQ(::connect(pair.far.get(), reinterpret_cast<sockaddr*>(&address), sizeof address),
                0);
    } else if (kind == LinkAddress::Kind::kTcpServer) {
      pair.near = std::make_unique<LinuxSerial>(base::parse_board_link("tcp:0"));
      pair.far = connect_tcp(port_in(word(pair.near->where(), "link")));
    } else {
      pair.near = std::make_unique<LinuxSerial>(base::parse_board_link("pty"));
      pair.far = open_slave(word(pair.near->where(), "link").substr(std::string{"pty:"}.size()));
    }
    EXPECT_TRUE(pair.far.valid());
    pair.near->receive();
    return pair;
  }

  /// The far end sends; the board has received it all when this returns.
  void deliver(const Bytes& bytes) const {
    const std::uint64_t goal = near->counters().bytes_received + bytes.size();
    std::size_t sent = 0;
    while (near->counters().bytes_received < goal) {
      if (sent < bytes.size()) {
        const ssize_t n = ::write(far.get(), bytes.data() + sent, bytes.size() - sent);
        if (n > 0) sent += static_cast<std::size_t>(n);
      }
      ASSERT_TRUE(wait_near()) << "no bytes";
      near->receive();
    }
  }
  /// Everything queued goes out; what the far end got.
  Bytes sent(std::size_t expected) const {
    Bytes all;
    while (true) {
      near->transmit();
      const int timeout = all.size() < expected ? kTimeout_ms : kSilence_ms;
      pollfd set{far.get(), POLLIN, 0};
      if (::poll(&set, 1, timeout) <= 0) return all;
      Bytes buffer(65536);
      const ssize_t n = ::read(far.get(), buffer.data(), buffer.size());
      if (n <= 0) return all;
      all.insert(all.end(), buffer.begin(), buffer.begin() + n);
    }
  }
  /// Something for the board to do.
  bool wait_near(int timeout_ms = kTimeout_ms) const {
    std::vector<pollfd> set;
    near->add_to(set);
    return ::poll(set.data(), set.size(), timeout_ms) > 0;
  }

  std::unique_ptr<LinuxSerial> near;
  base::FileDescriptor far;
};

}  // namespace rosflight::boards
