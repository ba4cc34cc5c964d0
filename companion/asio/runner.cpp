// SPDX-License-Identifier: BSD-3-Clause
#include "companion/asio/runner.hpp"

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>

namespace rosflight::companion {

Time Runner::steady_now() {
  return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch());
}

Runner::Runner(link::Codec& codec, const LinkSpec& link, const Session::Options& options,
               Clock clock)
    : clock_(std::move(clock)),
      transport_(io_, make_endpoint(link)),
      session_(codec, transport_, options) {
  session_.begin_at(clock_());
}

void Runner::on_link_state(std::function<void(bool, const std::string&)> handler) {
  link_state_ = std::move(handler);
}

void Runner::open() {
  if (opened_) {
    return;
  }
  opened_ = true;
  transport_.set_handlers({[this] {
                             if (started_) step();
                           },
                           link_state_});
  transport_.start();
}

void Runner::start() {
  if (started_) {
    return;
  }
  started_ = true;
  open();
  step();
}

void Runner::run() {
  start();
  const auto work = boost::asio::make_work_guard(io_);
  io_.run();
}

void Runner::poll() {
  start();
  io_.restart();
  io_.poll();
}

void Runner::post(std::function<void(Session&)> task) {
  boost::asio::post(io_, [this, task = std::move(task)] {
    step();
    task(session_);
    step();
  });
}

void Runner::step() {
  const Time now = clock_();
  session_.step(now);
  const Time due = session_.next_due();
  // Re-arming costs more than a step: leave a timer alone that fires early enough.
  if (due >= armed_for_) {
    return;
  }
  armed_for_ = due;
  timer_.expires_after(std::max(due - now, Time{}));
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      armed_for_ = kNever;
      step();
    }
  });
}

}  // namespace rosflight::companion
