// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <cstring>

#include "firmware/boards/linux/socket.hpp"
#include "firmware/boards/linux/wire.hpp"

namespace rosflight::boards {
namespace {

/// Datagrams. They are received from every address and sent to one.
class UdpWire final : public Wire {
 public:
  explicit UdpWire(const LinkAddress& address) : far_{look_up(address, SOCK_DGRAM)} {
    socket_ = bound_socket(base::own_side(far_, address.local_port), SOCK_DGRAM, "link udp");
    base::set_option(socket_, SOL_SOCKET, SO_BROADCAST, 1);  // for a far end that is a network
  }

  bool refresh() override { return true; }
  std::uint32_t peer() const override { return 0; }
  std::size_t receive(std::uint8_t* data, std::size_t capacity) override {
    const ssize_t n = ::recv(socket_.get(), data, capacity, 0);
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  std::size_t send(const std::uint8_t* data, std::size_t size) override {
    const ssize_t n = ::sendto(socket_.get(), data, size, MSG_NOSIGNAL, far_.get(), far_.size);
    // Whatever else goes wrong (no route, no listener) loses the datagram, as a network does.
    return n < 0 && (errno == EAGAIN || errno == ENOBUFS) ? 0 : size;
  }
  void add_to(std::vector<pollfd>& set, bool sending) const override {
    set.push_back({socket_.get(), static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0});
  }
  std::string where() const override {
    return "link=udp:" + far_.text() + " listen=" + base::own_address(socket_).text();
  }

 private:
  base::SocketAddress far_;
  base::FileDescriptor socket_;
};

}  // namespace

std::unique_ptr<Wire> open_udp(const LinkAddress& address) {
  return std::make_unique<UdpWire>(address);
}

}  // namespace rosflight::boards
