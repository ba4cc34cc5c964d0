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
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "web/server/byte_range.hpp"
#include "web/server/foxglove.hpp"

namespace rosflight::web::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

class Viewer;
using Request = http::request<http::empty_body>;

/// "HOST:PORT" as a browser writes it.
std::string host_text(const asio::ip::address& address, std::uint16_t port) {
  const std::string text = address.to_string();
  return (address.is_v6() ? "[" + text + "]" : text) + ":" + std::to_string(port);
}

/// 128 bits.
std::string random_token() {
  constexpr int kWords = 4;
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string token;
  for (int k = 0; k < kWords; ++k) {
    const std::uint32_t word = random();
    for (unsigned shift = 0; shift < 32; shift += 4) token += kDigits[(word >> shift) & 15U];
  }
  return token;
}

/// What all sessions share; lives as long as the server. Only its thread uses it.
struct Site {
  Contents contents;
  Access access;
  std::uint16_t port{};
  std::string session{random_token()};  ///< Of this start.
  std::string token;                    ///< Empty: nobody has to show one.
  int clients{0};
  std::vector<std::weak_ptr<Viewer>> viewers;

  /// Whether a client names the server as what it is to who came in at this end.
  bool is_here(std::string_view name, const tcp::endpoint& end) const {
    if (name == host_text(end.address(), port)) return true;
    return end.address().is_loopback() && token.empty() &&
           name == "localhost:" + std::to_string(port);
  }
  /// Takes the same time wherever the first difference is.
  bool is_token(std::string_view shown) const {
    unsigned different = shown.size() == token.size() ? 0U : 1U;
    for (std::size_t k = 0; k < std::min(shown.size(), token.size()); ++k)
      different |= static_cast<unsigned char>(shown[k]) ^ static_cast<unsigned char>(token[k]);
    return different == 0;
  }
};

std::string_view media_type(std::string_view address) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kTypes{
      {{".html", "text/html; charset=utf-8"},
       {".js", "text/javascript; charset=utf-8"},
       {".css", "text/css; charset=utf-8"},
       {".json", "application/json"},
       {".mcap", "application/octet-stream"}}};
  if (address.empty()) return kTypes.front().second;
  for (const auto& [end, type] : kTypes) {
    if (address.ends_with(end)) return type;
  }
  return "application/octet-stream";
}

template <class Body>
void set_headers(http::response<Body>& response, std::string_view address) {
  response.set(http::field::content_type, std::string(media_type(address)));
  response.set(http::field::cache_control, "no-cache");
  response.set(http::field::accept_ranges, "bytes");
  // WebAssembly, from an address inside the page: the decoder of compressed logs.
  response.set(
      "Content-Security-Policy",
      "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self' data:; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
}

/// One WebSocket. Writes one message after the other; what is new waits in LiveData until the one
/// before has been sent.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(beast::tcp_stream stream, Site& site)
      : stream_{std::move(stream)},
        site_{site},
        admitted_{site.token.empty()},
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
      if (self->admitted_) return self->greet();
      self->admission_.expires_after(self->site_.access.handshake);
      self->admission_.async_wait([weak = self->weak_from_this()](beast::error_code) {
        if (const auto viewer = weak.lock(); viewer && !viewer->admitted_) viewer->let_go();
      });
    });
  }

 private:
  template <class Done>
  auto sent(Done done) {
    return [self = shared_from_this(), done](beast::error_code error, std::size_t) {
      self->sending_ = false;
      if (error) {
        self->open_ = false;
        return;
      }
      done(*self);
      if (!self->texts_.empty() || !self->messages_.empty()) self->send_next();
    };
  }

 public:
  /// Sends what is new unless something is being sent.
  void send_next() {
    if (!open_ || sending_ || !admitted_) return;
    if (texts_.empty() && messages_.empty()) take_news();
    while (!messages_.empty() && !subscriptions_.at(messages_.front()->channel))
      messages_.pop_front();  // unsubscribed meanwhile
    if (!texts_.empty()) {
      sending_ = true;
      stream_.text(true);
      stream_.async_write(asio::buffer(texts_.front()),
                          sent([](Viewer& v) { v.texts_.pop_front(); }));
    } else if (!messages_.empty()) {
      sending_ = true;
      const LiveData::Message& message = *messages_.front();
      head_ = foxglove::message_head(subscriptions_[message.channel].value_or(0), message.time_ns);
      stream_.binary(true);
      stream_.async_write(
          std::array<asio::const_buffer, 2>{asio::buffer(head_), asio::buffer(message.cdr)},
          sent([](Viewer& v) { v.messages_.pop_front(); }));
    }
  }

 private:
  void greet() {
    texts_.push_back(foxglove::server_info("rosflight", site_.session));
    send_next();
  }

  void let_go() {
    open_ = false;
    beast::get_lowest_layer(stream_).close();
  }

  void take_news() {
    const std::size_t first = cursor_.channels;
    LiveData::News news = site_.contents.live->news(cursor_);
    if (!news.channels.empty()) texts_.push_back(foxglove::advertise(first, news.channels));
    subscriptions_.resize(cursor_.channels);
    messages_.assign(news.messages.begin(), news.messages.end());
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) {
        self->open_ = false;
        return;
      }
      if (self->admitted_) {
        self->on_request();
      } else {
        self->on_token();
      }
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

  std::string_view message() const {
    const auto data = buffer_.cdata();
    return {static_cast<const char*>(data.data()), data.size()};
  }

  void on_token() {
    if (!site_.is_token(foxglove::parse_token(message()))) return let_go();
    admitted_ = true;
    admission_.cancel();
    greet();
  }

  void on_request() {
    if (!stream_.got_text()) return complain("binary messages are not used here");
    const foxglove::Request request = foxglove::parse_request(message());
    if (!request.complaint.empty()) return complain(request.complaint);
    for (const auto& [id, channel] : request.subscribe) {
      if (channel >= subscriptions_.size()) {
        complain("subscribe: no channel " + std::to_string(channel + 1));
        continue;
      }
      subscriptions_[channel] = id;
      cursor_.places[channel] = {true, 0, 0};
    }
    for (const std::uint32_t id : request.unsubscribe) {
      for (std::size_t k = 0; k < subscriptions_.size(); ++k) {
        if (subscriptions_[k] != id) continue;
        subscriptions_[k].reset();
        cursor_.places[k].wanted = false;
      }
    }
  }

  /// A client that sends one wrong message after the other and does not read the answers is disconnected.
  void complain(const std::string& what) {
    constexpr std::size_t kMaxUnreadTexts = 32;
    if (texts_.size() > kMaxUnreadTexts) return let_go();
    texts_.push_back(foxglove::status_error(what));
    send_next();
  }

  websocket::stream<beast::tcp_stream, false> stream_;
  Site& site_;
  beast::flat_buffer buffer_;
  bool admitted_;  ///< Has shown the token, where there is one.
  asio::steady_timer admission_;
  bool open_{false};
  bool sending_{false};
  std::deque<std::string> texts_;
  std::deque<LiveData::Shared> messages_;
  std::vector<std::uint8_t> head_;  ///< Of the message that is being sent.
  LiveData::Cursor cursor_;
  std::vector<std::optional<std::uint32_t>> subscriptions_;  ///< The viewer's ids, by channel.
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
    const std::string_view origin = header(http::field::origin);
    constexpr std::string_view kScheme = "http://";
    beast::error_code gone;
    const tcp::endpoint end = stream_.socket().local_endpoint(gone);
    if (gone) return close();
    if (!site_.is_here(header(http::field::host), end)) {
      return refuse(http::status::misdirected_request, "this server has another name");
    }
    const bool ours =
        origin.starts_with(kScheme) && site_.is_here(origin.substr(kScheme.size()), end);
    if (request.find(http::field::origin) != request.end() && !ours) {
      return refuse(http::status::forbidden, "asked for by a foreign page");
    }
    if (websocket::is_upgrade(request)) return upgrade(request);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(http::status::method_not_allowed, "allowed are GET and HEAD");
    }
    const auto target = request.target();
    std::string_view address(target.data(), target.size());
    address = address.substr(0, address.find('?'));
    if (!address.starts_with('/')) return refuse(http::status::bad_request, "no path");
    address.remove_prefix(1);
    if (!is_public(address) && !site_.token.empty()) {
      constexpr std::string_view kBearer = "Bearer ";
      const std::string_view shown = header(http::field::authorization);
      if (!shown.starts_with(kBearer) || !site_.is_token(shown.substr(kBearer.size())))
        return refuse(http::status::unauthorized,
                      "the token that was printed with the address is missing");
    }
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
    stream_.expires_after(site_.access.silence);
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
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{WebServer::kLargestHead};
  std::unique_ptr<http::request_parser<http::empty_body>> parser_;
  bool last_{false};  ///< The connection ends with this answer.
  Site& site_;
};

}  // namespace

struct WebServer::Impl {
  Impl(Contents contents, Access access) {
    site.contents = std::move(contents);
    site.access = std::move(access);
    if (!site.access.listen.empty()) site.token = random_token();
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
  if (error || address.is_unspecified())
    throw std::invalid_argument(listen + " is no address of one network interface");
  try {
    impl.listen(impl.first, address, impl.site.access.port);
  } catch (const boost::system::system_error& refused) {
    throw std::system_error(refused.code().value(), std::system_category());
  }
  impl.site.port = impl.first.local_endpoint().port();
  impl.accept(impl.first);
  if (listen.empty()) {
    try {
      impl.listen(impl.v6, asio::ip::address_v6::loopback(), impl.site.port);
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
  return impl_->site.port;
}

std::string WebServer::address() const {
  const std::string& token = impl_->site.token;
  return "http://" + host_text(impl_->first.local_endpoint().address(), port()) + "/" +
         (token.empty() ? "" : "#" + token);
}

}  // namespace rosflight::web::server
