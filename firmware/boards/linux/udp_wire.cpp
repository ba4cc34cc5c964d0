// SPDX-License-Identifier: BSD-3-Clause
#include <netinet/in.h>

#include <cerrno>
#include <cstring>

#include "firmware/boards/linux/socket.hpp"
#include "firmware/boards/linux/wire.hpp"

namespace rosflight::boards {
namespace {

/// The address this machine listens on for a far end: loopback for loopback, otherwise any.
sockaddr_storage own_side(const addrinfo& far, std::uint16_t port) {
  sockaddr_storage own{};
  std::memcpy(&own, far.ai_addr, far.ai_addrlen);
  if (far.ai_family == AF_INET6) {
    auto& v6 = reinterpret_cast<sockaddr_in6&>(own);
    v6.sin6_port = htons(port);
    if (!IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr)) v6.sin6_addr = in6addr_any;
  } else {
    auto& v4 = reinterpret_cast<sockaddr_in&>(own);
    v4.sin_port = htons(port);
    constexpr std::uint32_t kLoopbackNet = 127;
    if (ntohl(v4.sin_addr.s_addr) >> 24U != kLoopbackNet) v4.sin_addr.s_addr = htonl(INADDR_ANY);
  }
  return own;
}

/// Datagrams. Whoever sends to the own port is heard; answers go to one address.
class UdpWire final : public Wire {
 public:
  explicit UdpWire(const LinkAddress& address)
      : list_{look_up(address.host, address.port, SOCK_DGRAM)}, far_{preferred(*list_)} {
    sockaddr_storage own = own_side(far_, address.listen);
    addrinfo bind_to = far_;
    bind_to.ai_addr = reinterpret_cast<sockaddr*>(&own);
    socket_ = bound_socket(bind_to, "link udp");
    const int on = 1;  // for a far end that is a whole network
    static_cast<void>(::setsockopt(socket_.get(), SOL_SOCKET, SO_BROADCAST, &on, sizeof on));
  }

  bool refresh() override { return true; }
  std::uint32_t peer() const override { return 0; }
  std::size_t receive(std::uint8_t* data, std::size_t capacity) override {
    const ssize_t n = ::recv(socket_.get(), data, capacity, 0);
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  std::size_t send(const std::uint8_t* data, std::size_t size) override {
    const ssize_t n =
        ::sendto(socket_.get(), data, size, MSG_NOSIGNAL, far_.ai_addr, far_.ai_addrlen);
    // Whatever else goes wrong (no route, no listener) loses the datagram, as a network does.
    return n < 0 && (errno == EAGAIN || errno == ENOBUFS) ? 0 : size;
  }
  void add_to(std::vector<pollfd>& set, bool sending) const override {
    set.push_back({socket_.get(), static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0});
  }
  std::string where() const override {
    return "link=udp:" + text_of(far_.ai_addr, far_.ai_addrlen) + " listen=" + own_address(socket_);
  }

 private:
  Addresses list_;
  const addrinfo& far_;
  FileDescriptor socket_;
};

}  // namespace

std::unique_ptr<Wire> open_udp(const LinkAddress& address) {
  return std::make_unique<UdpWire>(address);
}

}  // namespace rosflight::boards
