// SPDX-License-Identifier: BSD-3-Clause
#include "companion/asio/link_transport.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>

#include "base/transport/socket.hpp"

namespace rosflight::companion {

namespace {

using boost::asio::posix::stream_descriptor;
using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kFirstBackOff = 100ms;
constexpr std::chrono::milliseconds kLastBackOff = 2000ms;
constexpr auto kConnectTimeout = 3s;
constexpr auto kSilence = 2s;
constexpr std::size_t kOrdinaryLimit = 2048;
constexpr std::size_t kUrgentLimit = 4096;

}  // namespace

LinkTransport::LinkTransport(boost::asio::io_context& io, std::unique_ptr<Endpoint> endpoint)
    : io_(io), endpoint_(std::move(endpoint)), descriptor_(io), timer_(io) {
  queue_.reserve(kUrgentLimit);
}

LinkTransport::~LinkTransport() {
  stop();
}

void LinkTransport::start() {
  started_ = true;
  attempt(true);
}

void LinkTransport::stop() {
  started_ = false;
  open_ = false;
  generation_ = std::make_shared<int>(0);
  close();
  timer_.cancel();
}

void LinkTransport::close() {
  if (descriptor_.is_open()) {
    // Also cancels what waits on it.
    const FileDescriptor closes_here(descriptor_.release());
  }
}

void LinkTransport::attempt(bool first) {
  proceed(endpoint_->open(), first);
}

void LinkTransport::proceed(Endpoint::Opened result, bool first) {
  using Result = Endpoint::Result;
  switch (result.result) {
    case Result::kOpen:
      opened(std::move(result.descriptor));
      return;
    case Result::kWaitRead:
    case Result::kWaitWrite:
      descriptor_.assign(result.descriptor.release());
      wait_for(result.result == Result::kWaitRead ? stream_descriptor::wait_read
                                                  : stream_descriptor::wait_write);
      return;
    case Result::kNotPossible:
      if (first) {
        throw LinkError(endpoint_->name() + ": " + result.reason);
      }
      [[fallthrough]];
    case Result::kNotNow:
      report(false, endpoint_->name() + ": " + result.reason + "; waiting");
      retry_later();
      return;
  }
}

void LinkTransport::wait_for(stream_descriptor::wait_type what) {
  const std::weak_ptr<int> alive = generation_;
  descriptor_.async_wait(what, [this, alive](const boost::system::error_code& error) {
    if (error || alive.expired()) {
      return;
    }
    timer_.cancel();
    proceed(endpoint_->finish(FileDescriptor(descriptor_.release())), false);
  });
  if (what == stream_descriptor::wait_write) {
    timer_.expires_after(kConnectTimeout);
    timer_.async_wait([this, alive](const boost::system::error_code& error) {
      if (!error && !alive.expired()) {
        failed("no answer from the peer");
      }
    });
  }
}

void LinkTransport::opened(FileDescriptor descriptor) {
  generation_ = std::make_shared<int>(0);  // a connect timer that has fired already is of the past
  descriptor_.assign(descriptor.release());
  descriptor_.native_non_blocking(true);
  open_ = true;
  writing_ = false;
  queue_.clear();
  back_off_ = 0ms;
  report(true, endpoint_->name() + ": open");
  arm_read();
  received_ = true;
  if (endpoint_->yields_after_silence()) {
    watch_silence();
  }
  if (handlers_.activity) {
    handlers_.activity();
  }
}

void LinkTransport::watch_silence() {
  if (!std::exchange(received_, false)) {
    failed("the peer is silent");
    return;
  }
  timer_.expires_after(kSilence);
  const std::weak_ptr<int> alive = generation_;
  timer_.async_wait([this, alive](const boost::system::error_code& error) {
    if (!error && !alive.expired()) {
      watch_silence();
    }
  });
}

void LinkTransport::failed(const std::string& reason) {
  generation_ = std::make_shared<int>(0);
  open_ = false;
  close();
  report(false, endpoint_->name() + ": " + reason + "; waiting");
  retry_later();
  // Often called from inside a step of the session, which must not be entered again.
  const std::weak_ptr<int> alive = generation_;
  boost::asio::post(io_, [this, alive] {
    if (!alive.expired() && handlers_.activity) {
      handlers_.activity();
    }
  });
}

void LinkTransport::retry_later() {
  if (!started_) {
    return;
  }
  back_off_ = back_off_ == 0ms ? kFirstBackOff : std::min(back_off_ * 2, kLastBackOff);
  timer_.expires_after(back_off_);
  const std::weak_ptr<int> alive = generation_;
  timer_.async_wait([this, alive](const boost::system::error_code& error) {
    if (!error && !alive.expired()) {
      attempt(false);
    }
  });
}

void LinkTransport::arm_read() {
  if (!handlers_.activity) {
    return;  // the owner polls; nobody would take the bytes that wake us
  }
  const std::weak_ptr<int> alive = generation_;
  descriptor_.async_wait(stream_descriptor::wait_read,
                         [this, alive](const boost::system::error_code& error) {
                           if (error || alive.expired()) {
                             return;
                           }
                           if (handlers_.activity) {
                             handlers_.activity();
                           }
                           if (!alive.expired()) {
                             arm_read();
                           }
                         });
}

std::size_t LinkTransport::read(std::uint8_t* data, std::size_t capacity) {
  if (!open_) {
    return 0;
  }
  const ssize_t size = ::read(descriptor_.native_handle(), data, capacity);
  if (size > 0) {
    received_ = true;
    return static_cast<std::size_t>(size);
  }
  const int error = errno;
  if (endpoint_->datagrams() || (size < 0 && base::would_block(error))) {
    return 0;
  }
  failed(size == 0 ? "closed by the peer" : std::strerror(error));
  return 0;
}

long LinkTransport::put(const std::uint8_t* data, std::size_t size) {
  const int fd = descriptor_.native_handle();
  return endpoint_->is_socket() ? ::send(fd, data, size, MSG_NOSIGNAL) : ::write(fd, data, size);
}

bool LinkTransport::write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  if (!open_) {
    return false;
  }
  if (endpoint_->datagrams()) {
    // The first try may only tell that nobody listened to the one before.
    return put(data, size) >= 0 || (errno == ECONNREFUSED && put(data, size) >= 0);
  }
  const std::size_t limit = qos == kUrgent ? kUrgentLimit : kOrdinaryLimit;
  if (!queue_.empty() && queue_.size() + size > limit) {
    return false;
  }
  std::size_t done = 0;
  if (queue_.empty()) {
    const long result = put(data, size);
    if (result < 0 && !base::would_block(errno)) {
      failed(std::strerror(errno));
      return false;
    }
    done = result > 0 ? static_cast<std::size_t>(result) : 0;
  }
  queue_.insert(queue_.end(), data + done, data + size);
  arm_write();
  return true;
}

void LinkTransport::arm_write() {
  if (queue_.empty() || writing_) {
    return;
  }
  writing_ = true;
  const std::weak_ptr<int> alive = generation_;
  descriptor_.async_wait(stream_descriptor::wait_write,
                         [this, alive](const boost::system::error_code& error) {
                           if (!error && !alive.expired()) {
                             writing_ = false;
                             flush();
                           }
                         });
}

void LinkTransport::flush() {
  const long result = put(queue_.data(), queue_.size());
  if (result < 0 && !base::would_block(errno)) {
    failed(std::strerror(errno));
    return;
  }
  queue_.erase(queue_.begin(), queue_.begin() + std::max(result, 0L));
  arm_write();
}

void LinkTransport::report(bool open, const std::string& line) {
  if (line == last_line_) {
    return;
  }
  last_line_ = line;
  if (handlers_.state) {
    handlers_.state(open, line);
  }
}

}  // namespace rosflight::companion
