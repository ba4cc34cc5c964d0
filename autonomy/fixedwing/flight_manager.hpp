// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/fixedwing/guidance.hpp"

namespace rosflight::autonomy::fixedwing {

/// Output of one step.
struct FlightOutput : GuidanceOutput {
  FirmwareCommand command{};  ///< Mode pass-through: u0 throttle, u3 roll, u4 pitch, u5 yaw.
  bool tracking{};            ///< On a path of the mission, and we hold all axes.
  ControllerCommand wanted{};
  Controller::Output control{};
};

/// Surfaces as a command of mode pass-through.
FirmwareCommand command_of(const Surfaces& s);

/// A whole flight of a fixed wing: take-off, mission, landing.
///
///     guidance (phases, path manager) -> path follower -> controller -> firmware command
///
/// A landing without a course goes along the take-off, or against it if that is down the wind.
///
/// step() is called at any rate, 50 Hz and up; the control period is the difference of the times
/// given. It allocates where a path begins.
///
/// The flight starts when the vehicle is armed and no axis is the pilot's, in the direction it
/// points, and happens once. What stops it, and how:
/// - state not finite or without attitude: the last command for kStateGrace_s, then a glide with level
///   wings (LevelGlide) by the flight controller's attitude. Without that either the throttle is closed and the
///   surfaces are the flight controller's, which holds them as FW_ANGLE_HOLD says;
/// - link silent (GapWatch): all channels are ignored, which hands the vehicle to the pilot;
/// - position without aiding longer than dead_reckoning_s: circles at a fixed bank, height and
///   airspeed held, until the position is back;
/// - airspeed unknown: throttle by feed-forward, height by pitch;
/// - motor out (full throttle, energy falls): glides, circling the landing point, straight on below
///   straight_below_m, flares;
/// - the pilot takes an axis: circles, and goes on with the same waypoint when it is given back.
class FlightManager {
 public:
  static constexpr double kStateGrace_s = Guidance::kStateGrace_s;

  struct Input {
    double t_s{};  ///< Must grow.
    const StateEstimate& state;
    Status status{};
    std::optional<double> range_m;  ///< Along the body's z axis, from the centre of mass.
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    RawMotion raw{};  ///< For a flight without a state.
  };

  /// Throws std::invalid_argument for a mission without waypoints.
  FlightManager(const FlightConfig& config, const Mission& mission);

  /// A step at a time not after the last repeats the last output without events.
  const FlightOutput& step(const Input& in);

  /// Lands after the present step; set_mission() cancels it.
  void request_land() { guidance_.request_land(); }
  /// Returns to the position of the start and circles there; set_mission() cancels it.
  void request_return() { guidance_.request_return(); }
  /// Another mission, also in flight. May allocate.
  void set_mission(const Mission& mission);
  /// Gains and limits change in flight, integrals stay; a path that has begun stays as it was planned.
  void configure(const FlightConfig& config);

  const FlightOutput& output() const { return out_; }
  const FlightConfig& config() const { return guidance_.config(); }
  const PathManager& path() const { return guidance_.path(); }

 private:
  void glide_level(const RawMotion& raw);

  Guidance guidance_;
  PathFollower follower_;
  Controller controller_;
  FlightOutput out_{};
};

}  // namespace rosflight::autonomy::fixedwing
