// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

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

/// Everything there is to say about one step.
struct FlightOutput {
  static constexpr std::size_t kMaxEvents = 8;

  FirmwareCommand command{};  ///< Mode pass-through: u0 throttle, u3 roll, u4 pitch, u5 yaw.
  Phase phase{Phase::kDisarmed};
  bool tracking{};  ///< On a path of the mission, and we hold all axes.
  PathManager::Output path{};
  ControllerCommand wanted{};
  Controller::Output control{};
  double height_above_ground_m{};
  std::size_t waypoint{};  ///< Target, counted from 0.
  bool mission_done{};
  bool landed{};
  bool request_disarm{};

  std::array<FlightEvent, kMaxEvents> events{};
  std::size_t event_count{};
};

/// A whole flight of a fixed wing: take-off, mission, landing.
///
///     path manager -> path follower -> controller -> firmware command
///                   phases (take-off to landed) decide which path, or none
///
/// A landing without a course goes along the take-off, or against it if the wind asks for that.
///
/// step() is called at any rate, 50 Hz and up; the control period is the difference of the times
/// given. It allocates where a path begins.
///
/// The flight starts when the vehicle is armed and no axis is the pilot's, in the direction it
/// points, and happens once. What stops it, and how:
/// - state not finite or without attitude: the last command for kStateGrace_s, then all entries are
///   given up, which hands the vehicle to the pilot;
/// - position without aiding longer than dead_reckoning_s: circles at a fixed bank, height and
///   airspeed held, until the position is back;
/// - airspeed unknown: throttle by feed-forward, height by pitch;
/// - motor out (full throttle, energy falls): glides, circling the landing place, straight on below
///   straight_below_m, flares;
/// - the pilot takes an axis: circles, and goes on with the same waypoint when it is given back.
class FlightManager {
 public:
  static constexpr double kStateGrace_s = 0.1;

  struct Input {
    double t_s{};
    const StateEstimate& state;
    Status status{};
    std::optional<double> range_m;  ///< Along the body's z axis, from the centre of mass.
  };

  /// Throws std::invalid_argument for a mission without waypoints.
  FlightManager(const FlightConfig& config, const Mission& mission);

  /// t_s must grow; a step at a time not after the last repeats the last output without events.
  const FlightOutput& step(const Input& in);

  void request_land() { land_ = true; }
  void request_return() { return_ = true; }
  /// Another mission, also in flight.
  void set_mission(const Mission& mission);
  /// Gains change in flight.
  void configure(const ControllerConfig& controller, const FollowerConfig& follower);

  const FlightOutput& output() const { return out_; }
  const FlightConfig& config() const { return config_; }
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
  void fly(const Input& in, double dt_s, const PilotOverride& pilot);
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
  PathFollower follower_;
  Controller controller_;
  FlightOutput out_{};
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
