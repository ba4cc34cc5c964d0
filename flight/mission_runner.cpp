// SPDX-License-Identifier: BSD-3-Clause
#include "flight/mission_runner.hpp"

#include <fmt/format.h>

#include <limits>

#include "flight/true_state.hpp"
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
    grounded_since_ = last_received_ = now_;
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
  constexpr double kMaxSilence_s = 10.0;
  constexpr sim::Time kStandstill = std::chrono::milliseconds(100);
  const bool in_air = guidance_.output().in_air;
  const double tilt_cosine = (truth.body.q_WB * sim::Vector3::UnitZ()).z();
  constexpr double kOverturned = 0.3;
  const bool stood_still =
      now_ - checked_ > kStandstill;  // of the companion: nobody landed meanwhile
  checked_ = now_;
  const bool as_meant = !truth.on_ground || (!in_air && tilt_cosine > kOverturned);
  if (as_meant || stood_still) grounded_since_ = now_;
  if (session_.connected()) last_received_ = now_;
  if (sim::to_seconds(now_ - grounded_since_) > kMaxOnGround_s) return fail("came down in flight");
  if (sim::to_seconds(now_ - last_received_) > kMaxSilence_s) return fail("link lost in flight");
  if (disarmed_) return fail("disarmed in flight");
}

void MissionRunner::update_estimate(const sim::Truth& truth) {
  if (config_.on_truth) {
    estimate_ = true_state(truth);
    return;
  }
  estimate_ = estimate_source_.estimate();
  constexpr double kMaxAge_s = 0.5;
  const bool stale = sim::to_seconds(now_) - estimate_.t_s > kMaxAge_s;
  if (estimate_source_.health().initialised && !stale) return;
  estimate_.p_W.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// What the firmware reported last of its outputs, unless that is old.
std::span<const float> MissionRunner::outputs() const {
  constexpr double kMaxAge_s = 0.1;
  const auto& output = session_.streams().output;
  const bool fresh =
      output.count > 0 &&
      sim::to_seconds(now_) - companion::to_seconds(output.stamp.arrival) < kMaxAge_s;
  if (!fresh) return {};
  return output.value.values;
}

/// The newest reading of the range sensor [m], if it is fresh and in range. A vehicle may stand at the near
/// end of the range: noise takes every other reading below it then.
std::optional<double> MissionRunner::range() const {
  constexpr double kMaxAge_s = 0.2;
  const auto& range = session_.streams().range;
  const double reading_m = static_cast<double>(range.value.range_m);
  const bool fresh = range.count > 0 &&
                     sim::to_seconds(now_) - companion::to_seconds(range.stamp.arrival) < kMaxAge_s;
  constexpr double kNearEnd = 0.8;  // of the shortest range
  const bool inside = reading_m >= kNearEnd * static_cast<double>(range.value.min_m) &&
                      reading_m < static_cast<double>(range.value.max_m);
  return fresh && inside && config_.use_range ? std::optional(reading_m) : std::nullopt;
}

/// Notes what changes in the estimate. What follows from it is the guidance's to decide.
void MissionRunner::report_estimate() {
  const autonomy::estimation::EstimatorHealth& health = estimate_source_.health();
  if (!health.initialised) return;
  if (estimate_.horizontal != horizontal_) {
    horizontal_ = estimate_.horizontal;
    if (horizontal_ == autonomy::Quality::kGood) {
      note(Severity::kInfo, "estimator", "position aided");
    } else {
      const bool lost = horizontal_ == autonomy::Quality::kNone;
      note(lost ? Severity::kError : Severity::kWarning, "estimator",
           lost ? "position lost" : "position by dead reckoning");
    }
  }
  if (estimate_.position_unreliable != position_unreliable_) {
    position_unreliable_ = estimate_.position_unreliable;
    note(position_unreliable_ ? Severity::kWarning : Severity::kInfo, "estimator",
         position_unreliable_ ? fmt::format("position unreliable: 3 sigma above {:.0f} m",
                                            autonomy::StateEstimate::kUnreliable_m)
                              : "position reliable again");
  }
  const bool heading = estimate_.heading == autonomy::Quality::kGood;
  if (heading != heading_good_) {
    heading_good_ = heading;
    note(heading ? Severity::kInfo : Severity::kWarning, "estimator",
         heading ? "heading aided" : "heading by the gyro alone");
  }
  const std::uint64_t resets =
      health.gnss_resets + health.baro_relearned + health.ground_relearned + health.restarts;
  if (resets == resets_) return;
  resets_ = resets;
  note(Severity::kWarning, "estimator",
       fmt::format("resets: to GNSS {}, barometer's bias {}, ground {}, all {}", health.gnss_resets,
                   health.baro_relearned, health.ground_relearned, health.restarts));
}

/// Sends the estimated attitude to the firmware as external attitude. The firmware's own filter uses
/// gyro and accelerometer alone: drag and turns bias its tilt. Right after a hole in the data, as of a
/// firmware that restarted, it knows the tilt better than the estimate.
void MissionRunner::send_attitude() {
  constexpr double kSure_rad = 0.05;
  const bool good = estimate_source_.health().initialised && estimate_.p_W.allFinite() &&
                    estimate_.attitude == autonomy::Quality::kGood &&
                    estimate_.attitude_sigma_B_rad.head<2>().maxCoeff() < kSure_rad;
  if (!config_.share_attitude || offboard_paused_ || !good) return;
  const autonomy::Quaternion& q = estimate_.q_WB;
  link::ExternalAttitude attitude;
  attitude.q_WB = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z())};
  static_cast<void>(session_.offboard().send(attitude));
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
                           .outputs = outputs()};
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
