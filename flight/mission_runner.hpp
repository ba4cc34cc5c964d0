// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "companion/check_list.hpp"
#include "companion/session.hpp"
#include "flight/altitude_keeper.hpp"
#include "flight/guidance.hpp"
#include "flight/state_estimate_source.hpp"
#include "sim/modules.hpp"
#include "sim/rc/pilot.hpp"

namespace rosflight::flight {

/// Stages of a flight from power-up to disarmed, in this order.
enum class Stage : std::uint8_t {
  kConnect,    ///< Waiting for the link and the list of parameters.
  kConfigure,  ///< Loading the vehicle's firmware parameters.
  kCalibrate,  ///< IMU at rest.
  kStore,      ///< Writing the parameters to the firmware's memory.
  kArm,        ///< The pilot's switch.
  kFly,        ///< Mission, landing included.
  kDisarm,
  kDone,
  kFailed,
};
const char* stage_name(Stage stage);

struct MissionRunnerConfig {
  companion::ParameterSet firmware;  ///< Parameters of this vehicle.
  int autonomy_every{4};             ///< Guidance runs in every n-th step.
  double max_flight_s{600.0};        ///< Timeout of the stage kFly.
  double pilot_stick{0.5};           ///< The safety pilot's throttle from take-off to disarm.
  bool calibrate_airspeed{false};    ///< For a pitot tube, which is covered then.
  bool use_range{true};              ///< Guidance is given the range sensor.
  bool share_attitude{true};         ///< The estimated attitude goes to the firmware's filter.
  bool on_truth{false};              ///< Guidance is given the true state.
};

/// One line of the flight's event log.
struct FlightNote {
  sim::Time t{};
  std::string source;  ///< "mission" (the mission runner), "autonomy", "estimator", "companion",
                       ///< "fcu" or "pilot".
  link::Severity severity{link::Severity::kInfo};
  std::string text;
};

/// Runs one mission as companion computer and pilot: connects, loads the parameters, calibrates,
/// arms by radio, flies with offboard commands, lands and disarms. Each stage has a timeout.
///
/// Uses what a real companion has, unless `on_truth` is set. Only the checks that end a failed flight
/// use the true state. Unless he keeps its altitude, the pilot does not see the vehicle: he raises his throttle stick kTakeOff
/// after arming and lowers it after disarming. Companion time is simulated time.
class MissionRunner final : private companion::Listener {
 public:
  using Notify = std::function<void(const FlightNote&)>;
  /// Time from arming to the pilot's throttle stick.
  static constexpr sim::Time kTakeOff = std::chrono::seconds(1);

  MissionRunner(const MissionRunnerConfig& config, companion::Session& session,
                sim::rc::Pilot& pilot, Guidance& guidance, StateEstimateSource& estimate_source);
  ~MissionRunner() override;

  /// Receives every note of the flight; an empty function: none.
  void set_notify(Notify notify) { notify_ = std::move(notify); }

  /// Call it at the beginning of each step. @param truth  state of the vehicle at t.
  void step(sim::Time t, const sim::Truth& truth);

  /// While on, the pilot does not arm by himself.
  void set_hold(bool hold) { hold_ = hold; }

  /// While on, the pilot watches a multirotor and keeps its present altitude by his throttle stick.
  void set_keep_altitude(bool on) { altitude_.set(on); }

  /// A note of somebody else, at the time of the step.
  void report(link::Severity severity, const char* source, const std::string& text) {
    note(severity, source, text);
  }
  /// Ends the mission unless it has ended. @param why  failure(), one sentence without a full stop.
  void abort(const std::string& why) {
    if (!finished()) fail(why);
  }

  Stage stage() const { return stage_; }
  bool finished() const { return stage_ == Stage::kDone || stage_ == Stage::kFailed; }
  /// Empty unless stage() is kFailed.
  const std::string& failure() const { return failure_; }
  sim::Time armed_at() const { return armed_at_; }
  bool disarmed() const { return disarmed_; }
  /// The firmware's checks, as they were last before it armed.
  const companion::CheckList& checks() const { return checks_; }
  /// true: sends no offboard commands, as a companion that hangs; for tests.
  void set_offboard_paused(bool paused) { offboard_paused_ = paused; }

  const GuidanceOutput& output() const { return guidance_.output(); }
  /// The estimate that guidance received last.
  const autonomy::StateEstimate& estimate() const { return estimate_; }

 private:
  void on_event(const companion::Event& event) override;
  void connect();
  void configure();
  void calibrate();
  void store();
  void arm();
  std::string differing_thrust() const;
  void fly(const sim::Truth& truth);
  void update_estimate(const sim::Truth& truth);
  void report_estimate();
  void send_attitude();
  void disarm(const sim::Truth& truth);
  void request(link::ReportKind kind, sim::Time& requested);
  void move_throttle_stick(const sim::Truth& truth);
  void check_for_failure(const sim::Truth& truth);
  void enter(Stage stage);
  void fail(const std::string& why);
  void note(link::Severity severity, const char* source, const std::string& text);
  std::optional<double> range() const;
  std::span<const float> outputs() const;
  double silent_s() const;
  autonomy::RawMotion raw_motion() const;
  void watch_link(const sim::Truth& truth);

  MissionRunnerConfig config_;
  companion::Session& session_;
  sim::rc::Pilot& pilot_;
  Guidance& guidance_;
  StateEstimateSource& estimate_source_;
  autonomy::StateEstimate estimate_;
  autonomy::Vector3 accel_bias_B_{autonomy::Vector3::Zero()};  ///< As last estimated.
  std::uint64_t resets_{0};
  autonomy::Quality horizontal_{autonomy::Quality::kGood};
  bool heading_good_{true};
  bool position_unreliable_{false};
  Notify notify_;
  sim::Time now_{};
  sim::Time entered_{};
  sim::Time armed_at_{};
  Stage stage_{Stage::kConnect};
  sim::Time grounded_since_{};
  sim::Time checked_{};       ///< Last look for a failure.
  sim::Time flying_since_{};  ///< Last time above the ground.
  bool silence_noted_{false};
  sim::Time counters_requested_{};
  sim::Time checks_requested_{};
  int countdown_{0};
  float throttle_stick_{0.0F};
  bool offboard_paused_{false};
  bool hold_{false};
  AltitudeKeeper altitude_;
  bool arms_{false};  ///< The pilot has switched.
  bool disarmed_{false};
  bool airspeed_calibrated_{false};
  std::string failure_;
  companion::CheckList checks_;
  companion::Job<companion::LoadReport> load_;
  companion::Job<companion::CommandResult> command_;
};

}  // namespace rosflight::flight
