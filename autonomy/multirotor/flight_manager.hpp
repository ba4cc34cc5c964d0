// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>

#include "autonomy/multirotor/controller.hpp"
#include "autonomy/multirotor/mission.hpp"
#include "autonomy/multirotor/path_manager.hpp"
#include "autonomy/multirotor/state_machine.hpp"
#include "autonomy/multirotor/trajectory_follower.hpp"

namespace rosflight::autonomy {

struct FlightConfig {
  PathConfig path{};
  FollowerConfig follower{};
  ControllerConfig controller{};
  StateMachineConfig states{};
  ThrustModel thrust;
};

enum class FlightEventType : std::uint8_t {
  kPhase,            ///< index: the new Phase.
  kWaypointReached,  ///< index: the waypoint; value: distance [m].
  kWaypointMissed,   ///< The same; it waited arrival_timeout_s for the vehicle.
  kMissionDone,
  kTakeoffFailed,
  kPilotTookOver,
  kPilotGaveBack,
  kStateLost,  ///< The state is not finite: the vehicle is handed to the pilot.
  kStateRegained
};

struct FlightEvent {
  FlightEventType type{};
  std::size_t index{};
  double value{};
};

/// Everything there is to say about one step.
struct FlightOutput {
  static constexpr std::size_t kMaxEvents = 8;

  FirmwareCommand command{};
  Phase phase{Phase::kDisarmed};
  Trajectory setpoint{};   ///< What the vehicle is meant to be at.
  bool tracking{};         ///< The setpoint is the mission's path, and we hold all axes.
  std::size_t waypoint{};  ///< Target of the present leg, counted from 0.
  double distance_m{};     ///< To that waypoint.
  double roll_rad{};       ///< Commanded.
  double pitch_rad{};
  double yaw_rate_rad_s{};
  double thrust_N{};
  bool mission_done{};
  bool landed{};
  bool request_disarm{};

  std::array<FlightEvent, kMaxEvents> events{};
  std::size_t event_count{};
};

/// A whole flight of a multirotor: take-off, mission, landing.
///
///     path manager -> trajectory follower -> [state machine] -> controller -> firmware command
///
/// step() is called at any rate, 100 Hz and up; the control period is the difference of the times
/// given. It allocates nothing and takes well under a microsecond.
///
/// The flight starts when the vehicle is armed and no axis is the pilot's, and happens once: after
/// the landing a new mission must be set. A leg that was interrupted (pilot, lost state) starts
/// anew from where the vehicle is. A state that is not finite: the last command is repeated for
/// kStateGrace_s, then all entries are given up, which hands the vehicle to the pilot.
class FlightManager {
 public:
  static constexpr double kStateGrace_s = 0.1;

  /// Throws std::invalid_argument if the mission cannot be flown with this configuration.
  /// @param law  flies the trajectories; none: a TrajectoryFollower.
  FlightManager(const FlightConfig& config, const Mission& mission,
                std::unique_ptr<TrajectoryLaw> law = nullptr);

  /// @param t_s  must grow; a step at a time not after the last repeats the last output without
  /// events.
  const FlightOutput& step(double t_s, const State& state, const Status& status);

  /// Land where it is; cannot be taken back.
  void request_land() { land_ = true; }
  /// Another mission, also in flight; a flight that has ended may start again. May allocate.
  void set_mission(const Mission& mission);

  const FlightOutput& output() const { return out_; }
  const FlightConfig& config() const { return config_; }

 private:
  void event(FlightEventType type, std::size_t index = 0, double value = 0.0);
  bool check_state(double t_s, const State& state);
  bool near_plan(const State& state) const;
  void start_path(double t_s, const State& state, const AttitudeView& attitude);
  ControllerCommand follow(double t_s, double dt_s, const State& state,
                           const AttitudeView& attitude, const PilotOverride& pilot);
  void hand_over(const StateMachine::Output& machine, double t_s, const State& state,
                 const AttitudeView& attitude);
  void note(const StateMachine::Output& machine, const PilotOverride& pilot);

  FlightConfig config_{};
  PathManager path_;
  std::unique_ptr<TrajectoryLaw> follower_;
  Controller controller_;
  StateMachine machine_;
  AtEnd at_end_{AtEnd::kLand};
  FlightOutput out_{};
  double last_t_s_{};
  double last_good_s_{};
  bool started_{false};
  bool state_lost_{false};
  bool pilot_{false};
  bool land_{false};
  bool flown_{false};  ///< Landed once with this mission.
  bool command_good_{true};
};

}  // namespace rosflight::autonomy
