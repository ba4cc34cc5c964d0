// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
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

/// Counters of the link since the start.
struct LinkStatistics {
  std::uint64_t bytes_received{};
  std::uint64_t bytes_sent{};
  std::uint64_t send_failures{};  ///< Frames that the transport rejected.
  std::uint64_t unexpected{};     ///< Messages that only companions send: an echo or a second one.
  std::uint64_t restarts{};
  std::uint64_t connections{};
  double receive_rate_bytes_s{};  ///< Over the last second.
  double send_rate_bytes_s{};
  link::Codec::Counters frames;
};

/// The companion's end of one link: decodes messages, sends the periodic ones, serves the clients.
///
///     Session session(codec, transport, {});
///     session.add(listener);
///     for (;;) session.step(now);          // lock-step; in real time asio/runner.hpp does this
///
/// Periodic messages while the link is open: heartbeat 1 s, TIMESYNC request 100 ms, version request
/// until it is answered, the parameter list at each start of link or FCU until it is complete.
///
/// All calls of session and clients come from one thread. It reads no clock and never waits. A step
/// without bytes and due timers is two virtual calls; only jobs use the heap.
class Session final : private Port {
 public:
  struct Options {
    std::uint8_t target_system{
        1};  ///< SYS_ID of the FCU; updated when that parameter is set through this session.
    std::string version{"2.0"};  ///< Major and minor that this companion is made for.
    Time heartbeat_period{std::chrono::seconds{1}};
    Time time_sync_period{std::chrono::milliseconds{100}};  ///< Zero: never.
    Time connection_timeout{std::chrono::seconds{2}};
    TimeSync::Rule time_sync_rule{TimeSync::Rule::kMinimumDelay};
    ParameterClient::Options parameters;
    CommandClient::Options commands;
  };

  /// @param codec  must outlive this. @param transport  likewise.
  Session(link::Codec& codec, Transport& transport, const Options& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Processes all received bytes, then runs due timers. `now` never decreases. Step or begin_at()
  /// before starting jobs: their timeouts count from the last step.
  void step(Time now);
  /// The time at which step() has something to do even if no byte arrives.
  Time next_due() const { return next_due_; }
  /// What jobs started before the first step count from; sends nothing.
  void begin_at(Time now) { now_ = std::max(now_, now); }
  Time now() const override { return now_; }

  /// No job is pending.
  bool idle() const { return parameters_.idle() && commands_.idle(); }
  /// Takes over all of another session but its codec, transport and listeners, so that both go on alike, as a
  /// simulation that returns to an earlier moment does. Both must be idle().
  void copy_state_of(const Session& other);

  /// Listeners are called in the order they were added and must live until removed.
  void add(Listener& listener) { listeners_.push_back(&listener); }
  /// Its functions are no longer called.
  void remove(Listener& listener) { std::erase(listeners_, &listener); }

  ParameterClient& parameters() { return parameters_; }
  const ParameterClient& parameters() const { return parameters_; }
  CommandClient& commands() { return commands_; }
  Offboard& offboard() { return offboard_; }
  const Offboard& offboard() const { return offboard_; }
  const Streams& streams() const { return streams_; }
  const TimeSync& time_sync() const { return time_sync_; }

  bool connected() const { return connection_.connected(); }
  /// Counters and rates of the link.
  const LinkStatistics& statistics();
  /// Empty until the FCU has sent it.
  std::string_view firmware_version() const { return text_of(version_.text); }
  VersionMatch version_match() const { return version_match_; }
  /// The FCU uses other message layouts (SchemaEvent); its frames are rejected.
  bool refused() const { return refused_schema_.has_value(); }

  /// Requests a report from the FCU: it arrives as link::CheckResult or link::Counters events.
  /// @returns false if the request was not sent.
  bool request_report(link::ReportKind kind) {
    return send(link::ReportRequest{target_system(), static_cast<std::uint8_t>(kind)});
  }
  /// Requests entries of the FCU's flight record: they arrive as link::RecordPart. See RecordReader.
  /// @returns false if the request was not sent.
  bool request_record(std::uint32_t first, std::uint16_t count) {
    return send(link::RecordRequest{target_system(), first, count});
  }
  /// Runs one motor on the bench; `value` 0..1. The FCU stops it 0.3 s after the last call.
  /// @returns false if the message was not sent.
  bool test_motor(std::uint8_t motor, float value) {
    return send(link::MotorTest{target_system(), motor, value}, kTimely);
  }

  /// Sends a message unchecked, for tools and tests. @returns false if it was not sent.
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
  void notify(F&& call) {
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
  std::optional<std::uint32_t> refused_schema_;  ///< Schema of an FCU with other layouts.
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
