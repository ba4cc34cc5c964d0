// SPDX-License-Identifier: BSD-3-Clause
#include "companion/asio/endpoint.hpp"

namespace rosflight::companion {

Endpoint::Opened Endpoint::finish(FileDescriptor waited) {
  return {Result::kOpen, std::move(waited), {}};
}

std::unique_ptr<Endpoint> make_endpoint(const LinkSpec& spec) {
  switch (spec.kind) {
    case LinkSpec::Kind::kSerial:
      return make_serial_endpoint(spec);
    case LinkSpec::Kind::kPty:
      return make_pty_endpoint();
    case LinkSpec::Kind::kUdp:
      return make_udp_endpoint(spec);
    case LinkSpec::Kind::kUdpServer:
      return make_udp_server_endpoint(spec);
    case LinkSpec::Kind::kTcpClient:
      return make_tcp_client_endpoint(spec);
    case LinkSpec::Kind::kTcpServer:
      return make_tcp_server_endpoint(spec);
  }
  throw LinkError("unknown kind of link");
}

}  // namespace rosflight::companion
