// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "companion/asio/endpoint.hpp"
#include "companion/transport.hpp"

namespace rosflight::companion {

/// A serial port, pseudo terminal, UDP or TCP link that opens and mends itself.
///
/// After a failure (unplugged, peer gone, not there yet) it tries again: after 100 ms, each time
/// twice as long, up to 2 s. Writes go to the kernel at once; what it does not take waits here, 2
/// kB of ordinary frames at most (22 ms at 921600 baud) and 4 kB with urgent ones. All calls and
/// handlers from the thread that runs the io_context.
class LinkTransport final : public Transport {
 public:
  struct Handlers {
    /// Bytes have come (to be read now), or the link opened or closed. May be empty if the owner
    /// polls.
    std::function<void()> activity;
    std::function<void(bool open, const std::string& line)> state;  ///< One line for people.
  };

  /// Opens nothing yet. `io` must outlive the transport.
  LinkTransport(boost::asio::io_context& io, std::unique_ptr<Endpoint> endpoint);
  ~LinkTransport() override;
  LinkTransport(const LinkTransport&) = delete;
  LinkTransport& operator=(const LinkTransport&) = delete;

  /// Set before start(); the handlers run in the thread of the io_context.
  void set_handlers(Handlers handlers) { handlers_ = std::move(handlers); }

  /// Opens for the first time. A peer or device that is not there is waited for; throws LinkError
  /// for what waiting cannot mend: port taken, forbidden, no serial port.
  void start();
  /// Closes the link and ends the attempts to open it; start() opens it again.
  void stop();

  bool connected() override { return open_; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;

  std::string name() const { return endpoint_->name(); }

 private:
  void attempt(bool first);
  void proceed(Endpoint::Opened opened, bool first);
  void wait_for(boost::asio::posix::stream_descriptor::wait_type what);
  void opened(FileDescriptor descriptor);
  void failed(const std::string& reason);
  void close();
  void retry_later();
  void watch_silence();
  void arm_read();
  void arm_write();
  void flush();
  long put(const std::uint8_t* data, std::size_t size);
  void report(bool open, const std::string& line);

  boost::asio::io_context& io_;
  std::unique_ptr<Endpoint> endpoint_;
  boost::asio::posix::stream_descriptor descriptor_;
  boost::asio::steady_timer timer_;
  Handlers handlers_;
  bool started_{false};
  bool open_{false};
  bool writing_{false};
  bool received_{false};  ///< Since the last look of watch_silence().
  std::chrono::milliseconds back_off_{0};
  std::string last_line_;
  std::vector<std::uint8_t> queue_;
  /// Handlers of an earlier descriptor or life must not touch this one.
  std::shared_ptr<int> generation_{std::make_shared<int>(0)};
};

}  // namespace rosflight::companion
