// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/flight_director.hpp"

#include <fmt/format.h>

#include <limits>

#include "apps/fly/true_state.hpp"

namespace rosflight::apps {
namespace {

using link::Severity;
using sim::rc::Control;

/// How long each stage may take before the flight has failed [s].
double patience_s(Stage stage, double longest_flight_s) {
  switch (stage) {
    case Stage::kFly:
      return longest_flight_s;
    case Stage::kConfigure:
    case Stage::kCalibrate:
      return 30.0;
    default:
      return 15.0;
  }
}

double seconds(sim::Time t) {
  return static_cast<double>(t.count()) * 1e-6;
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

FlightDirector::FlightDirector(const DirectorConfig& config, companion::Session& session,
                               sim::rc::Pilot& pilot, Guide& guide, Navigator& navigator)
    : config_{config}, session_{session}, pilot_{pilot}, guide_{guide}, navigator_{navigator} {
  session_.add(*this);
  // The pilot holds the vehicle until the computer is ready.
  pilot_.set_switch(Control::kAttitudeOverride, true);
  pilot_.set_switch(Control::kThrottleOverride, true);
  pilot_.set_switch(Control::kAttitudeMode, true);
}

FlightDirector::~FlightDirector() {
  session_.remove(*this);
}

void FlightDirector::note(Severity severity, const char* source, const std::string& text) {
  if (notify_) notify_({now_, source, severity, text});
}

void FlightDirector::enter(Stage stage) {
  stage_ = stage;
  entered_ = now_;
  note(Severity::kInfo, "director", fmt::format("stage {}", stage_name(stage)));
}

void FlightDirector::fail(const std::string& why) {
  failure_ = why;
  stage_ = Stage::kFailed;
  note(Severity::kError, "director", why);
}

void FlightDirector::on_event(const companion::Event& event) {
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

void FlightDirector::step(sim::Time t, const sim::Truth& truth) {
  now_ = t;
  session_.step(t);
  if (finished()) return;
  if (seconds(now_ - entered_) > patience_s(stage_, config_.longest_flight_s)) {
    fail(fmt::format("stage {} took longer than {:.0f} s", stage_name(stage_),
                     patience_s(stage_, config_.longest_flight_s)));
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
      return disarm();
    case Stage::kDone:
    case Stage::kFailed:
      return;
  }
}

void FlightDirector::connect() {
  if (!session_.connected() || !session_.parameters().complete()) return;
  load_ = session_.parameters().load(config_.firmware);
  enter(Stage::kConfigure);
}

void FlightDirector::configure() {
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

void FlightDirector::calibrate() {
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

void FlightDirector::store() {
  if (command_.pending()) return;
  if (command_.failed()) return fail(fmt::format("writing parameters: {}", command_.text()));
  // From here on the IMU is as calibrated.
  navigator_.set_listening(!config_.on_truth);
  navigator_.restart();
  enter(Stage::kArm);
}

void FlightDirector::arm() {
  const link::Status& status = session_.streams().status.value;
  if (status.armed) {
    armed_at_ = now_;
    for (const Control c : {Control::kAttitudeOverride, Control::kThrottleOverride}) {
      pilot_.set_switch(c, false);
    }
    note(Severity::kInfo, "pilot", "gives control to the companion");
    countdown_ = 0;
    grounded_since_ = heard_ = now_;
    enter(Stage::kFly);
    return;
  }
  constexpr double kFreshFix_s = 1.0;
  const bool ready = config_.on_truth || (navigator_.estimate().usable() &&
                                          navigator_.health().gnss_age_s < kFreshFix_s);
  if (status.error_code == 0 && ready) pilot_.set_switch(Control::kArm, true);
}

/// The safety pilot's throttle: up to hover while the computer flies, so that whoever loses the
/// computer keeps the height.
void FlightDirector::keep_thumb_ready(const sim::Truth& truth) {
  constexpr double kHighEnough_m = 1.0;
  constexpr double kSinking = 0.9;
  const GuideOutput& doing = guide_.output();
  const bool up = -truth.body.p_N.z() > kHighEnough_m && !(doing.idle && doing.landed);
  double wanted = up ? config_.hover_stick : 0.0;
  if (doing.coming_down) wanted *= kSinking;
  if (static_cast<float>(wanted) == thumb_) return;
  thumb_ = static_cast<float>(wanted);
  pilot_.set(Control::kThrottle, thumb_);
}

/// A flight that cannot go on ends here: what a referee beside the field would see.
void FlightDirector::watch_for_the_end(const sim::Truth& truth) {
  constexpr double kLongestOnGround_s = 1.0;
  constexpr double kLongestSilence_s = 10.0;
  const bool in_air = guide_.output().in_air;
  const double tilt_cosine = (truth.body.q_NB * sim::Vector3::UnitZ()).z();
  constexpr double kOverturned = 0.3;
  if (!truth.on_ground || (!in_air && tilt_cosine > kOverturned)) grounded_since_ = now_;
  if (session_.connected()) heard_ = now_;
  if (seconds(now_ - grounded_since_) > kLongestOnGround_s) return fail("came down in flight");
  if (seconds(now_ - heard_) > kLongestSilence_s) return fail("link lost in flight");
  if (disarmed_) return fail("disarmed in flight");
}

void FlightDirector::look(const sim::Truth& truth) {
  if (config_.on_truth) {
    estimate_ = true_state(truth);
    return;
  }
  estimate_ = navigator_.estimate();
  constexpr double kStale_s = 0.5;
  const bool stale = seconds(now_) - estimate_.t_s > kStale_s;
  if (navigator_.health().initialised && !stale) return;
  estimate_.p_N.setConstant(std::numeric_limits<double>::quiet_NaN());  // guidance gives up
}

/// What the range sensor says now, if it says anything.
std::optional<double> FlightDirector::range() const {
  constexpr double kOld_s = 0.2;
  const auto& range = session_.streams().range;
  const double reading_m = static_cast<double>(range.value.range_m);
  const bool fresh =
      range.count > 0 && seconds(now_) - companion::to_seconds(range.stamp.arrival) < kOld_s;
  const bool inside = reading_m >= static_cast<double>(range.value.min_m) &&
                      reading_m < static_cast<double>(range.value.max_m);
  return fresh && inside && config_.use_range ? std::optional(reading_m) : std::nullopt;
}

/// Says what changes in the estimate; a position that is worth nothing ends the mission where it
/// is.
void FlightDirector::watch_the_estimate() {
  const autonomy::estimation::EstimatorHealth& health = navigator_.health();
  if (!health.initialised) return;
  if (estimate_.horizontal != horizontal_seen_) {
    horizontal_seen_ = estimate_.horizontal;
    if (horizontal_seen_ == autonomy::Trust::kGood) {
      note(Severity::kInfo, "estimator", "position aided");
    } else {
      const bool lost = horizontal_seen_ == autonomy::Trust::kNone;
      note(lost ? Severity::kError : Severity::kWarning, "estimator",
           lost ? "position lost, landing" : "position by dead reckoning");
      if (lost) guide_.request_land();
    }
  }
  const bool heading = estimate_.heading == autonomy::Trust::kGood;
  if (heading != heading_seen_) {
    heading_seen_ = heading;
    note(heading ? Severity::kInfo : Severity::kWarning, "estimator",
         heading ? "heading aided" : "heading by the gyro alone");
  }
  const std::uint64_t resets =
      health.gnss_resets + health.baro_relearned + health.ground_relearned + health.restarts;
  if (resets == resets_seen_) return;
  resets_seen_ = resets;
  note(Severity::kWarning, "estimator",
       fmt::format("resets: to GNSS {}, barometer's bias {}, ground {}, all {}", health.gnss_resets,
                   health.baro_relearned, health.ground_relearned, health.restarts));
}

/// The firmware's own filter has nothing but gyro and accelerometer: in drag and in turns it takes
/// what it feels for tilt. This is what ROSflight's external attitude is for.
void FlightDirector::share_the_attitude() {
  const bool good = navigator_.health().initialised && estimate_.p_N.allFinite() &&
                    estimate_.attitude == autonomy::Trust::kGood;
  if (!config_.share_attitude || mute_ || !good) return;
  const autonomy::Quaternion& q = estimate_.q_NB;
  link::ExternalAttitude attitude;
  attitude.q_NB = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z())};
  static_cast<void>(session_.offboard().send(attitude));
}

/// Once a second what the firmware counted, for the report; the last answer counts.
void FlightDirector::ask_for_counters() {
  constexpr sim::Time kEvery = std::chrono::seconds(1);
  if (now_ - asked_ < kEvery) return;
  asked_ = now_;
  static_cast<void>(session_.request_report(link::ReportKind::kCounters));
}

void FlightDirector::fly(const sim::Truth& truth) {
  if (--countdown_ > 0) return;
  ask_for_counters();
  countdown_ = config_.autonomy_every;
  keep_thumb_ready(truth);
  const link::Status& fcu = session_.streams().status.value;
  look(truth);
  if (!config_.on_truth) {
    watch_the_estimate();
    share_the_attitude();
  }
  autonomy::Status status;
  status.armed = fcu.armed;
  status.offboard = fcu.offboard;
  status.rc_override = fcu.rc_override;
  status.battery_voltage_V = static_cast<double>(session_.streams().battery.value.voltage_V);
  const Guide::Input in{
      .t_s = seconds(now_), .state = estimate_, .status = status, .range_m = range()};
  const GuideOutput& output = guide_.step(in, [this](const Guide::Note& said) { take(said); });
  if (!mute_) {
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
  watch_for_the_end(truth);
}

void FlightDirector::take(const Guide::Note& said) {
  note(said.severity, "autonomy", said.text);
  if (!said.waypoint) return;
  if (arrivals_.size() <= *said.waypoint) arrivals_.resize(*said.waypoint + 1);
  arrivals_[*said.waypoint] = {said.reached, said.distance_m, seconds(now_)};
}

void FlightDirector::disarm() {
  if (session_.streams().status.value.armed) return;
  disarmed_ = true;
  enter(Stage::kDone);
}

}  // namespace rosflight::apps
