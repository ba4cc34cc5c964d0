// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "web/server/byte_range.hpp"
#include "web/server/detail/viewer.hpp"
#include "web/server/foxglove.hpp"
#include "web/server/response_headers.hpp"

namespace rosflight::web::server {

template <class Body>
void set_headers(http::response<Body>& response, std::string_view address) {
  response.set(http::field::content_type, std::string(media_type(address)));
  response.set(http::field::cache_control, "no-cache");
  response.set(http::field::accept_ranges, "bytes");
  for (const auto& [name, value] : kBrowserRules)
    response.set(beast::string_view(name.data(), name.size()), std::string(value));
}

/// One connection: a request after the other until one side closes it.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(tcp::socket socket, Site& site) : stream_{std::move(socket)}, site_{site} {
    ++site_.clients;
  }
  ~HttpSession() { --site_.clients; }
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;

  void read() {
    parser_ = std::make_unique<http::request_parser<http::empty_body>>();
    parser_->header_limit(WebServer::kMaxHead);
    parser_->body_limit(0);
    stream_.expires_after(site_.access.silence);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       self->on_read(error);
                     });
  }

 private:
  using Texts = http::response<http::string_body>;

  void on_read(beast::error_code error) {
    last_ = static_cast<bool>(error);  // what follows is not understood
    if (error == http::error::header_limit) {
      return refuse(http::status::request_header_fields_too_large,
                    "the head of the request is too long");
    }
    if (error == http::error::body_limit)
      return refuse(http::status::payload_too_large, "no body is taken");
    if (error) return close();
    const Request& request = parser_->get();
    const auto header = [&request](http::field name) {
      const auto value = request[name];
      return std::string_view(value.data(), value.size());
    };
    if (!site_.admission.is_name(header(http::field::host)))
      return refuse(http::status::misdirected_request, "this server has another name");
    const Right right = request.find(http::field::origin) == request.end()
                            ? Right::kCommand
                            : site_.admission.right_of_origin(header(http::field::origin));
    const bool is_upgrade = websocket::is_upgrade(request);
    if (right < (is_upgrade ? Right::kLook : Right::kCommand))
      return refuse(http::status::forbidden, "asked for by a foreign page");
    if (is_upgrade) return upgrade(request, right);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(http::status::method_not_allowed, "allowed are GET and HEAD");
    }
    const auto target = request.target();
    std::string_view address(target.data(), target.size());
    address = address.substr(0, address.find('?'));
    if (!address.starts_with('/')) return refuse(http::status::bad_request, "no path");
    address.remove_prefix(1);
    if (site_.admission.wants_token() && !is_public(address) &&
        !site_.admission.is_bearer(header(http::field::authorization)))
      return refuse(http::status::unauthorized,
                    "the token that was printed with the address is missing");
    answer(std::string(address), header(http::field::range));
  }

  /// The page itself has nothing of a flight.
  static bool is_public(std::string_view address) {
    return address.empty() || address == "page.js" || address == "page.css";
  }

  void upgrade(const Request& request, Right most) {
    const auto offered = request[http::field::sec_websocket_protocol];
    const auto protocol = foxglove::chosen_protocol({offered.data(), offered.size()});
    if (site_.contents.live == nullptr) return refuse(http::status::not_found, "nothing runs here");
    if (!protocol) {
      return refuse(http::status::bad_request,
                    "known protocols: foxglove.websocket.v1, foxglove.sdk.v1");
    }
    if (buffer_.size() != 0) {
      last_ = true;
      return refuse(http::status::bad_request, "messages come after the answer to the handshake");
    }
    std::erase_if(site_.viewers, [](const std::weak_ptr<Viewer>& v) { return v.expired(); });
    if (site_.viewers.size() >= WebServer::kMaxViewers) {
      return refuse(http::status::service_unavailable, "too many viewers");
    }
    stream_.expires_never();  // the WebSocket has time limits of its own
    const auto viewer = std::make_shared<Viewer>(std::move(stream_), site_, most);
    site_.viewers.push_back(viewer);
    viewer->accept(request, *protocol);
  }

  void answer(const std::string& address, std::string_view range) {
    if (const auto text = site_.contents.texts.find(address); text != site_.contents.texts.end()) {
      return send_text(http::status::ok, text->second, address);
    }
    const auto file = site_.contents.files.find(address);
    if (file == site_.contents.files.end()) {
      return refuse(http::status::not_found, "nothing has this address");
    }
    beast::error_code error;
    http::file_body::value_type body;
    body.open(file->second.c_str(), beast::file_mode::scan, error);
    if (error) return refuse(http::status::not_found, "the file cannot be read any more");
    const std::uint64_t size = body.size();
    if (range.empty()) {
      http::response<http::file_body> response{http::status::ok, version()};
      response.body() = std::move(body);
      set_headers(response, address);
      return send(std::move(response));
    }
    const std::optional<ByteRange> wanted = byte_range(range, size);
    if (!wanted) return refuse(http::status::range_not_satisfiable, "no such range");
    send_range(body, *wanted, size, address);
  }

  void send_range(http::file_body::value_type& body, ByteRange wanted, std::uint64_t size,
                  const std::string& address) {
    beast::error_code error;
    Texts response{http::status::partial_content, version()};
    response.body().resize(static_cast<std::size_t>(wanted.length));
    body.file().seek(wanted.start, error);
    std::size_t read = 0;
    while (!error && read < response.body().size()) {
      const std::size_t n =
          body.file().read(response.body().data() + read, response.body().size() - read, error);
      if (n == 0) break;
      read += n;
    }
    if (error || read < response.body().size()) {
      return refuse(http::status::internal_server_error, "the file cannot be read any more");
    }
    set_headers(response, address);
    response.set(http::field::content_range, "bytes " + std::to_string(wanted.start) + "-" +
                                                 std::to_string(wanted.start + wanted.length - 1) +
                                                 "/" + std::to_string(size));
    send(std::move(response));
  }

  void refuse(http::status status, std::string_view why) {
    send_text(status, std::string(why) + "\n", ".txt");
  }

  void send_text(http::status status, std::string text, const std::string& address) {
    Texts response{status, version()};
    response.body() = std::move(text);
    set_headers(response, address);
    if (status == http::status::unauthorized) response.set(http::field::www_authenticate, "Bearer");
    send(std::move(response));
  }

  unsigned version() const { return parser_->get().version(); }

  template <class Body>
  void send(http::response<Body>&& made) {
    auto response = std::make_shared<http::response<Body>>(std::move(made));
    response->keep_alive(!last_ && parser_->get().keep_alive());
    response->prepare_payload();
    const bool head = parser_->get().method() == http::verb::head;
    auto serializer = std::make_shared<http::response_serializer<Body>>(*response);
    // A slow client has time for all of it, one that does not read is not waited for.
    constexpr std::uint64_t kMinRate_bytes_s = 16384;
    const std::chrono::seconds slow(response->payload_size().value_or(0) / kMinRate_bytes_s);
    stream_.expires_after(site_.access.silence + slow);
    const auto sent = [self = shared_from_this(), response, serializer](beast::error_code error,
                                                                        std::size_t) {
      if (error || response->need_eof()) return self->close();
      self->read();
    };
    if (head) {
      http::async_write_header(stream_, *serializer, sent);
    } else {
      http::async_write(stream_, *serializer, sent);
    }
  }

  void close() {
    beast::error_code ignored;
    // NOLINTNEXTLINE(bugprone-unused-return-value): the connection ends either way
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kLinger);
    drop_rest();
  }

  /// While bytes of the client are unread, closing could take the answer from it (RFC 9112, section 9.6).
  void drop_rest() {
    stream_.async_read_some(asio::buffer(rest_),
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              if (!error) self->drop_rest();
                            });
  }

  static constexpr std::chrono::seconds kLinger{1};
  static constexpr std::size_t kRest = 1024;

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{WebServer::kMaxHead};
  std::unique_ptr<http::request_parser<http::empty_body>> parser_;
  bool last_{false};  ///< The connection ends with this answer.
  std::array<char, kRest> rest_{};
  Site& site_;
};

}  // namespace rosflight::web::server
