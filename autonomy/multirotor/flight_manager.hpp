// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <span>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/flight_progress.hpp"
#include "autonomy/common/gap_watch.hpp"
#include "autonomy/common/raw_motion.hpp"
#include "autonomy/multirotor/commanded_flight.hpp"
#include "autonomy/multirotor/level_sink.hpp"
#include "autonomy/multirotor/mission.hpp"
#include "autonomy/multirotor/path_manager.hpp"
#include "autonomy/multirotor/rotor_watch.hpp"
#include "autonomy/multirotor/trajectory_follower.hpp"

namespace rosflight::autonomy::multirotor {

struct FlightConfig {
  PathConfig path{};
  FollowerConfig follower{};
  ControllerConfig controller{};
  StateMachineConfig states{};
  BatteryConfig battery{};
  double return_height_m{5.0};  ///< Min altitude of a return above the start.
  ThrustModel thrust;
  RotorWatchConfig rotor_watch{};
};

/// Output of one step.
struct FlightOutput : FlightProgress<Phase> {
  FirmwareCommand command{};
  bool tracking{};        ///< The setpoint is the mission's path, and we hold all axes.
  Trajectory setpoint{};  ///< Where the vehicle is meant to be.
  double distance_m{};    ///< To the waypoint.
  double roll_rad{};      ///< Commanded.
  double pitch_rad{};
  double yaw_rate_rad_s{};
  double thrust_N{};
};

/// A whole flight of a multirotor: take-off, mission, landing.
///
///     path manager -> trajectory follower -> CommandedFlight -> firmware command
///
/// step() is called at any rate, 100 Hz and up; the control period is the difference of the times
/// given. It allocates nothing and takes well under a microsecond.
///
/// The flight starts when the vehicle is armed and no axis is the pilot's, and happens once: after
/// the landing a new mission must be set. A leg that was interrupted (pilot, lost state) starts
/// again from where the vehicle is. A position that has been dead-reckoned for long is held, not
/// followed, until it has been aided for kPositionSettles_s: the estimate moves to the truth then.
/// A vehicle that has lost a rotor (RotorWatch) lands where it is; where yaw cannot be commanded any
/// more the commanded yaw rate is the measured one, so that no motor is spent on it. It tilts by
/// kLostTilt_rad at most: the other rotors have less left for turning.
/// Without a horizontal position it keeps level, and lands when that lasts kPositionWait_s. Battery
/// and fence (FlightLimits) let it return or land.
///
/// A state that is lost (not finite, or without a vertical part): the last command is repeated for
/// kStateGrace_s, then the vehicle sinks level to the ground (LevelSink). In a take-off that has not left the ground
/// the motors idle, and it is given up after kTakeoffWait_s. While the link is silent all channels are ignored
/// instead, which hands the vehicle to the pilot. Back again it goes on, or holds and returns (GapWatch).
class FlightManager {
 public:
  static constexpr double kStateGrace_s = CommandedFlight::kStateGrace_s;
  static constexpr double kPositionWait_s = 1.5;
  static constexpr double kLostTilt_rad = 20.0 * kRadPerDeg;
  static constexpr double kWatchHeight_m = 0.5;      ///< A landing below it watches no rotors.
  static constexpr double kPositionSettles_s = 5.0;  ///< In which an estimate shows its correction.
  static constexpr double kTakeoffWait_s = 1.5;      ///< For a state, on the ground.

  struct Input {
    double t_s{};  ///< Must grow.
    const State& state;
    Status status{};
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    std::optional<double> range_m{};  ///< Downward range, if fresh and in range.
    // NOLINTNEXTLINE(readability-redundant-member-init): the same
    std::span<const float> outputs{};  ///< Reported by the flight controller, if fresh.
    // NOLINTNEXTLINE(readability-redundant-member-init): the same
    RawMotion raw{};  ///< For a flight without a state.
  };

  /// Throws std::invalid_argument if the mission cannot be flown with this configuration.
  /// @param law  flies the trajectories; none: a TrajectoryFollower.
  FlightManager(const FlightConfig& config, const Mission& mission,
                std::unique_ptr<TrajectoryLaw> law = nullptr);

  /// A step at a time not after the last repeats the last output without events.
  const FlightOutput& step(const Input& in);

  /// Land where it is; cannot be taken back.
  void request_land() { control_.request_land(); }
  /// Back to the position of the take-off, return_height_m above it at least, and land there.
  void request_return() { return_asked_ = true; }
  /// Another mission, also in flight; a flight that has ended may start again. May allocate.
  void set_mission(const Mission& mission);
  /// Gains and limits change in flight, integrals and filters stay; a leg that has begun stays as it
  /// was planned. A law of the caller's own keeps its own.
  void configure(const FlightConfig& config);

  /// A step of the commanded altitude: while the mission's path is followed, it is flown this much higher. 0: as it is.
  /// Ends with the path: hold, pilot, return, landing.
  void set_altitude_offset(double offset_m);

  const FlightOutput& output() const { return out_; }
  const FlightConfig& config() const { return config_; }
  const RotorWatch& rotor_watch() const { return rotors_; }

 private:
  void start_path(double t_s, const State& state);
  void hand_over(double t_s, const State& state);
  ControllerCommand follow(double t_s, const State& state);
  void decide(const Input& in);
  bool position_settled(const Input& in);
  void watch_rotors(const Input& in);
  void give_up_yaw(const State& state);
  ControllerConfig controller_config() const;
  void begin_return(double t_s, const State& state);
  void learn_hover_thrust(const State& state);
  void end_gap(const Input& in);
  void without_state(const Input& in);
  void sink(const Input& in);
  void wait_on_ground(const Input& in);
  void rest();
  void enter_without_state(Phase phase);

  FlightConfig config_{};
  PathManager path_;
  std::unique_ptr<TrajectoryLaw> follower_;
  CommandedFlight control_;
  std::optional<double> takeoff_height_m_;  ///< Takeoff altitude of the mission.
  FlightLimits limits_;
  RotorWatch rotors_;
  std::optional<Fence> fence_;
  Vector3 start_W_{Vector3::Zero()};  ///< Position of the take-off.
  double unplaced_s_{};               ///< Without a horizontal position.
  double settled_s_{};                ///< When the position will have settled.
  double altitude_offset_m_{};        ///< Added to the altitude of the path.
  GapWatch gap_;
  LevelSink sink_;
  State known_{};            ///< The last state that was flown on.
  double hover_thrust_N_{};  ///< Without tilt and climb.
  double hold_until_s_{};    ///< After a long gap.
  bool gap_returns_{false};  ///< After that hold it returns.
  bool sinking_{false};
  bool rests_{false};  ///< On the ground without a state, until it is disarmed.
  FlightOutput out_{};
  AtEnd at_end_{AtEnd::kLand};
  bool return_asked_{false};
  bool returning_{false};
  bool flown_{false};  ///< Landed once with this mission.
  bool command_good_{true};
};

}  // namespace rosflight::autonomy::multirotor
