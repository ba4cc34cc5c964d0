// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>

#include "companion/asio/link_transport.hpp"
#include "companion/session.hpp"

namespace rosflight::companion {

/// Runs a session in real time: steps it as soon as bytes arrive and when it has something due;
/// otherwise sleeps. Session and transport belong to the thread in run(); others speak to them by
/// post().
class Runner {
 public:
  using Clock = std::function<Time()>;

  /// Time of std::chrono::steady_clock.
  static Time steady_now();

  /// Throws LinkError for an unknown host. @param clock  companion time; must not go back.
  Runner(link::Codec& codec, const LinkSpec& link, const Session::Options& options,
         Clock clock = steady_now);
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  Session& session() { return session_; }
  LinkTransport& transport() { return transport_; }
  /// For timers and sockets of the caller in the same thread.
  boost::asio::io_context& io() { return io_; }

  /// One line for each change of the link ("/dev/ttyACM0: open"). Set before start().
  void on_link_state(std::function<void(bool open, const std::string& line)> handler);

  /// Opens the link and sends nothing yet; throws LinkError if waiting cannot help. Called by start() if not before.
  void open();
  /// The first step, on the opened link. Called by run() if not before.
  void start();
  /// Runs until stop().
  void run();
  /// Does what is ready without waiting, for callers with a loop of their own.
  void poll();
  /// Ends run(); any thread.
  void stop() { io_.stop(); }
  /// Runs `task` with the session between two steps; any thread.
  void post(std::function<void(Session&)> task);

 private:
  void step();

  Clock clock_;
  boost::asio::io_context io_{1};
  LinkTransport transport_;
  Session session_;
  boost::asio::steady_timer timer_{io_};
  Time armed_for_{kNever};
  bool opened_{false};
  bool started_{false};
  std::function<void(bool, const std::string&)> link_state_;
};

}  // namespace rosflight::companion
