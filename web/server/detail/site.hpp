// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "web/server/admission.hpp"
#include "web/server/web_server.hpp"

/// Headers in this folder include Boost.Beast, which takes longer to compile than all of a library of ours:
/// only web_server.cpp includes them.

namespace rosflight::web::server {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

class Viewer;
using Request = http::request<http::empty_body>;

/// What all sessions share; lives as long as the server. Only its thread uses it.
struct Site {
  Contents contents;
  Access access;
  Admission admission{{}, 0};
  std::string session{random_token()};  ///< Random identifier of this start.
  int clients{0};
  std::uint64_t viewers_so_far{0};
  std::vector<std::weak_ptr<Viewer>> viewers;
};

}  // namespace rosflight::web::server
