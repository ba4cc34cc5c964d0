// SPDX-License-Identifier: BSD-3-Clause
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <cerrno>

#include "firmware/boards/linux/socket.hpp"
#include "firmware/boards/linux/wire.hpp"

namespace rosflight::boards {
namespace {

/// A server with one client at a time; another one waits until it has left. Sending it away would
/// be clearer, but a client that reconnects may well arrive before its own farewell.
class TcpWire final : public Wire {
 public:
  explicit TcpWire(const LinkAddress& address) {
    const Addresses list = look_up(address.host, address.port, SOCK_STREAM);
    listener_ = bound_socket(preferred(*list), "link tcp");
    where_ = "link=tcp:" + own_address(listener_);
  }

  bool refresh() override {
    if (client_.valid() && gone()) hang_up();
    if (client_.valid()) return true;
    client_ =
        FileDescriptor{::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
    if (!client_.valid()) return false;
    const int on = 1;
    static_cast<void>(::setsockopt(client_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
    return true;
  }
  std::uint32_t peer() const override { return peer_; }

  std::size_t receive(std::uint8_t* data, std::size_t capacity) override {
    if (!client_.valid()) return 0;
    const ssize_t n = ::recv(client_.get(), data, capacity, 0);
    if (n > 0) return static_cast<std::size_t>(n);
    if (n == 0 || (errno != EAGAIN && errno != EINTR)) hang_up();
    return 0;
  }
  std::size_t send(const std::uint8_t* data, std::size_t size) override {
    if (!client_.valid()) return size;
    const ssize_t n = ::send(client_.get(), data, size, MSG_NOSIGNAL);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno == EAGAIN || errno == EINTR) return 0;
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
    return n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
  }
  void hang_up() {
    client_.close();
    ++peer_;
  }

  FileDescriptor listener_;
  FileDescriptor client_;
  std::string where_;
  std::uint32_t peer_{0};
};

}  // namespace

std::unique_ptr<Wire> open_tcp(const LinkAddress& address) {
  return std::make_unique<TcpWire>(address);
}

}  // namespace rosflight::boards
