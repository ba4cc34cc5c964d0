// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <variant>
#include <vector>

#include "autonomy/multirotor/figure_eight.hpp"
#include "autonomy/multirotor/leg.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

enum class Interpolation : std::uint8_t { kQuintic, kLinear };

struct PathConfig {
  LegLimits limits{};
  double waypoint_tolerance_m{0.5};   ///< Distance at which a waypoint counts as reached.
  double heading_tolerance_rad{0.2};  ///< The same for the heading.
  double arrival_timeout_s{10.0};     ///< Longest wait for the vehicle at the end of a leg.
  Interpolation interpolation{Interpolation::kQuintic};
  bool cycle{false};  ///< After the last waypoint the first again; else stay at the last.
};

/// Turns a list of waypoints into a trajectory, leg by leg.
///
/// A leg ends when its time is up AND the vehicle is within both tolerances. The setpoint waits in
/// the target meanwhile, exactly and at rest; after arrival_timeout_s the waypoint is reported
/// missed and the path goes on. Hold time counts from the arrival, on the clock of the caller. The
/// next leg starts in the setpoint, so position is continuous everywhere and, with quintic legs,
/// velocity and acceleration too.
///
/// Linear legs pass a goto waypoint at its speed, without waiting: reached or missed is judged at
/// the moment of passing. Speeds are lowered where 2 a_max d does not allow the change. Velocity
/// then jumps in direction at a corner: that is the price of the option.
///
/// A waypoint with a figure of eight is flown as one, from where the waypoint before it has led to;
/// started again after a pause it is an ordinary waypoint.
///
/// The clock runs from start() on, so a list can be given at any time before the flight.
class PathManager {
 public:
  enum class Event : std::uint8_t { kNone, kReached, kMissed };
  struct Output {
    Trajectory setpoint{};
    std::size_t waypoint{};  ///< Target of the present leg, counted from 0.
    double distance_m{};     ///< From the vehicle to that target.
    Event event{Event::kNone};
    std::size_t event_waypoint{};
    double event_distance_m{};  ///< Distance of the vehicle to event_waypoint.
    bool done{};                ///< The last waypoint is behind and there is no cycle.
  };

  PathManager() = default;
  /// Has no waypoints; nothing moves before start().
  explicit PathManager(const PathConfig& config) : config_(config) {}

  /// Replaces the whole list at once (empty: stay where the setpoint is) and forgets the progress,
  /// a running hold included. In flight the path leads on from the present setpoint. May allocate.
  void set_waypoints(std::vector<Waypoint> waypoints);

  /// One more at the end; progress stays. A path that was done goes on. May allocate.
  void append(const Waypoint& waypoint);

  /// Starts the clock of the leg to the present waypoint, from where the vehicle or its setpoint
  /// is. Also resumes after a pause; a hold that was interrupted starts over.
  void start(double t_s, const Trajectory& from);
  /// Stops the clock of the leg; start() resumes it. step() must not be called in between.
  void stop() { started_ = false; }
  /// Whether the first waypoint follows the last; takes effect when the last is reached.
  void set_cycle(bool cycle) { config_.cycle = cycle; }
  /// Takes effect with the next leg.
  void configure(const PathConfig& config);
  bool started() const { return started_; }

  /// Only after start(); t_s must not decrease.
  Output step(double t_s, const Vector3& p_W, double psi_rad);

  const std::vector<Waypoint>& waypoints() const { return waypoints_; }
  const PathConfig& config() const { return config_; }

 private:
  using Leg = std::variant<QuinticLeg, LinearLeg, FigureEightLeg>;
  void plan_speeds();
  void plan_leg(double t_s, const Trajectory& from);
  double leg_duration_s() const;
  Trajectory leg_sample(double t_s) const;
  void advance(double t_s, Output& out);
  void judge(Event event, double distance_m, Output& out);

  PathConfig config_{};
  std::vector<Waypoint> waypoints_;
  std::vector<double> passing_speed_m_s_;  ///< At each waypoint; 0 where the path stops.
  Leg leg_;
  Trajectory last_{};  ///< The setpoint of the last step,
  double last_s_{};    ///< and its time.
  std::size_t index_{};
  double leg_start_s_{};
  double arrival_s_{};
  double speed_m_s_{};  ///< Along the path at the start of the present leg.
  double leg_end_speed_m_s_{};
  bool started_{false};
  bool arrived_{false};
  bool judged_{false};  ///< The present waypoint has been reported.
  bool done_{false};
  bool replan_{false};
};

/// Is the vehicle where `setpoint` means it to be, and about as fast?
bool near_plan(const State& state, const Trajectory& setpoint);

/// Where a path begins that takes over from `setpoint`: in it, at rest, if the vehicle is near it;
/// else in the vehicle with its velocity.
Trajectory path_start(const State& state, double psi_rad, const Trajectory& setpoint);

/// A return: up to `height_m` above `home_W` where `from_W` is lower, down to `ceiling_m` above it where it is higher, then
/// over it at that height, with one heading.
std::vector<Waypoint> path_back(const Vector3& from_W, const Vector3& home_W, double height_m,
                                double ceiling_m, double psi_rad);

}  // namespace rosflight::autonomy::multirotor
