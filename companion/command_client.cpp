// SPDX-License-Identifier: BSD-3-Clause
#include "companion/command_client.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "companion/calibration_texts.hpp"

namespace rosflight::companion {

/// How one command behaves.
struct CommandRule {
  enum class Ends : std::uint8_t { kWithAck, kWithResult, kWithRestart, kWithSilence };
  link::Command command;
  const char* name;
  Ends ends;
  bool repeatable;
  bool slow_ack;
  std::array<std::string_view, 1> success;
  std::array<std::string_view, 5> failure;
  std::array<std::string_view, 3> evidence;  ///< Parameters that get new values.
};

namespace {

using Ends = CommandRule::Ends;
using link::Command;

constexpr std::array<CommandRule, 11> kRules{{
    {Command::kRcCalibration, "RC trim calibration", Ends::kWithAck, false, false, {}, {}, {}},
    {Command::kAccelCalibration,
     "IMU calibration",
     Ends::kWithResult,
     true,
     false,
     {kImuSuccess},
     {kImuMotion, kImuLargeBias, kGyroFailure, kGyroRefused, kAccelRefused},
     {"ACC_X_BIAS", "ACC_Y_BIAS", "ACC_Z_BIAS"}},
    {Command::kGyroCalibration,
     "gyro calibration",
     Ends::kWithResult,
     true,
     false,
     {kGyroSuccess},
     {kGyroFailure, kGyroRefused},
     {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"}},
    {Command::kBaroCalibration,
     "barometer calibration",
     Ends::kWithResult,
     true,
     false,
     {kBaroSuccess},
     {kBaroMotion},
     {"BARO_BIAS", "GROUND_LEVEL"}},
    {Command::kAirspeedCalibration,
     "airspeed calibration",
     Ends::kWithResult,
     true,
     false,
     {kAirspeedSuccess},
     {kAirspeedMotion},
     {"DIFF_PRESS_BIAS"}},
    {Command::kReadParams, "reading stored parameters", Ends::kWithAck, true, true, {}, {}, {}},
    {Command::kWriteParams, "writing parameters", Ends::kWithAck, true, true, {}, {}, {}},
    {Command::kSetParamDefaults,
     "setting default parameters",
     Ends::kWithAck,
     true,
     false,
     {},
     {},
     {}},
    {Command::kReboot, "reboot", Ends::kWithRestart, false, false, {}, {}, {}},
    {Command::kRebootToBootloader,
     "reboot to bootloader",
     Ends::kWithSilence,
     false,
     false,
     {},
     {},
     {}},
    {Command::kSendVersion, "version request", Ends::kWithAck, true, false, {}, {}, {}},
}};

// Accelerometer and gyro end on the same sample: a failure of the second follows at once.
constexpr Time kSettleAfterText = std::chrono::milliseconds{200};
// Biases travel before the log line; give that time to contradict.
constexpr Time kSettleAfterEvidence = std::chrono::milliseconds{500};
constexpr Time kLastLookTime = std::chrono::seconds{1};

template <std::size_t N>
bool begins_with_any(std::string_view line, const std::array<std::string_view, N>& texts) {
  return std::any_of(texts.begin(), texts.end(), [line](std::string_view text) {
    return !text.empty() && starts_with_text(line, text);
  });
}

}  // namespace

CommandClient::~CommandClient() {
  for (Pending& p : pending_) {
    end(p, JobState::kFailed, "the session has ended");
  }
}

Job<CommandResult> CommandClient::start(link::Command command) {
  const auto rule = std::find_if(kRules.begin(), kRules.end(),
                                 [command](const CommandRule& r) { return r.command == command; });
  Pending p;
  p.job = std::make_shared<JobRecord<CommandResult>>();
  p.job->started = port_.now();
  p.job->result.command = command;
  if (rule == kRules.end() || find(command) != nullptr) {
    p.job->state = JobState::kFailed;
    p.job->finished = port_.now();
    p.job->text = rule == kRules.end() ? "no such command"
                                       : std::string(rule->name) + ": already in progress";
    return Job<CommandResult>(p.job);
  }
  p.rule = &*rule;
  p.due = port_.now();
  p.job->text = std::string(rule->name) + ": waiting for the acknowledge";
  p.parameter_revision = parameters_.revision();
  for (std::size_t i = 0; i < kMaxEvidence; ++i) {
    p.before[i] = parameters_.get(rule->evidence[i]);
  }
  const Job<CommandResult> job(p.job);
  pending_.push_back(std::move(p));
  due_ = Time{};
  port_.wake();
  return job;
}

CommandClient::Pending* CommandClient::find(link::Command command) {
  const auto it = std::find_if(pending_.begin(), pending_.end(), [command](const Pending& p) {
    return !p.ended && p.rule->command == command;
  });
  return it == pending_.end() ? nullptr : &*it;
}

void CommandClient::run(bool link_open) {
  const Time now = port_.now();
  for (Pending& p : pending_) {
    if (p.good_until_contradicted) {
      if (now >= *p.good_until_contradicted) {
        end(p, JobState::kDone, p.good_text);
      }
    } else if (now >= p.due) {
      if (p.phase == Phase::kAwaitAck && link_open && (p.attempts == 0 || p.rule->repeatable) &&
          p.attempts < options_.attempts) {
        transmit(p);
      } else if (p.phase == Phase::kAwaitAck && p.attempts == 0 &&
                 now - p.job->started < options_.ack_timeout) {
        p.due = now + kQueueFull;  // closed link: it may open in time
      } else {
        overdue(p);
      }
    }
  }
  sweep();
}

void CommandClient::transmit(Pending& p) {
  const Time now = port_.now();
  if (!port_.send(link::CommandRequest{static_cast<std::uint8_t>(p.rule->command)}, kOrdinary)) {
    p.due = now + kQueueFull;
    return;
  }
  ++p.attempts;
  p.due = now + (p.rule->slow_ack ? options_.storage_timeout : options_.ack_timeout);
  if (p.rule->ends == Ends::kWithRestart || p.rule->ends == Ends::kWithSilence) {
    p.due = now + options_.reboot_timeout;
  }
}

void CommandClient::overdue(Pending& p) {
  if (p.phase == Phase::kAwaitAck) {
    end(p, JobState::kFailed, p.attempts == 0 ? "the link is closed" : "no answer");
  } else if (p.rule->ends == Ends::kWithRestart) {
    end(p, JobState::kFailed, "acknowledged, but no restart was seen");
  } else if (p.rule->ends == Ends::kWithSilence) {
    end(p, JobState::kFailed, "acknowledged, but the flight control unit goes on");
  } else if (p.phase == Phase::kAwaitResult) {
    ask_for_evidence(p);
  } else {
    end(p, JobState::kFailed, "started, but no result came");
  }
}

void CommandClient::ask_for_evidence(Pending& p) {
  p.phase = Phase::kLastLook;
  p.due = port_.now() + kLastLookTime;
  for (const std::string_view text : p.rule->evidence) {
    if (const auto name = make_name(text)) {
      link::ParamRequestRead request;
      request.target_system = port_.target_system();
      request.name = *name;
      port_.send(request, kOrdinary);
    }
  }
}

void CommandClient::received(const link::CommandAck& ack) {
  Pending* const p = find(static_cast<Command>(ack.command));
  if (p == nullptr || p->phase != Phase::kAwaitAck || p->attempts == 0) {
    return;
  }
  if (ack.success) {
    p->job->result.acknowledged = true;
    acknowledged(*p);
  } else {
    end(*p, JobState::kFailed, armed_ ? "refused: the vehicle is armed" : "refused");
  }
  settle();
}

void CommandClient::acknowledged(Pending& p) {
  const Time now = port_.now();
  switch (p.rule->command) {
    case Command::kWriteParams:
      parameters_.written(p.parameter_revision);
      break;
    case Command::kReadParams:
      parameters_.reloaded_from_storage();
      break;
    case Command::kSetParamDefaults:
      parameters_.start_list();
      break;
    default:
      break;
  }
  if (p.rule->ends == Ends::kWithAck) {
    end(p, JobState::kDone, "done");
    return;
  }
  p.phase = Phase::kAwaitResult;
  p.due = now + (p.rule->ends == Ends::kWithResult ? options_.calibration_timeout
                                                   : options_.reboot_timeout);
  p.job->text = std::string(p.rule->name) + ": started";
}

void CommandClient::received(const link::StatusText& line) {
  const std::string_view text = text_of(line.text);
  for (Pending& p : pending_) {
    // Before the acknowledge, a result is one of an earlier run; but the acknowledge may have been
    // lost.
    const bool counts = !p.ended && (p.phase != Phase::kAwaitAck || p.attempts > 1);
    if (!counts || p.rule->ends != Ends::kWithResult) {
      continue;
    }
    if (begins_with_any(text, p.rule->failure)) {
      p.job->result.fcu_text = text;
      end(p, JobState::kFailed, std::string(text));
    } else if (begins_with_any(text, p.rule->success)) {
      p.job->result.fcu_text = text;
      p.good_text = text;
      p.good_until_contradicted = port_.now() + kSettleAfterText;
    }
  }
  settle();
}

void CommandClient::received(const link::ParamValue& value) {
  const std::string_view name = text_of(value.name);
  for (Pending& p : pending_) {
    const auto& names = p.rule->evidence;
    const auto it = std::find(names.begin(), names.end(), name);
    if (name.empty() || it == names.end() || p.ended || p.phase == Phase::kAwaitAck) {
      continue;
    }
    p.latest[static_cast<std::size_t>(it - names.begin())] =
        ParameterValue{value.type, value.value};
    if (!p.good_until_contradicted && evidence_complete(p)) {
      p.good_text = "new values received";
      p.good_until_contradicted = port_.now() + kSettleAfterEvidence;
    }
  }
  settle();
}

bool CommandClient::evidence_complete(const Pending& p) const {
  bool any_new = false;
  for (std::size_t i = 0; i < kMaxEvidence; ++i) {
    if (p.rule->evidence[i].empty()) {
      continue;
    }
    const ParameterValue latest = p.latest[i].value_or(ParameterValue{});
    if (latest.number() == 0.0) {
      return false;
    }
    const std::optional<ParameterValue>& before = p.before[i];
    any_new = any_new || !before || !same_value(*before, latest);
  }
  return any_new;
}

void CommandClient::fcu_restarted() {
  for (Pending& p : pending_) {
    const bool wanted = p.rule->ends == Ends::kWithRestart || p.rule->ends == Ends::kWithSilence;
    if (wanted && p.attempts > 0) {
      end(p, JobState::kDone, "restarted");
    } else if (p.phase != Phase::kAwaitAck) {
      end(p, JobState::kFailed, "the flight control unit restarted");
    }
  }
  settle();
}

void CommandClient::connection_lost() {
  for (Pending& p : pending_) {
    if (p.rule->ends == Ends::kWithSilence && p.attempts > 0) {
      end(p, JobState::kDone, "the flight control unit has left");
    } else if (p.rule->ends != Ends::kWithRestart || p.attempts == 0) {
      end(p, JobState::kFailed, "connection lost");
    }
  }
  settle();
}

void CommandClient::end(Pending& p, JobState state, const std::string& text) {
  if (!p.ended) {
    p.ended = true;
    ends_.finish(p.job, state, std::string(p.rule->name) + ": " + text, port_.now());
  }
}

void CommandClient::sweep() {
  std::erase_if(pending_, [](const Pending& p) { return p.ended; });
  due_ = kNever;
  for (const Pending& p : pending_) {
    due_ = std::min(due_, p.good_until_contradicted.value_or(p.due));
  }
  ends_.flush();
}

// After a message, which may have brought the due time forward. In run() a wake would only start it again.
void CommandClient::settle() {
  sweep();
  if (due_ != kNever) {
    port_.wake();
  }
}

void CommandClient::copy_state_of(const CommandClient& other) {
  due_ = other.due_;
  armed_ = other.armed_;
}

}  // namespace rosflight::companion
