// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/flight_progress.hpp"
#include "autonomy/common/gap_watch.hpp"
#include "autonomy/fixedwing/fault_monitor.hpp"
#include "autonomy/fixedwing/ground_detector.hpp"
#include "autonomy/fixedwing/level_glide.hpp"
#include "autonomy/fixedwing/phase_path.hpp"
#include "autonomy/fixedwing/takeoff_retry.hpp"

namespace rosflight::autonomy::fixedwing {

/// The action of follower and controller in one step.
enum class GuidanceAct : std::uint8_t {
  kRepeat,  ///< Nothing new: the last command again.
  kGiveUp,  ///< No link, or no state on the ground: every channel goes to the pilot.
  kIdle,    ///< On the ground: all zero.
  kFly,
  kGlideLevel  ///< No state: `direct`, by the flight controller's attitude (LevelGlide).
};

/// Output of guidance: inputs of follower and controller, and the state of the flight.
struct GuidanceOutput : FlightProgress<Phase> {
  GuidanceAct act{GuidanceAct::kRepeat};
  double dt_s{};                ///< Since the step before.
  bool restart{};               ///< A flight begins: the controller starts again.
  CurrentPath follow{};         ///< For the follower.
  Controller::Direct direct{};  ///< For the controller.

  PathManager::Output path{};
  bool
      on_path{};  ///< `follow` is that of `path`; else, as in a take-off, `path` is an earlier one.
  double height_above_ground_m{};
};

/// Guides a flight from take-off to landing: decides the phase and gives its path and direct
/// commands.
///
///     FaultMonitor, GroundDetector -> conditions -> kPhaseTable -> PhasePath -> output
///
/// FlightManager connects it with follower and controller; a system of nodes may run each in a node
/// of its own.
///
/// step() is called at any rate, 50 Hz and up; the control period is the difference of the times
/// given. It allocates where a path begins.
class Guidance {
 public:
  static constexpr double kStateGrace_s = FaultMonitor::kStateGrace_s;
  static constexpr double kTakeoffWait_s = 1.5;  ///< For a state, before a take-off.

  using Last = PhasePath::Last;
  struct Input {
    double t_s{};
    const StateEstimate& state;
    Status status{};
    std::optional<double> range_m;  ///< Along the body's z axis, from the centre of mass.
    Last last{};
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    RawMotion raw{};  ///< For a flight without a state.
  };

  /// Throws std::invalid_argument for a mission without waypoints.
  Guidance(const FlightConfig& config, const Mission& mission);

  /// t_s must grow; a step at a time not after the last is kRepeat, without events.
  const GuidanceOutput& step(const Input& in);

  /// Lands after the present step; set_mission() cancels it.
  void request_land() { land_ = true; }
  /// Returns to the position of the start and circles there; set_mission() cancels it. Battery and
  /// fence (FlightLimits) return too, and land when they are there.
  void request_return() { return_ = true; }
  /// Another mission, also in flight, from waypoint `first` on. A return that the battery has asked for goes on.
  void set_mission(const Mission& mission, std::size_t first = 0);
  /// The mission with more waypoints, other turns or another end, also in flight: goes on with waypoint `next`, and what was
  /// asked for stays. A mission that was done is done no more if `next` or its end is another. Its fence: set_fence().
  void revise_mission(const Mission& mission, std::size_t next);
  /// Another fence, also in flight: what the one before has asked for is over.
  void set_fence(const std::optional<Fence>& fence);
  /// Also in flight; a path that has begun stays as it was planned.
  void configure(const FlightConfig& config) {
    config_ = config;
    limits_.configure(config.battery);
  }

  const GuidanceOutput& output() const { return out_; }
  const FlightConfig& config() const { return config_; }
  const Mission& mission() const { return mission_; }
  const FlightLimits& limits() const { return limits_; }
  const PathManager& path() const { return phase_path_.path(); }

 private:
  bool descending() const;
  double height_above_ground_m(const Input& in);
  PhaseConditions conditions(const Input& in, bool pilot);
  PhasePath::Input path_input(const Input& in) const;
  void enter(Phase to, const Input& in);
  void update_phase(const Input& in);
  void watch_limits(const Input& in);
  void lead(const Input& in);
  void without_state(const Input& in);
  void rest();
  void end_gap(const Input& in);

  FlightConfig config_{};
  Mission mission_{};
  FaultMonitor faults_;
  FlightLimits limits_;
  GapWatch gap_;
  LevelGlide level_glide_;
  GroundDetector ground_;
  TakeoffRetry retry_;
  PhasePath phase_path_;
  GuidanceOutput out_{};
  Phase before_glide_{Phase::kDisarmed};  ///< Phase in which the state was lost.
  double last_t_s_{};
  double hold_until_s_{};  ///< After a long gap.
  double blind_s_{};       ///< Since the take-off began: without a state, or flown by the failsafe.
  double unhealthy_at_s_{};  ///< Last time without a state or a receiver.
  bool started_{false};
  OverrideWatch override_;
  bool pilot_{false};
  bool failsafe_{false};
  bool path_done_{false};
  bool land_{false};
  bool return_{false};
  bool gap_returns_{false};  ///< After the hold that follows a long gap.
  bool interrupted_{false};  ///< A long gap ends in this step.
  bool broken_off_{false};   ///< An interruption has ended the take-off on the ground.
  bool gliding_level_{false};
  bool rests_{false};  ///< On the ground without a state, until it is disarmed.
  bool flown_{false};
};

}  // namespace rosflight::autonomy::fixedwing
