// SPDX-License-Identifier: BSD-3-Clause
// UDP and TCP.
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "companion/asio/endpoint.hpp"

namespace rosflight::companion {

namespace {

using Result = Endpoint::Result;

constexpr int kReceiveBytes = 1 << 20;  // some seconds of all streams

struct Address {
  sockaddr_storage storage{};
  socklen_t size{};

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }  // NOLINT
  int family() const { return storage.ss_family; }
};

/// Throws LinkError.
Address look_up(const LinkSpec& spec, int socket_type) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = socket_type;
  addrinfo* found = nullptr;
  const int error =
      ::getaddrinfo(spec.host.c_str(), std::to_string(spec.port).c_str(), &hints, &found);
  if (error != 0 || found == nullptr) {
    throw LinkError("link \"" + spec.text() + "\": host " + spec.host + ": " +
                    ::gai_strerror(error));
  }
  // "localhost" may be ::1 first; a peer that binds IPv4, as most do, would not hear us.
  const addrinfo* chosen = found;
  for (const addrinfo* a = found; a != nullptr; a = a->ai_next) {
    if (a->ai_family == AF_INET) {
      chosen = a;
      break;
    }
  }
  Address address;
  std::memcpy(&address.storage, chosen->ai_addr, chosen->ai_addrlen);
  address.size = chosen->ai_addrlen;
  ::freeaddrinfo(found);
  return address;
}

Address any_address(int family, std::uint16_t port) {
  Address address;
  if (family == AF_INET6) {
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_addr = in6addr_any;
    v6.sin6_port = htons(port);
    std::memcpy(&address.storage, &v6, sizeof v6);
    address.size = sizeof v6;
  } else {
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_addr.s_addr = htonl(INADDR_ANY);
    v4.sin_port = htons(port);
    std::memcpy(&address.storage, &v4, sizeof v4);
    address.size = sizeof v4;
  }
  return address;
}

Endpoint::Opened failure(const std::string& what, int error) {
  if (error == EADDRINUSE) {
    return {Result::kNotPossible, {}, what + " is in use by another program"};
  }
  const bool final =
      error == EACCES || error == EPERM || error == EAFNOSUPPORT || error == EADDRNOTAVAIL;
  return {final ? Result::kNotPossible : Result::kNotNow, {}, what + ": " + std::strerror(error)};
}

Descriptor new_socket(int family, int type) {
  return Descriptor(::socket(family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

void set_option(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

class UdpEndpoint final : public Endpoint {
 public:
  explicit UdpEndpoint(const LinkSpec& spec)
      : peer_(look_up(spec, SOCK_DGRAM)),
        local_port_(spec.local_port),
        name_("udp " + spec.host + ":" + std::to_string(spec.port)) {}

  Opened open() override {
    Descriptor fd = new_socket(peer_.family(), SOCK_DGRAM);
    if (!fd) {
      return failure("socket", errno);
    }
    set_option(fd.get(), SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
    const Address local = any_address(peer_.family(), local_port_);
    if (::bind(fd.get(), local.get(), local.size) != 0) {
      return failure("local port " + std::to_string(local_port_), errno);
    }
    // Connected: the kernel passes only what comes from this peer.
    if (::connect(fd.get(), peer_.get(), peer_.size) != 0) {
      return failure("peer", errno);
    }
    return {Result::kOpen, std::move(fd), {}};
  }
  bool datagrams() const override { return true; }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  Address peer_;
  std::uint16_t local_port_;
  std::string name_;
};

/// Bound; the first datagram names the peer.
class UdpServerEndpoint final : public Endpoint {
 public:
  explicit UdpServerEndpoint(const LinkSpec& spec)
      : port_(spec.port), name_("udp port " + std::to_string(spec.port)) {}

  Opened open() override {
    Descriptor fd = new_socket(AF_INET, SOCK_DGRAM);
    if (!fd) {
      return failure("socket", errno);
    }
    set_option(fd.get(), SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
    const Address local = any_address(AF_INET, port_);
    if (::bind(fd.get(), local.get(), local.size) != 0) {
      return failure("port " + std::to_string(port_), errno);
    }
    return {Result::kWaitRead, std::move(fd), {}};
  }

  Opened finish(Descriptor waited) override {
    Address peer;
    peer.size = sizeof peer.storage;
    char byte = 0;
    auto* const address = reinterpret_cast<sockaddr*>(&peer.storage);  // NOLINT
    const ssize_t size = ::recvfrom(waited.get(), &byte, 1, MSG_PEEK, address, &peer.size);
    if (size < 0 || ::connect(waited.get(), peer.get(), peer.size) != 0) {
      return failure("peer", errno);
    }
    return {Result::kOpen, std::move(waited), {}};
  }
  bool datagrams() const override { return true; }
  bool yields_after_silence() const override { return true; }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  std::uint16_t port_;
  std::string name_;
};

class TcpClientEndpoint final : public Endpoint {
 public:
  explicit TcpClientEndpoint(const LinkSpec& spec)
      : peer_(look_up(spec, SOCK_STREAM)),
        name_("tcp " + spec.host + ":" + std::to_string(spec.port)) {}

  Opened open() override {
    Descriptor fd = new_socket(peer_.family(), SOCK_STREAM);
    if (!fd) {
      return failure("socket", errno);
    }
    if (::connect(fd.get(), peer_.get(), peer_.size) == 0 || errno == EINPROGRESS) {
      return {Result::kWaitWrite, std::move(fd), {}};
    }
    return failure("cannot connect", errno);
  }

  Opened finish(Descriptor waited) override {
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(waited.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0) {
      return failure("cannot connect", error);
    }
    set_option(waited.get(), IPPROTO_TCP, TCP_NODELAY, 1);
    return {Result::kOpen, std::move(waited), {}};
  }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  Address peer_;
  std::string name_;
};

class TcpServerEndpoint final : public Endpoint {
 public:
  explicit TcpServerEndpoint(const LinkSpec& spec)
      : port_(spec.port), name_("tcp port " + std::to_string(spec.port)) {}

  Opened open() override {
    if (!listener_) {
      Descriptor fd = new_socket(AF_INET, SOCK_STREAM);
      set_option(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1);
      const Address local = any_address(AF_INET, port_);
      if (!fd || ::bind(fd.get(), local.get(), local.size) != 0 || ::listen(fd.get(), 1) != 0) {
        return failure("port " + std::to_string(port_), errno);
      }
      listener_ = std::move(fd);
    }
    return {Result::kWaitRead, Descriptor(::fcntl(listener_.get(), F_DUPFD_CLOEXEC, 0)), {}};
  }

  Opened finish(Descriptor waited) override {
    Descriptor peer(::accept4(waited.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!peer) {
      return {Result::kNotNow, {}, std::string("no peer: ") + std::strerror(errno)};
    }
    set_option(peer.get(), IPPROTO_TCP, TCP_NODELAY, 1);
    return {Result::kOpen, std::move(peer), {}};
  }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  std::uint16_t port_;
  std::string name_;
  Descriptor listener_;
};

}  // namespace

std::unique_ptr<Endpoint> make_udp_endpoint(const LinkSpec& spec) {
  return std::make_unique<UdpEndpoint>(spec);
}
std::unique_ptr<Endpoint> make_udp_server_endpoint(const LinkSpec& spec) {
  return std::make_unique<UdpServerEndpoint>(spec);
}
std::unique_ptr<Endpoint> make_tcp_client_endpoint(const LinkSpec& spec) {
  return std::make_unique<TcpClientEndpoint>(spec);
}
std::unique_ptr<Endpoint> make_tcp_server_endpoint(const LinkSpec& spec) {
  return std::make_unique<TcpServerEndpoint>(spec);
}

}  // namespace rosflight::companion
