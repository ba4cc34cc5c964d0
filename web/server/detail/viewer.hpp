// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <boost/asio/steady_timer.hpp>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "web/server/conversation.hpp"
#include "web/server/detail/site.hpp"

namespace rosflight::web::server {

/// One WebSocket. Writes one message after the other, and no more while WebServer::kMaxOnTheWay bytes
/// are on their way: what the sockets' buffers and a slow network hold would only be old when it is read.
/// How far the viewer has read, its pongs say (RFC 6455, section 5.5.3); each ping has the number of bytes
/// sent before it.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  /// @param most  what it may do at most.
  Viewer(beast::tcp_stream stream, Site& site, Right most)
      : stream_{std::move(stream)},
        site_{site},
        conversation_{*site.contents.live, site.contents.desk,    site.admission,
                      site.session,        ++site.viewers_so_far, most},
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
    stream_.read_message_max(WebServer::kMaxMessage);
    stream_.control_callback([this](websocket::frame_type kind, beast::string_view payload) {
      if (kind == websocket::frame_type::pong) on_pong({payload.data(), payload.size()});
    });
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

  /// Sends what is new unless something is being sent, or too much is on its way.
  void send_next() {
    if (!open_ || sending_ || sent_ - confirmed_ > WebServer::kMaxOnTheWay) return;
    frame_ = conversation_.next();
    if (!frame_) {
      if (conversation_.is_over()) let_go();
      return;
    }
    sending_ = true;
    stream_.text(frame_->is_text);
    const auto contents =
        frame_->message ? asio::buffer(frame_->message->cdr) : asio::const_buffer();
    stream_.async_write(std::array<asio::const_buffer, 2>{asio::buffer(frame_->head), contents},
                        [self = shared_from_this()](beast::error_code error, std::size_t bytes) {
                          self->sending_ = false;
                          if (error) {
                            self->open_ = false;
                            return;
                          }
                          self->sent_ += bytes;
                          self->ask_how_far();
                          self->send_next();
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

  /// A ping, after each kAskEach bytes.
  void ask_how_far() {
    if (!open_ || asking_ || sent_ - asked_ < kAskEach) return;
    asking_ = true;
    asked_ = sent_;
    websocket::ping_data payload;
    payload.append(std::to_string(asked_));
    stream_.async_ping(payload, [self = shared_from_this()](beast::error_code error) {
      self->asking_ = false;
      if (!error) self->ask_how_far();
    });
  }

  void on_pong(std::string_view payload) {
    std::uint64_t bytes{};
    const char* end = payload.data() + payload.size();
    if (payload.empty() || std::from_chars(payload.data(), end, bytes).ptr != end) return;
    if (bytes <= asked_) confirmed_ = std::max(confirmed_, bytes);
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
  static constexpr std::uint64_t kAskEach = WebServer::kMaxOnTheWay / 4;

  bool open_{false};
  bool sending_{false};
  bool asking_{false};                        ///< A ping is being sent.
  std::uint64_t sent_{0};                     ///< Bytes since the handshake.
  std::uint64_t asked_{0};                    ///< Those before the newest ping.
  std::uint64_t confirmed_{0};                ///< Those that the viewer has read.
  std::optional<Conversation::Frame> frame_;  ///< That is being sent.
};

}  // namespace rosflight::web::server
