// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes Boost.Beast, which takes longer to compile than all of a library of ours.
#include "web/server/web_server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "web/server/byte_range.hpp"

namespace rosflight::web::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;

/// What all sessions share; lives as long as the server.
struct Site {
  Contents contents;
  std::uint16_t port{};
  std::atomic<int> clients{0};

  /// "HOST:PORT" as a client on this computer names the server.
  bool is_here(std::string_view name) const {
    const std::string port_text = ":" + std::to_string(port);
    return name == "127.0.0.1" + port_text || name == "localhost" + port_text ||
           name == "[::1]" + port_text;
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
  response.set("Content-Security-Policy",
               "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
}

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
    parser_.emplace();
    parser_->header_limit(WebServer::kLargestHead);
    parser_->body_limit(0);
    stream_.expires_after(std::chrono::seconds(WebServer::kSilence_s));
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       self->on_read(error);
                     });
  }

 private:
  using Request = http::request<http::empty_body>;
  using Texts = http::response<http::string_body>;

  void on_read(beast::error_code error) {
    if (error) return close();
    const Request& request = parser_->get();
    const auto header = [&request](http::field name) {
      const auto value = request[name];
      return std::string_view(value.data(), value.size());
    };
    const std::string_view origin = header(http::field::origin);
    constexpr std::string_view kScheme = "http://";
    if (!site_.is_here(header(http::field::host))) {
      return refuse(http::status::misdirected_request, "this server has another name");
    }
    const bool ours = origin.starts_with(kScheme) && site_.is_here(origin.substr(kScheme.size()));
    if (request.find(http::field::origin) != request.end() && !ours) {
      return refuse(http::status::forbidden, "asked for by a foreign page");
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(http::status::method_not_allowed, "allowed are GET and HEAD");
    }
    const auto target = request.target();
    std::string_view address(target.data(), target.size());
    address = address.substr(0, address.find('?'));
    if (!address.starts_with('/')) return refuse(http::status::bad_request, "no path");
    address.remove_prefix(1);
    answer(std::string(address), header(http::field::range));
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
    response->keep_alive(parser_->get().keep_alive());
    response->prepare_payload();
    const bool head = parser_->get().method() == http::verb::head;
    auto serializer = std::make_shared<http::response_serializer<Body>>(*response);
    stream_.expires_after(std::chrono::seconds(WebServer::kSilence_s));
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
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{WebServer::kLargestHead};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Site& site_;
};

}  // namespace

struct WebServer::Impl {
  explicit Impl(Contents contents) { site.contents = std::move(contents); }

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
  tcp::acceptor v4{io};
  tcp::acceptor v6{io};
  std::thread thread;
};

WebServer::WebServer(Contents contents, std::uint16_t port)
    : impl_{std::make_unique<Impl>(std::move(contents))} {
  Impl& impl = *impl_;
  try {
    impl.listen(impl.v4, asio::ip::address_v4::loopback(), port);
  } catch (const boost::system::system_error& error) {
    throw std::system_error(error.code().value(), std::system_category());
  }
  impl.site.port = impl.v4.local_endpoint().port();
  impl.accept(impl.v4);
  try {
    impl.listen(impl.v6, asio::ip::address_v6::loopback(), impl.site.port);
    impl.accept(impl.v6);
  } catch (const boost::system::system_error&) {
    impl.v6.close();  // a computer without IPv6
  }
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
  return "http://127.0.0.1:" + std::to_string(port()) + "/";
}

}  // namespace rosflight::web::server
