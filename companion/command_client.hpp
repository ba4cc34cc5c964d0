// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "companion/job.hpp"
#include "companion/parameter_client.hpp"
#include "companion/port.hpp"

namespace rosflight::companion {

struct CommandRule;

struct CommandResult {
  link::Command command{};
  bool acknowledged{};   ///< The acknowledgement was received; it may be lost in a successful job.
  std::string fcu_text;  ///< The log line of the FCU that decided the outcome, if any.
};

/// Commands to the FCU. Each is a job that ends with the outcome, not when the command is sent:
///
/// - Write, read, defaults, version, RC trim end with the acknowledgement. A request without one is
///   sent again, except RC trim, whose effect accumulates.
/// - Calibrations: the FCU acknowledges the start. The end is recognised by its log line
///   (calibration_texts.hpp) or, if that was lost or is never sent (gyro of ROSflight 2.x), by
///   biases that are new and not zero. At the timeout the biases are requested once more.
/// - Reboot ends when the boot clock starts again. Reboot to the bootloader ends with silence or
///   with a new start.
///
/// One job per command at a time; a second start() while it runs returns a failed job.
class CommandClient {
 public:
  struct Options {
    Time ack_timeout{std::chrono::milliseconds{500}};
    Time storage_timeout{
        std::chrono::seconds{3}};  ///< Acknowledge of read and write; a card may take 1 s.
    int attempts{6};               ///< For commands that may be repeated.
    /// From acknowledge to result: IMU 2.5 s at 400 Hz, barometer and airspeed 5.4 to 7.7 s.
    Time calibration_timeout{std::chrono::seconds{20}};
    Time reboot_timeout{std::chrono::seconds{15}};
  };

  /// @param port  must outlive this. @param parameters  likewise.
  CommandClient(const Options& options, Port& port, ParameterClient& parameters)
      : options_(options), port_(port), parameters_(parameters) {}
  ~CommandClient();
  CommandClient(const CommandClient&) = delete;
  CommandClient& operator=(const CommandClient&) = delete;

  /// Sends the command. @returns a job that ends with its outcome or a timeout.
  Job<CommandResult> start(link::Command command);

  // For the session.
  /// A message that may end a job.
  void received(const link::CommandAck& ack);
  void received(const link::StatusText& line);
  void received(const link::ParamValue& value);
  /// The boot clock of the FCU started again: ends reboots, fails everything else.
  void fcu_restarted();
  /// No valid message for the connection timeout.
  void connection_lost();
  /// State of the FCU; no calibration starts while armed.
  void set_armed(bool armed) { armed_ = armed; }
  /// Repeats requests and ends jobs whose time is over.
  void run(bool link_open);
  Time next_due() const { return due_; }
  bool idle() const { return pending_.empty(); }
  /// Takes over the state of another one; both must be idle.
  void copy_state_of(const CommandClient& other);

 private:
  static constexpr std::size_t kMaxEvidence = 3;
  enum class Phase : std::uint8_t { kAwaitAck, kAwaitResult, kLastLook };

  struct Pending {
    const CommandRule* rule{};
    std::shared_ptr<JobRecord<CommandResult>> job;
    Phase phase{Phase::kAwaitAck};
    int attempts{0};
    Time due{};
    std::uint64_t parameter_revision{};
    std::optional<Time>
        good_until_contradicted;  ///< Success seen; done at this time unless a failure comes.
    std::string good_text;
    std::array<std::optional<ParameterValue>, kMaxEvidence> before;
    std::array<std::optional<ParameterValue>, kMaxEvidence> latest;
    bool ended{false};
  };

  void transmit(Pending& p);
  void overdue(Pending& p);
  void ask_for_evidence(Pending& p);
  bool evidence_complete(const Pending& p) const;
  void acknowledged(Pending& p);
  void end(Pending& p, JobState state, const std::string& text);
  void sweep();
  void settle();
  Pending* find(link::Command command);

  Options options_;
  Port& port_;
  ParameterClient& parameters_;
  std::vector<Pending> pending_;
  JobEnds ends_;
  Time due_{kNever};
  bool armed_{false};
};

}  // namespace rosflight::companion
