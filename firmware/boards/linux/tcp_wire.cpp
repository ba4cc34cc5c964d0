// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <cstring>

#include "firmware/boards/linux/socket.hpp"
#include "firmware/boards/linux/wire.hpp"

namespace rosflight::boards {
namespace {

/// A server with one client at a time; another one waits until it has left. Sending it away would
/// be clearer, but a client that reconnects may well arrive before its own farewell.
class TcpWire final : public Wire {
 public:
  explicit TcpWire(const LinkAddress& address) {
    listener_ = bound_socket(look_up(address, SOCK_STREAM), SOCK_STREAM, "link tcp");
    where_ = "link=tcp:" + base::own_address(listener_).text();
  }

  bool refresh() override {
    if (client_.valid() && gone()) hang_up();
    if (client_.valid()) return true;
    client_ = base::accept_client(listener_);
    return client_.valid();
  }
  std::uint32_t peer() const override { return peer_; }

  std::size_t receive(std::uint8_t* data, std::size_t capacity) override {
    if (!client_.valid()) return 0;
    const ssize_t n = ::recv(client_.get(), data, capacity, 0);
    if (n > 0) return static_cast<std::size_t>(n);
    if (n == 0 || !base::would_block(errno)) hang_up();
    return 0;
  }
  std::size_t send(const std::uint8_t* data, std::size_t size) override {
    if (!client_.valid()) return size;
    const ssize_t n = ::send(client_.get(), data, size, MSG_NOSIGNAL);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (base::would_block(errno)) return 0;
    hang_up();
    return size;
  }
  void add_to(std::vector<pollfd>& set, bool sending) const override {
    if (client_.valid()) {
      set.push_back({client_.get(), static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0});
    } else {
      set.push_back({listener_.get(), POLLIN, 0});
    }
  }
  std::string where() const override { return where_; }

 private:
  /// The client has closed, and there is nothing left to read.
  bool gone() const {
    std::uint8_t byte = 0;
    const ssize_t n = ::recv(client_.get(), &byte, 1, MSG_PEEK);
    return n == 0 || (n < 0 && !base::would_block(errno));
  }
  void hang_up() {
    client_.close();
    ++peer_;
  }

  base::FileDescriptor listener_;
  base::FileDescriptor client_;
  std::string where_;
  std::uint32_t peer_{0};
};

}  // namespace

std::unique_ptr<Wire> open_tcp(const LinkAddress& address) {
  return std::make_unique<TcpWire>(address);
}

}  // namespace rosflight::boards
