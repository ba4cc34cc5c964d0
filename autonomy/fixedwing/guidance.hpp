// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "autonomy/fixedwing/controller.hpp"
#include "autonomy/fixedwing/landing.hpp"
#include "autonomy/fixedwing/mission.hpp"
#include "autonomy/fixedwing/path_follower.hpp"
#include "autonomy/fixedwing/path_manager.hpp"
#include "autonomy/fixedwing/phases.hpp"

namespace rosflight::autonomy::fixedwing {

struct TakeoffConfig {
  double height_m{40.0};               ///< Above where it stands.
  double rotate_m_s{11.5};             ///< Airspeed at which the nose comes up,
  double pitch_rad{8.0 * kRadPerDeg};  ///< to this.
  double ramp_s{1.0};                  ///< Throttle from none to all.
  double airborne_m{4.0};
  double timeout_s{25.0};
  double margin_m{3.0};  ///< The climb ends this much below the height.
};

struct SafetyConfig {
  double dead_reckoning_s{30.0};  ///< A position without aiding is followed this long.
  double return_height_m{60.0};   ///< Above the start.
  double motor_out_s{3.0};        ///< Full throttle and losing energy for this long.
  double motor_out_m_s{0.5};      ///< Energy lost per weight, as a sink rate.
  double glide_m_s{14.0};         ///< Airspeed that sinks least, and some.
  double straight_below_m{20.0};  ///< A glide does not turn any more.
  double longest_range_m{8.0};    ///< Readings of the range sensor beyond count as none.
};

struct FlightConfig {
  PlannerConfig plan{};
  FollowerConfig follower{};
  ControllerConfig controller{};
  TakeoffConfig takeoff{};
  LandingConfig landing{};
  SafetyConfig safety{};
  double lead_s{0.5};  ///< Of the path (PathManager).
};

enum class FlightEventType : std::uint8_t {
  kPhase,           ///< index: the new Phase.
  kWaypointPassed,  ///< index: the waypoint; value: horizontal distance from it [m].
  kMissionDone,
  kTakeoffFailed,
  kPathFault,  ///< From here no path leads on: it circles.
  kMotorOut,
  kPlaceLost,
  kPilotTookOver,
  kPilotGaveBack,
  kStateLost,  ///< The state is not finite or has no attitude: the vehicle goes to the pilot.
  kStateRegained
};

struct FlightEvent {
  FlightEventType type{};
  std::size_t index{};
  double value{};
};

const char* name(FlightEventType type);

/// What the controller is told on the ground and just above it: full throttle by a ramp, the rudder
/// keeps the course, and the nose comes up when it is fast enough.
/// @param since_s  time since the take-off began.
Controller::Direct takeoff_direct(const FlightConfig& config, double airspeed_m_s, double since_s,
                                  double course_rad);

/// What follower and controller are meant to do with a step.
enum class GuidanceAct : std::uint8_t {
  kRepeat,  ///< Nothing new: the last command again.
  kGiveUp,  ///< No state: every entry goes to the pilot.
  kIdle,    ///< On the ground: all zero.
  kFly
};

/// What guidance asks of follower and controller, and what there is to say about it.
struct GuidanceOutput {
  static constexpr std::size_t kMaxEvents = 8;

  GuidanceAct act{GuidanceAct::kRepeat};
  double dt_s{};                ///< Since the step before.
  bool restart{};               ///< A flight begins: the controller starts anew.
  CurrentPath follow{};         ///< For the follower.
  Controller::Direct direct{};  ///< For the controller.

  Phase phase{Phase::kDisarmed};
  PathManager::Output path{};
  double height_above_ground_m{};
  std::size_t waypoint{};  ///< Target, counted from 0.
  bool mission_done{};
  bool landed{};
  bool request_disarm{};

  std::array<FlightEvent, kMaxEvents> events{};
  std::size_t event_count{};
};

/// Which path is flown when, and what the controller is told beside it: the phases of a flight
/// from take-off to landing, without follower and controller. FlightManager puts the three
/// together; a system of nodes may run each in its own place.
///
/// step() is called at any rate, 50 Hz and up; the control period is the difference of the times
/// given. It allocates where a path begins.
class Guidance {
 public:
  static constexpr double kStateGrace_s = 0.1;

  /// What follower and controller made of the last output.
  struct Last {
    bool throttle_full{};
    double throttle{};
    std::optional<double> wanted_height_m;
  };
  struct Input {
    double t_s{};
    const StateEstimate& state;
    Status status{};
    std::optional<double> range_m;  ///< Along the body's z axis, from the centre of mass.
    Last last{};
  };

  /// Throws std::invalid_argument for a mission without waypoints.
  Guidance(const FlightConfig& config, const Mission& mission);

  /// t_s must grow; a step at a time not after the last is kRepeat, without events.
  const GuidanceOutput& step(const Input& in);

  void request_land() { land_ = true; }
  void request_return() { return_ = true; }
  /// Another mission, also in flight, from waypoint `first` on.
  void set_mission(const Mission& mission, std::size_t first = 0);
  /// Also in flight; a path that has begun stays as it was planned.
  void configure(const FlightConfig& config) { config_ = config; }

  const GuidanceOutput& output() const { return out_; }
  const FlightConfig& config() const { return config_; }
  const Mission& mission() const { return mission_; }
  const PathManager& path() const { return path_; }

 private:
  void event(FlightEventType type, std::size_t index = 0, double value = 0.0);
  bool state_good(const Input& in);
  double measure_height(const Input& in);
  bool place_known(const Input& in);
  bool motor_out(const Input& in, double dt_s);
  bool on_ground(const Input& in, double dt_s);
  std::uint16_t conditions(const Input& in, double dt_s, bool pilot);
  void enter(Phase to, const Input& in);
  void begin_path(const Input& in, std::vector<Waypoint> waypoints, bool cycle, std::size_t first,
                  double radius_m);
  void lead(const Input& in);
  void follow_path(const Input& in);
  void circle_here(const Input& in);
  CurrentPath straight_on() const;
  Controller::Direct direct(const Input& in);
  double head_wind(const Input& in, double course_rad) const;
  double choose_landing_course(const Input& in) const;
  Vector3 landing_place_N() const;

  FlightConfig config_{};
  Mission mission_{};
  PathManager path_;
  GuidanceOutput out_{};
  CurrentPath here_{};  ///< Circle of kLoiter.
  Vector3 start_N_{Vector3::Zero()};
  Vector3 climb_from_N_{Vector3::Zero()};
  double start_course_rad_{};
  double landing_course_rad_{};
  double roll_course_rad_{};
  double standing_range_m_{};  ///< What the range sensor reads on the ground.
  double flare_height_m_{};
  double flare_throttle_{};
  double last_t_s_{};
  double since_s_{};
  double state_good_s_{};
  double place_good_s_{};
  double motor_bad_s_{};
  double ground_s_{};
  double still_s_{};
  bool range_seen_{false};
  bool started_{false};
  bool state_lost_{false};
  bool place_lost_{false};
  bool motor_lost_{false};
  bool pilot_{false};
  bool path_done_{false};
  bool land_{false};
  bool return_{false};
  bool flown_{false};
};

}  // namespace rosflight::autonomy::fixedwing
