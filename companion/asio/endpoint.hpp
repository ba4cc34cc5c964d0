// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>

#include "base/file_descriptor.hpp"
#include "base/transport/link_address.hpp"

namespace rosflight::companion {

using base::FileDescriptor;
using base::LinkError;
using base::parse_link;
/// Which link to open.
using LinkSpec = base::LinkAddress;

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
    FileDescriptor descriptor;
    std::string reason;  ///< In case of failure.
  };

  virtual ~Endpoint() = default;
  /// Starts to open the link, without blocking. A failure is a Result with its reason, never an
  /// exception.
  virtual Opened open() = 0;
  /// Goes on with the descriptor of kWaitRead (accepts a peer) or kWaitWrite (a connection that has
  /// succeeded or failed). The default takes the descriptor as open.
  virtual Opened finish(FileDescriptor waited);
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
/// A new pseudo terminal; name() gives the path of its other end.
std::unique_ptr<Endpoint> make_pty_endpoint();
/// Sends to a host and port and receives from it. Throws LinkError if the host is unknown.
std::unique_ptr<Endpoint> make_udp_endpoint(const LinkSpec& spec);
/// Binds a port and serves the first peer that sends a datagram.
std::unique_ptr<Endpoint> make_udp_server_endpoint(const LinkSpec& spec);
/// Connects to a server. Throws LinkError if the host is unknown.
std::unique_ptr<Endpoint> make_tcp_client_endpoint(const LinkSpec& spec);
/// Listens on a port and serves one client at a time.
std::unique_ptr<Endpoint> make_tcp_server_endpoint(const LinkSpec& spec);

}  // namespace rosflight::companion
