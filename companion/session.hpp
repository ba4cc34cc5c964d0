// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "companion/command_client.hpp"
#include "companion/connection.hpp"
#include "companion/listener.hpp"
#include "companion/offboard.hpp"
#include "companion/parameter_client.hpp"
#include "companion/port.hpp"
#include "companion/streams.hpp"
#include "companion/time_sync.hpp"
#include "companion/transport.hpp"
#include "link/codec.hpp"

namespace rosflight::companion {

/// Numbers of the link since the start.
struct LinkStatistics {
  std::uint64_t bytes_received{};
  std::uint64_t bytes_sent{};
  std::uint64_t send_failures{};  ///< Frames the transport did not take.
  std::uint64_t unexpected{};  ///< Messages only a companion sends: an echo or a second companion.
  std::uint64_t restarts{};
  std::uint64_t connections{};
  double receive_rate_bytes_s{};  ///< Over the last second.
  double send_rate_bytes_s{};
  link::Codec::Counters frames;
};

/// The companion's end of one link: decodes what comes, keeps the periodic traffic going, serves
/// the clients.
///
///     Session session(codec, transport, {});
///     session.add(listener);
///     for (;;) session.step(now);          // lock-step; in real time asio/runner.hpp does this
///
/// Periodic traffic while the link is open: heartbeat 1 s, TIMESYNC request 100 ms, version request
/// until answered, the parameter list at each start of link or FCU, with its gaps.
///
/// One thread: every call of session and clients from the same. No clock, no waiting. A step
/// without bytes and without due timers is two virtual calls; no heap but for jobs.
class Session final : private Port {
 public:
  struct Options {
    std::uint8_t target_system{
        1};  ///< SYS_ID of the FCU; follows when that parameter is set through us.
    std::string version{"2.0"};  ///< Major and minor that this companion is made for.
    Time heartbeat_period{std::chrono::seconds{1}};
    Time time_sync_period{std::chrono::milliseconds{100}};  ///< Zero: never.
    Time connection_timeout{std::chrono::seconds{2}};
    TimeSync::Rule time_sync_rule{TimeSync::Rule::kMinimumDelay};
    ParameterClient::Options parameters;
    CommandClient::Options commands;
  };

  Session(link::Codec& codec, Transport& transport, const Options& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Takes everything that has arrived, then does what is due. `now` never goes back. Step once
  /// before starting jobs: their time-outs count from the last step.
  void step(Time now);
  /// When step() has something to do even if no byte arrives.
  Time next_due() const { return next_due_; }
  Time now() const override { return now_; }

  /// Listeners are called in the order they were added and must live until removed.
  void add(Listener& listener) { listeners_.push_back(&listener); }
  void remove(Listener& listener) { std::erase(listeners_, &listener); }

  ParameterClient& parameters() { return parameters_; }
  const ParameterClient& parameters() const { return parameters_; }
  CommandClient& commands() { return commands_; }
  Offboard& offboard() { return offboard_; }
  const Offboard& offboard() const { return offboard_; }
  const Streams& streams() const { return streams_; }
  const TimeSync& time_sync() const { return time_sync_; }

  bool connected() const { return connection_.connected(); }
  const LinkStatistics& statistics();
  /// Empty until the FCU has told.
  std::string_view firmware_version() const { return text_of(version_.text); }
  VersionMatch version_match() const { return version_match_; }
  /// The FCU speaks of other messages than we know (SchemaEvent).
  bool refused() const { return refused_schema_.has_value(); }

  /// Asks the FCU for a report: its lines arrive as link::CheckResult or link::Counters events.
  bool request_report(link::ReportKind kind) {
    return send(link::ReportRequest{target_system(), static_cast<std::uint8_t>(kind)});
  }
  /// Runs one motor on the bench. The FCU ends it 0.3 s after the last call.
  bool test_motor(std::uint8_t motor, float value) {
    return send(link::MotorTest{target_system(), motor, value}, kTimely);
  }

  /// Sends a message as it is, for tools and tests. False if it did not leave.
  bool send(const link::Message& message, std::uint8_t qos = kOrdinary) override;

 private:
  struct Timer {
    Time due{};
    bool expired(Time now) const { return now >= due; }
  };

  void wake() override { next_due_ = Time{}; }
  void publish(const Event& event) override;
  std::uint8_t target_system() const override { return options_.target_system; }

  void receive();
  void dispatch(const link::Message& message);
  void run_timers();
  void watch_link();
  void watch_schema();
  void fcu_clock(Time fcu);
  void restarted();

  template <class F>
  void tell(F&& call) {
    for (std::size_t i = 0; i < listeners_.size(); ++i) {  // a listener may add another
      call(*listeners_[i]);
    }
  }

  // One per message kind; see session_dispatch.cpp.
  struct Dispatcher;

  Options options_;
  link::Codec& codec_;
  Transport& transport_;
  std::vector<Listener*> listeners_;
  Time now_{};
  Time next_due_{};
  bool link_open_{false};
  std::optional<std::uint32_t> refused_schema_;  ///< Of an FCU we cannot talk to.
  Timer heartbeat_;
  Timer sync_;
  Timer version_request_;
  Timer rates_;
  Time version_retry_{};
  std::uint64_t bytes_received_before_{0};
  std::uint64_t bytes_sent_before_{0};

  Connection connection_;
  TimeSync time_sync_;
  Streams streams_;
  ParameterClient parameters_;
  CommandClient commands_;
  Offboard offboard_;
  link::Version version_;
  VersionMatch version_match_{VersionMatch::kUnreadable};
  LinkStatistics statistics_;
  link::Frame frame_;
  std::array<std::uint8_t, 2048>
      buffer_;  // NOLINT: a whole datagram; only what read() filled is used
};

}  // namespace rosflight::companion
