// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes Boost.Beast, which takes longer to compile than all of a library of ours.
#include "web/server/web_server.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "web/server/admission.hpp"
#include "web/server/byte_range.hpp"
#include "web/server/conversation.hpp"
#include "web/server/foxglove.hpp"
#include "web/server/response_headers.hpp"

namespace rosflight::web::server {
namespace {

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
  std::string session{random_token()};  ///< Of this start.
  int clients{0};
  std::uint64_t viewers_so_far{0};
  std::vector<std::weak_ptr<Viewer>> viewers;
};

template <class Body>
void set_headers(http::response<Body>& response, std::string_view address) {
  response.set(http::field::content_type, std::string(media_type(address)));
  response.set(http::field::cache_control, "no-cache");
  response.set(http::field::accept_ranges, "bytes");
  for (const auto& [name, value] : kBrowserRules)
    response.set(beast::string_view(name.data(), name.size()), std::string(value));
}

/// One WebSocket. Writes one message after the other.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(beast::tcp_stream stream, Site& site)
      : stream_{std::move(stream)},
        site_{site},
        conversation_{*site.contents.live, site.contents.desk, site.admission, site.session,
                      ++site.viewers_so_far},
        admission_{stream_.get_executor()} {
    ++site_.clients;
  }
  ~Viewer() { --site_.clients; }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void accept(const Request& request, std::string_view protocol) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = site_.access.handshake;
    timeout.idle_timeout = site_.access.silence;
    timeout.keep_alive_pings = true;
    stream_.set_option(timeout);
    stream_.set_option(websocket::stream_base::decorator(
        [name = std::string(protocol)](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, name);
        }));
    stream_.read_message_max(WebServer::kLargestMessage);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->open_ = true;
      self->read();
      self->send_next();
      self->admission_.expires_after(self->site_.access.handshake);
      self->admission_.async_wait([weak = self->weak_from_this()](beast::error_code) {
        const auto viewer = weak.lock();
        if (viewer && !viewer->conversation_.is_admitted()) viewer->let_go();
      });
    });
  }

  /// Sends what is new unless something is being sent.
  void send_next() {
    if (!open_ || sending_) return;
    frame_ = conversation_.next();
    if (!frame_) return;
    sending_ = true;
    stream_.text(frame_->is_text);
    const auto contents =
        frame_->message ? asio::buffer(frame_->message->cdr) : asio::const_buffer();
    stream_.async_write(std::array<asio::const_buffer, 2>{asio::buffer(frame_->head), contents},
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          self->sending_ = false;
                          if (error) {
                            self->open_ = false;
                          } else {
                            self->send_next();
                          }
                        });
  }

 private:
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) {
        self->open_ = false;
        return;
      }
      const auto data = self->buffer_.cdata();
      const std::string_view message(static_cast<const char*>(data.data()), data.size());
      if (!self->conversation_.on_message(message, self->stream_.got_text())) return self->let_go();
      self->buffer_.consume(self->buffer_.size());
      self->send_next();
      self->read();
    });
  }

  void let_go() {
    open_ = false;
    beast::get_lowest_layer(stream_).close();
  }

  websocket::stream<beast::tcp_stream, false> stream_;
  Site& site_;
  Conversation conversation_;
  asio::steady_timer admission_;  ///< Until then the token has come, where one is wanted.
  beast::flat_buffer buffer_;
  bool open_{false};
  bool sending_{false};
  std::optional<Conversation::Frame> frame_;  ///< That is being sent.
};

/// One connection: a request after the other until one side closes it.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(tcp::socket socket, Site& site) : stream_{std::move(socket)}, site_{site} {
    ++site_.clients;
  }
  ~Session() { --site_.clients; }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void read() {
    parser_ = std::make_unique<http::request_parser<http::empty_body>>();
    parser_->header_limit(WebServer::kLargestHead);
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
    if (request.find(http::field::origin) != request.end() &&
        !site_.admission.is_origin(header(http::field::origin)))
      return refuse(http::status::forbidden, "asked for by a foreign page");
    if (websocket::is_upgrade(request)) return upgrade(request);
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

  void upgrade(const Request& request) {
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
    if (site_.viewers.size() >= WebServer::kMostViewers) {
      return refuse(http::status::service_unavailable, "too many viewers");
    }
    stream_.expires_never();  // the WebSocket has time limits of its own
    const auto viewer = std::make_shared<Viewer>(std::move(stream_), site_);
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
    constexpr std::uint64_t kSlowest_bytes_s = 16384;
    const std::chrono::seconds slow(response->payload_size().value_or(0) / kSlowest_bytes_s);
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
  beast::flat_buffer buffer_{WebServer::kLargestHead};
  std::unique_ptr<http::request_parser<http::empty_body>> parser_;
  bool last_{false};  ///< The connection ends with this answer.
  std::array<char, kRest> rest_{};
  Site& site_;
};

}  // namespace

struct WebServer::Impl {
  Impl(Contents contents, Access access) {
    site.contents = std::move(contents);
    site.access = std::move(access);
  }

  /// What is new goes to all viewers, again and again.
  void tick() {
    timer.expires_after(std::chrono::microseconds(1'000'000 / kRate_Hz));
    timer.async_wait([this](beast::error_code error) {
      if (error) return;
      for (const std::weak_ptr<Viewer>& weak : site.viewers) {
        if (const auto viewer = weak.lock()) viewer->send_next();
      }
      tick();
    });
  }

  /// @throws boost::system::system_error, which is a std::system_error.
  void listen(tcp::acceptor& acceptor, const asio::ip::address& address, std::uint16_t port) {
    const tcp::endpoint here(address, port);
    acceptor.open(here.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    if (address.is_v6()) acceptor.set_option(asio::ip::v6_only(true));
    acceptor.bind(here);
    acceptor.listen();
  }

  void accept(tcp::acceptor& acceptor) {
    acceptor.async_accept([this, &acceptor](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error && site.clients < kMostClients) {
        std::make_shared<Session>(std::move(socket), site)->read();
      }
      accept(acceptor);
    });
  }

  Site site;
  asio::io_context io{1};
  tcp::acceptor first{io};
  tcp::acceptor v6{io};  ///< Of this computer.
  asio::steady_timer timer{io};
  std::thread thread;
};

WebServer::WebServer(Contents contents, Access access)
    : impl_{std::make_unique<Impl>(std::move(contents), std::move(access))} {
  Impl& impl = *impl_;
  const std::string& listen = impl.site.access.listen;
  beast::error_code error;
  const auto address = listen.empty() ? asio::ip::address(asio::ip::address_v4::loopback())
                                      : asio::ip::make_address(listen, error);
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  if (error || address.is_unspecified() || address.is_multicast() || mapped)
    throw std::invalid_argument(listen + " is no address of one network interface");
  try {
    impl.listen(impl.first, address, impl.site.access.port);
  } catch (const boost::system::system_error& refused) {
    throw std::system_error(refused.code().value(), std::system_category());
  }
  impl.site.admission = Admission(listen.empty() ? listen : address.to_string(), port());
  impl.accept(impl.first);
  if (listen.empty()) {
    try {
      impl.listen(impl.v6, asio::ip::address_v6::loopback(), port());
      impl.accept(impl.v6);
    } catch (const boost::system::system_error&) {
      impl.v6.close();  // a computer without IPv6
    }
  }
  if (impl.site.contents.live != nullptr) impl.tick();
  impl.thread = std::thread([&impl] { impl.io.run(); });
}

WebServer::~WebServer() {
  impl_->io.stop();
  impl_->thread.join();
}

std::uint16_t WebServer::port() const {
  return impl_->first.local_endpoint().port();
}

std::string WebServer::address(Right right) const {
  return impl_->site.admission.address(right);
}

}  // namespace rosflight::web::server
