// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <utility>

#include "companion/link_spec.hpp"

namespace rosflight::companion {

/// Owns a POSIX descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { reset(); }

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  int release() { return std::exchange(fd_, -1); }
  void reset();

 private:
  int fd_{-1};
};

/// Knows how to open one kind of link. Never blocks, apart from the look-up of a host name when
/// made.
class Endpoint {
 public:
  enum class Result : std::uint8_t {
    kOpen,        ///< `descriptor` carries bytes.
    kWaitRead,    ///< Call finish() when `descriptor` is readable.
    kWaitWrite,   ///< Call finish() when it is writable.
    kNotNow,      ///< Try again later: no device, nobody listening.
    kNotPossible  ///< Would fail again: taken, forbidden, no serial port. Only the first time a
                  ///< reason to stop.
  };
  struct Opened {
    Result result{Result::kNotNow};
    Descriptor descriptor;
    std::string reason;  ///< In case of failure.
  };

  virtual ~Endpoint() = default;
  virtual Opened open() = 0;
  virtual Opened finish(Descriptor waited);
  /// Each write is a datagram; an empty read or a refusal by the peer is no end.
  virtual bool datagrams() const { return false; }
  /// Closed and opened again after 2 s without a byte: another peer may be there.
  virtual bool yields_after_silence() const { return false; }
  virtual bool is_socket() const { return false; }
  /// How people know it, for messages: "/dev/ttyACM0", "pty /dev/pts/3", "udp localhost:14525".
  virtual std::string name() const = 0;
};

/// Throws LinkError if a host is unknown.
std::unique_ptr<Endpoint> make_endpoint(const LinkSpec& spec);

// The parts of make_endpoint(), for its implementation.
std::unique_ptr<Endpoint> make_serial_endpoint(const LinkSpec& spec);
std::unique_ptr<Endpoint> make_pty_endpoint();
std::unique_ptr<Endpoint> make_udp_endpoint(const LinkSpec& spec);
std::unique_ptr<Endpoint> make_udp_server_endpoint(const LinkSpec& spec);
std::unique_ptr<Endpoint> make_tcp_client_endpoint(const LinkSpec& spec);
std::unique_ptr<Endpoint> make_tcp_server_endpoint(const LinkSpec& spec);

}  // namespace rosflight::companion
