// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "autonomy/common/flight_events.hpp"
#include "autonomy/fixedwing/flight_config.hpp"
#include "autonomy/fixedwing/glide_flight.hpp"
#include "autonomy/fixedwing/gust_meter.hpp"
#include "autonomy/fixedwing/mission.hpp"
#include "autonomy/fixedwing/phases.hpp"

namespace rosflight::autonomy::fixedwing {

/// Direct commands on the ground and just above it: the throttle ramps to full, the rudder holds
/// the course, and the pitch command rises at the rotation airspeed.
/// @param since_s  time since the take-off began.
Controller::Direct takeoff_direct(const FlightConfig& config, double airspeed_m_s, double since_s,
                                  double course_rad);

/// The path and the direct commands of each phase of a flight.
///
/// Take-off, climb and rollout follow a straight line along the course of the start; mission,
/// return, approach, glide and flare a planned path; loiter and descent a circle. A landing without a course
/// goes along the take-off, or against it if that is down the wind. Guidance decides which phase
/// it is. begin() may allocate, nothing else does.
class PhasePath {
 public:
  /// Result of follower and controller in the step before.
  struct Last {
    bool throttle_full{};
    double throttle{};
    std::optional<double> wanted_height_m;
  };
  struct Input {
    double t_s{};
    const StateEstimate& state;
    const FlightConfig& config;
    const Mission& mission;
    Last last{};
    double height_above_ground_m{};
    bool position_lost{};
    bool motor_lost{};
  };
  struct Output {
    CurrentPath follow{};         ///< For the follower.
    Controller::Direct direct{};  ///< For the controller.
    bool planned{};               ///< `follow` is that of path().
  };

  /// Begins a phase at the present state. A path that cannot be planned adds kPathFault.
  /// @param waypoint  first target of kMission.
  void begin(Phase phase, std::size_t waypoint, const Input& in, FlightEvents& events);
  /// The pilot flies: kLoiter circles from here on, kTakeoff starts from here. No other phase
  /// changes.
  void restart(Phase phase, const Input& in);
  /// Path and direct commands of the phase, which has begun. Once a step.
  Output step(Phase phase, const Input& in);
  /// Drops the planned path: a new one has to begin.
  void stop() { path_.stop(); }

  /// The planned path.
  const PathManager& path() const { return path_; }
  /// Time since the phase began [s].
  double since_s(double t_s) const { return t_s - since_s_; }
  /// Where the take-off began.
  const Vector3& start_W() const { return start_W_; }
  /// The aim point, as high as the centre of mass is when it stands there.
  Vector3 landing_position_W(const Mission& mission) const;
  /// Height above ground at which the flare begins, for this sink rate [m].
  double flare_height_m(const LandingConfig& config, double sink_m_s) const;

 private:
  /// Radius that the bank can fly down the wind of now.
  double closest_turn_m(const Input& in, double airspeed_m_s) const;
  /// An airspeed near the ground, with a margin for the gusts of now.
  double in_gusts(double airspeed_m_s) const;
  double gust_margin_m_s(double airspeed_m_s) const;
  std::optional<PlanFault> start(const PlannerConfig& config, const PathStart& from,
                                 std::vector<Waypoint> waypoints, bool cycle, std::size_t first);
  void plan(const Input& in, const std::vector<Waypoint>& waypoints, bool cycle, std::size_t first,
            double radius_m, FlightEvents& events);
  void begin_approach(const Input& in, FlightEvents& events);
  void circle_here(const Input& in);
  GlideFlight::Input glide_input(const Input& in) const;
  CurrentPath straight_on(Phase phase, const FlightConfig& config) const;
  double flare_throttle(const Input& in, double airspeed_m_s) const;
  Controller::Direct direct(Phase phase, const Input& in) const;
  double choose_landing_course(const Input& in) const;

  PathManager path_;
  GustMeter gusts_;
  GlideFlight glide_;
  CurrentPath circle_{};  ///< Path in kLoiter, kDescent and a flare without a path.
  Vector3 start_W_{Vector3::Zero()};
  Vector3 climb_from_W_{Vector3::Zero()};
  double start_course_rad_{};
  double roll_course_rad_{};
  double flare_height_m_{};
  double flare_throttle_{};
  double since_s_{};
  double stepped_s_{};  ///< Time of the last step.
};

}  // namespace rosflight::autonomy::fixedwing
