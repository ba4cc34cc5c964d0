// SPDX-License-Identifier: BSD-3-Clause
// UDP and TCP.
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "base/transport/socket.hpp"
#include "companion/asio/endpoint.hpp"

namespace rosflight::companion {

namespace {

using Result = Endpoint::Result;

constexpr int kReceiveBytes = 1 << 20;  // some seconds of all streams

Endpoint::Opened failure(const std::string& what, int error) {
  if (error == EADDRINUSE) {
    return {Result::kNotPossible, {}, what + " is in use by another program"};
  }
  const bool final =
      error == EACCES || error == EPERM || error == EAFNOSUPPORT || error == EADDRNOTAVAIL;
  return {final ? Result::kNotPossible : Result::kNotNow, {}, what + ": " + std::strerror(error)};
}

/// Throws LinkError.
base::SocketAddress look_up(const LinkSpec& spec, int type) {
  try {
    return base::look_up(spec.host, spec.port, type);
  } catch (const LinkError& error) {
    throw LinkError("link \"" + spec.text() + "\": host " + spec.host + ": " + error.what());
  }
}

class UdpEndpoint final : public Endpoint {
 public:
  explicit UdpEndpoint(const LinkSpec& spec)
      : peer_(look_up(spec, SOCK_DGRAM)),
        local_port_(spec.local_port),
        name_("udp " + spec.host + ":" + std::to_string(spec.port)) {}

  Opened open() override {
    FileDescriptor fd = base::new_socket(peer_.family(), SOCK_DGRAM);
    if (!fd.valid()) {
      return failure("socket", errno);
    }
    base::set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
    if (!base::bind_socket(fd, base::any_address(peer_.family(), local_port_), SOCK_DGRAM)) {
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
  base::SocketAddress peer_;
  std::uint16_t local_port_;
  std::string name_;
};

/// Bound; the first datagram names the peer.
class UdpServerEndpoint final : public Endpoint {
 public:
  explicit UdpServerEndpoint(const LinkSpec& spec)
      : port_(spec.port), name_("udp port " + std::to_string(spec.port)) {}

  Opened open() override {
    FileDescriptor fd = base::new_socket(AF_INET, SOCK_DGRAM);
    if (!fd.valid()) {
      return failure("socket", errno);
    }
    base::set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
    if (!base::bind_socket(fd, base::any_address(AF_INET, port_), SOCK_DGRAM)) {
      return failure("port " + std::to_string(port_), errno);
    }
    return {Result::kWaitRead, std::move(fd), {}};
  }

  Opened finish(FileDescriptor waited) override {
    base::SocketAddress peer;
    char byte = 0;
    const ssize_t size = ::recvfrom(waited.get(), &byte, 1, MSG_PEEK, peer.get(), &peer.size);
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
    FileDescriptor fd = base::new_socket(peer_.family(), SOCK_STREAM);
    if (!fd.valid()) {
      return failure("socket", errno);
    }
    if (::connect(fd.get(), peer_.get(), peer_.size) == 0 || errno == EINPROGRESS) {
      return {Result::kWaitWrite, std::move(fd), {}};
    }
    return failure("cannot connect", errno);
  }

  Opened finish(FileDescriptor waited) override {
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(waited.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0) {
      return failure("cannot connect", error);
    }
    base::set_option(waited, IPPROTO_TCP, TCP_NODELAY, 1);
    return {Result::kOpen, std::move(waited), {}};
  }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  base::SocketAddress peer_;
  std::string name_;
};

class TcpServerEndpoint final : public Endpoint {
 public:
  explicit TcpServerEndpoint(const LinkSpec& spec)
      : port_(spec.port), name_("tcp port " + std::to_string(spec.port)) {}

  Opened open() override {
    if (!listener_.valid()) {
      FileDescriptor fd = base::new_socket(AF_INET, SOCK_STREAM);
      if (!fd.valid() || !base::bind_socket(fd, base::any_address(AF_INET, port_), SOCK_STREAM)) {
        return failure("port " + std::to_string(port_), errno);
      }
      listener_ = std::move(fd);
    }
    return {Result::kWaitRead, FileDescriptor(::fcntl(listener_.get(), F_DUPFD_CLOEXEC, 0)), {}};
  }

  Opened finish(FileDescriptor waited) override {
    FileDescriptor peer = base::accept_client(waited);
    if (!peer.valid()) {
      return {Result::kNotNow, {}, std::string("no peer: ") + std::strerror(errno)};
    }
    return {Result::kOpen, std::move(peer), {}};
  }
  bool is_socket() const override { return true; }
  std::string name() const override { return name_; }

 private:
  std::uint16_t port_;
  std::string name_;
  FileDescriptor listener_;
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
