// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <boost/asio/executor_work_guard.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "companion/asio/runner.hpp"
#include "companion/session.hpp"
#include "link/detect/detecting_codec.hpp"

namespace rosflight::ground {

using companion::Job;
using companion::Session;
using companion::Time;

/// The vehicle does not answer: one line with the link, the time waited and the last message of the link.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A person asked the program to stop.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// Reads a link as people write it: everything parse_link() reads, and what `./rosflight sil` prints as
/// link=, which is the board's name of the same link:
///
///     PATH, PATH:BAUD       a path with '/' is a serial device or the far end of a pty
///     pty:PATH              the same
///     udp:HOST:PORT         listens there if the port is free on this machine, as the board's far end
///                           is; otherwise datagrams to and from that address
///
/// @throws LinkError  one line: what was found and what is allowed.
base::LinkAddress parse_ground_link(std::string_view text);

/// A session with a vehicle for programs that wait: opens the link, runs it while they wait.
class GroundLink {
 public:
  struct Options {
    std::string link;                       ///< See parse_ground_link().
    Time timeout{std::chrono::seconds{5}};  ///< For the first heartbeat and for silence later.
    std::uint8_t system{1};                 ///< SYS_ID of the vehicle.
    std::function<bool()> stopped;          ///< A person asked to stop; may be empty.
    std::function<void()> each_turn{};      ///< Called while it runs, each 10 ms; may be empty.
  };

  /// Opens nothing yet. @throws LinkError  the link cannot be read or its host is unknown.
  explicit GroundLink(const Options& options);
  GroundLink(const GroundLink&) = delete;
  GroundLink& operator=(const GroundLink&) = delete;

  /// Opens the link and waits for a heartbeat, a status and the texts of the vehicle.
  /// @throws LinkError  taken, forbidden, no serial port. @throws NoAnswer @throws Stopped
  void connect();
  /// Receives the whole parameter table. @throws NoAnswer @throws Stopped
  void receive_parameters();
  /// Runs the link until done() or for `limit`. @returns done(). @throws Stopped
  bool run_until(const std::function<bool()>& done, Time limit);
  /// Runs the link for a time. @throws Stopped
  void run_for(Time duration) {
    run_until([] { return false; }, duration);
  }
  /// Runs the link until a job ends; jobs have timeouts of their own. @throws Stopped
  template <class Result>
  const Job<Result>& wait(const Job<Result>& job) {
    run_until([&job] { return !job.pending(); }, companion::kNever);
    return job;
  }
  /// As wait(), also when a person asked to stop: for what must not be left half done.
  template <class Result>
  const Job<Result>& finish(const Job<Result>& job) {
    run([&job] { return !job.pending(); }, companion::kNever, false);
    return job;
  }
  /// Runs the link until done() or for `limit`, also when a person asked to stop. @returns done().
  bool finish_until(const std::function<bool()>& done, Time limit) {
    return run(done, limit, false);
  }

  Session& session() { return runner_.session(); }
  const companion::Streams& streams() { return session().streams(); }
  /// Link as the user gave it.
  const std::string& name() const { return options_.link; }
  Time timeout() const { return options_.timeout; }
  Time now() const { return companion::Runner::steady_now(); }

 private:
  bool run(const std::function<bool()>& done, Time limit, bool stoppable);
  [[noreturn]] void no_answer(const std::string& what);

  Options options_;
  link::DetectingCodec codec_;
  companion::Runner runner_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  std::string last_line_;
};

/// The texts of the vehicle since it was made or cleared.
class TextLog final : public companion::Listener {
 public:
  explicit TextLog(Session& session) : session_(session) { session_.add(*this); }
  ~TextLog() override { session_.remove(*this); }
  TextLog(const TextLog&) = delete;
  TextLog& operator=(const TextLog&) = delete;

  void on_event(const companion::Event& event) override;
  const std::vector<std::string>& lines() const { return lines_; }
  /// The last line that contains `part`, else nothing.
  std::string last_with(std::string_view part) const;
  /// Forgets all lines.
  void clear() { lines_.clear(); }

 private:
  Session& session_;
  std::vector<std::string> lines_;
};

}  // namespace rosflight::ground
