// SPDX-License-Identifier: BSD-3-Clause
#include "flight/mission_runner.hpp"

#include <fmt/format.h>

#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::flight {
namespace {

using link::Severity;
using sim::rc::Control;

/// Time after which a stage has failed [s].
double timeout_s(Stage stage, double max_flight_s) {
  switch (stage) {
    case Stage::kFly:
      return max_flight_s;
    case Stage::kConfigure:
    case Stage::kCalibrate:
      return 30.0;
    default:
      return 15.0;
  }
}

}  // namespace

const char* stage_name(Stage stage) {
  switch (stage) {
    case Stage::kConnect:
      return "connect";
    case Stage::kConfigure:
      return "configure";
    case Stage::kCalibrate:
      return "calibrate";
    case Stage::kStore:
      return "store";
    case Stage::kArm:
      return "arm";
    case Stage::kFly:
      return "fly";
    case Stage::kDisarm:
      return "disarm";
    case Stage::kDone:
      return "done";
    case Stage::kFailed:
      return "failed";
  }
  return "";
}

MissionRunner::MissionRunner(const MissionRunnerConfig& config, companion::Session& session,
                             sim::rc::Pilot& pilot, Guidance& guidance,
                             StateEstimateSource& estimate_source)
    : config_{config},
      session_{session},
      pilot_{pilot},
      guidance_{guidance},
      estimate_source_{estimate_source} {
  session_.add(*this);
  // The pilot has control until the companion is ready.
  pilot_.set_switch(Control::kAttitudeOverride, true);
  pilot_.set_switch(Control::kThrottleOverride, true);
  pilot_.set_switch(Control::kAttitudeMode, true);
}

MissionRunner::~MissionRunner() {
  session_.remove(*this);
}

void MissionRunner::note(Severity severity, const char* source, const std::string& text) {
  if (notify_) notify_({now_, source, severity, text});
}

void MissionRunner::enter(Stage stage) {
  stage_ = stage;
  entered_ = now_;
  note(Severity::kInfo, "mission", fmt::format("stage {}", stage_name(stage)));
}

void MissionRunner::fail(const std::string& why) {
  failure_ = why;
  stage_ = Stage::kFailed;
  note(Severity::kError, "mission", why);
}

void MissionRunner::on_event(const companion::Event& event) {
  if (stage_ <= Stage::kArm || !checks_.complete()) checks_.add(now_, event);
  if (const auto* log = std::get_if<companion::LogEvent>(&event)) {
    note(log->line.severity, "fcu", std::string{companion::text_of(log->line.text)});
  } else if (const auto* schema = std::get_if<companion::SchemaEvent>(&event)) {
    fail(companion::schema_text(*schema));
  } else if (const auto* link = std::get_if<companion::ConnectionEvent>(&event)) {
    if (link->change == companion::ConnectionChange::kLost) {
      note(Severity::kWarning, "companion", "link lost");
    } else if (link->change == companion::ConnectionChange::kConnected) {
      note(Severity::kInfo, "companion", "link up");
    } else if (link->change == companion::ConnectionChange::kRestarted) {
      note(Severity::kWarning, "companion", "firmware restarted");
    }
  }
}

void MissionRunner::step(sim::Time t, const sim::Truth& truth) {
  now_ = t;
  session_.step(t);
  if (finished()) return;
  if (sim::to_seconds(now_ - entered_) > timeout_s(stage_, config_.max_flight_s)) {
    fail(fmt::format("stage {} took longer than {:.0f} s", stage_name(stage_),
                     timeout_s(stage_, config_.max_flight_s)));
    return;
  }
  switch (stage_) {
    case Stage::kConnect:
      return connect();
    case Stage::kConfigure:
      return configure();
    case Stage::kCalibrate:
      return calibrate();
    case Stage::kStore:
      return store();
    case Stage::kArm:
      return arm();
    case Stage::kFly:
      return fly(truth);
    case Stage::kDisarm:
      return disarm(truth);
    case Stage::kDone:
    case Stage::kFailed:
      return;
  }
}

void MissionRunner::connect() {
  if (!session_.connected() || !session_.parameters().complete()) return;
  load_ = session_.parameters().load(config_.firmware);
  enter(Stage::kConfigure);
}

void MissionRunner::configure() {
  if (load_.pending()) return;
  if (!load_.result().ok()) {
    for (const companion::ParameterResult& entry : load_.result().entries) {
      if (!entry.ok()) return fail(fmt::format("firmware parameter {}", entry.text));
    }
    return fail(fmt::format("firmware parameters: {}", load_.text()));
  }
  command_ = session_.commands().start(link::Command::kAccelCalibration);
  enter(Stage::kCalibrate);
}

void MissionRunner::calibrate() {
  if (command_.pending()) return;
  if (command_.failed()) return fail(fmt::format("calibration: {}", command_.text()));
  if (config_.calibrate_airspeed && !airspeed_calibrated_) {
    airspeed_calibrated_ = true;
    command_ = session_.commands().start(link::Command::kAirspeedCalibration);
    return;
  }
  command_ = session_.commands().start(link::Command::kWriteParams);
  enter(Stage::kStore);
}

void MissionRunner::store() {
  if (command_.pending()) return;
  if (command_.failed()) return fail(fmt::format("writing parameters: {}", command_.text()));
  // The IMU is calibrated from here on.
  estimate_source_.set_enabled(!config_.on_truth);
  estimate_source_.restart();
  enter(Stage::kArm);
}

void MissionRunner::arm() {
  const link::Status& status = session_.streams().status.value;
  if (status.armed) {
    armed_at_ = now_;
    for (const Control c : {Control::kAttitudeOverride, Control::kThrottleOverride}) {
      pilot_.set_switch(c, false);
    }
    note(Severity::kInfo, "pilot", "gives control to the companion");
    countdown_ = 0;
    grounded_since_ = flying_since_ = now_;
    enter(Stage::kFly);
    return;
  }
  request(link::ReportKind::kChecks, checks_requested_);
  if (hold_) {
    entered_ = now_;  // its timeout waits too
    return;
  }
  constexpr double kMaxFixAge_s = 1.0;
  const bool ready = config_.on_truth || (estimate_source_.estimate().usable() &&
                                          estimate_source_.health().gnss_age_s < kMaxFixAge_s);
  if (status.error_code != 0 || !ready) return;
  if (const std::string differing = differing_thrust(); !differing.empty()) {
    return fail(fmt::format(
        "no take-off: the firmware has other motor parameters than the vehicle file: {}",
        differing));
  }
  if (!arms_) {
    checks_ = {};  // those of this moment count, to the last row
    static_cast<void>(session_.request_report(link::ReportKind::kChecks));
  }
  arms_ = true;
  pilot_.set_switch(Control::kArm, true);
}

/// The throttle of guidance is right for the parameters of the vehicle file alone.
std::string MissionRunner::differing_thrust() const {
  std::string out;
  for (const char* name : kThrustParameters) {
    const auto found = session_.parameters().get(name);
    const auto wanted = static_cast<float>(firmware_value(config_.firmware, name));
    if (found && static_cast<float>(found->number()) == wanted) continue;
    out += fmt::format("{}{} {} instead of {}", out.empty() ? "" : ", ", name,
                       found ? found->text() : "unknown", wanted);
  }
  return out;
}

/// The safety pilot holds his throttle stick where it carries the vehicle while the companion flies,
/// so that it keeps its altitude if the offboard commands stop.
void MissionRunner::move_throttle_stick(const sim::Truth& truth) {
  const bool up = stage_ == Stage::kFly && now_ - armed_at_ >= kTakeOff;
  const double carrying =
      altitude_.on() ? altitude_.stick(truth, config_.pilot_stick) : config_.pilot_stick;
  const float wanted = up ? static_cast<float>(carrying) : 0.0F;
  if (wanted == throttle_stick_) return;  // a script may have moved the stick since
  throttle_stick_ = wanted;
  pilot_.set(Control::kThrottle, wanted);
}

/// Ends a flight that cannot go on. Uses the true state, as an observer beside the field would.
void MissionRunner::check_for_failure(const sim::Truth& truth) {
  constexpr double kMaxOnGround_s = 1.0;
  constexpr sim::Time kStandstill = std::chrono::milliseconds(100);
  const bool in_air = guidance_.output().in_air;
  const double tilt_cosine = (truth.body.q_WB * sim::Vector3::UnitZ()).z();
  constexpr double kOverturned = 0.3;
  const bool stood_still =
      now_ - checked_ > kStandstill;  // of the companion: nobody landed meanwhile
  checked_ = now_;
  const bool as_meant = !truth.on_ground || (!in_air && tilt_cosine > kOverturned);
  if (as_meant || stood_still) grounded_since_ = now_;
  if (sim::to_seconds(now_ - grounded_since_) > kMaxOnGround_s) return fail("came down in flight");
  if (disarmed_) return fail("disarmed in flight");
  watch_link(truth);
}

/// A link that stays silent ends the flight: at rest on the ground, or when it is given up.
void MissionRunner::watch_link(const sim::Truth& truth) {
  using autonomy::GapWatch;
  constexpr double kAtRest_s = 1.0;
  const double silent_s = this->silent_s();
  if (!truth.on_ground) flying_since_ = now_;
  if (silent_s <= GapWatch::kGoesOn_s) {
    silence_noted_ = false;
    return;
  }
  if (!silence_noted_) {
    silence_noted_ = true;
    note(Severity::kWarning, "mission",
         fmt::format("link silent for {:.0f} s: if it comes back the vehicle holds, returns and "
                     "lands; given up after {:.0f} s",
                     GapWatch::kGoesOn_s, GapWatch::kGivesUp_s));
  }
  const bool rests = sim::to_seconds(now_ - flying_since_) > kAtRest_s;
  if (!rests && silent_s <= GapWatch::kGivesUp_s) return;
  note(Severity::kError, "mission",
       rests ? std::string("link silent, the vehicle rests on the ground")
             : fmt::format("link silent for {:.0f} s: the vehicle is given up for lost; its "
                           "firmware and the safety pilot have it",
                           GapWatch::kGivesUp_s));
  fail("link lost in flight");
}

/// Requests a report of the firmware once a second, for the flight folder.
void MissionRunner::request(link::ReportKind kind, sim::Time& requested) {
  constexpr sim::Time kEvery = std::chrono::seconds(1);
  if (now_ - requested < kEvery) return;
  requested = now_;
  static_cast<void>(session_.request_report(kind));
}

void MissionRunner::fly(const sim::Truth& truth) {
  if (--countdown_ > 0) return;
  request(link::ReportKind::kCounters, counters_requested_);
  countdown_ = config_.autonomy_every;
  move_throttle_stick(truth);
  const link::Status& fcu = session_.streams().status.value;
  update_estimate(truth);
  if (!config_.on_truth) {
    report_estimate();
    send_attitude();
  }
  autonomy::Status status;
  status.armed = fcu.armed;
  status.offboard = fcu.offboard;
  status.rc_override = fcu.rc_override;
  status.failsafe = fcu.failsafe;
  status.silent_s = silent_s();
  const auto& battery = session_.streams().battery;
  constexpr double kMaxBatteryAge_s = 2.0;
  status.battery_voltage_V = static_cast<double>(battery.value.voltage_V);
  status.battery_current_A = static_cast<double>(battery.value.current_A);
  status.battery_fresh =
      battery.count > 0 &&
      sim::to_seconds(now_) - companion::to_seconds(battery.stamp.arrival) < kMaxBatteryAge_s;
  const Guidance::Input in{.t_s = sim::to_seconds(now_),
                           .state = estimate_,
                           .status = status,
                           .range_m = range(),
                           .outputs = outputs(),
                           .raw = raw_motion()};
  const GuidanceOutput& output = guidance_.step(
      in, [this](const Guidance::Note& event) { note(event.severity, "autonomy", event.text); });
  if (!offboard_paused_) {
    link::OffboardControl command;
    command.mode = static_cast<std::uint8_t>(output.command.mode);
    command.ignore = output.command.ignore;
    command.u = output.command.u;
    static_cast<void>(session_.offboard().send(command));
  }
  if (output.request_disarm) {
    pilot_.set_switch(Control::kArm, false);
    enter(Stage::kDisarm);
    return;
  }
  disarmed_ = !fcu.armed && now_ - entered_ > std::chrono::seconds(1);
  check_for_failure(truth);
}

void MissionRunner::disarm(const sim::Truth& truth) {
  if (session_.streams().status.value.armed) return;
  disarmed_ = true;
  enter(Stage::kDone);
  move_throttle_stick(truth);
}

}  // namespace rosflight::flight
