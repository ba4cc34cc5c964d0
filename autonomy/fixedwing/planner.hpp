// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "autonomy/fixedwing/segment.hpp"

namespace rosflight::autonomy::fixedwing {

struct PlannerConfig {
  double radius_m{50.0};       ///< Turn radius.
  double closest_m{};          ///< Min radius of a fillet where legs are short; 0: radius_m.
  double climb_slope{0.15};    ///< Maximum altitude gained per distance.
  double descent_slope{0.15};  ///< Maximum altitude lost per distance.
  double airspeed_m_s{15.0};   ///< Where a waypoint says none.
};

/// Where a path begins in the air.
struct PathStart {
  Pose pose{};
  double height_m{};
};

/// Segments that join without a step in position, altitude or (but for corners) course.
struct Plan {
  static constexpr std::size_t kNoLoop = static_cast<std::size_t>(-1);
  std::vector<Segment> segments;
  std::size_t loop_to{kNoLoop};  ///< After the last segment comes this one.

  /// Radius of the arc on which a waypoint is passed first; infinite on a straight.
  double radius_at(std::size_t waypoint) const;
};

enum class PlanFaultKind : std::uint8_t {
  kTooClose,  ///< To the waypoint before: found and allowed are distances [m].
  kTurn,      ///< Its arc is longer than its legs: ways needed and there [m].
  kReversal,  ///< A fillet cannot turn back: found is the turn [rad].
  kTooSteep,  ///< The leg to it: slopes.
  kTooSteepDown,
  kUnreachable  ///< No path leads from the waypoint before to it: found is the distance [m].
};
struct PlanFault {
  PlanFaultKind kind{};
  std::size_t waypoint{};
  double found{};
  double allowed{};
};

/// Turns waypoints into a path that a fixed wing can fly.
///
/// Each leg is the shortest line between what lies at its ends: a point (kLine, kFillet), one of
/// two circles that touch a pose (kDubins and the start; with all six Dubins words between two
/// poses), or the circle of a kCircle. A corner of turn D between two lines gets a fillet
///
///     t = R tan(|D|/2)  cut from both lines,  arc R |D|                                    (1)
///
/// which fits if the cuts of both ends of a line leave something of it. With `closest_m` R is as wide as
/// they leave room for, shared evenly, up to `radius_m`. (Beard & McLain, Small
/// Unmanned Aircraft, 2012, sec. 11.1, algorithm 5; there t from the angle between the legs.)
///
/// Height: exactly that of the waypoint where it is passed, which for a fillet is the middle of its
/// arc; in between linear along the path, arcs included. A Dubins leg that is too steep for its length
/// begins with as many whole turns as it needs (Owen, Beard, McLain, Implementing Dubins airplane
/// paths on fixed-wing UAVs, 2015, "high altitude" case, with the radius kept and the slope eased).
class Planner {
 public:
  Planner() = default;
  /// radius_m and the slopes must be > 0.
  explicit Planner(const PlannerConfig& config) : config_(config) {}

  /// Path from `start` over the waypoints; without a start from the first waypoint on. With `cycle`
  /// it goes back to the first and then on for ever. Allocates.
  /// @param first  waypoint to fly to first; earlier ones are left out unless `cycle`.
  /// @return the fault, and then `out` is empty.
  std::optional<PlanFault> plan(const std::optional<PathStart>& start,
                                std::span<const Waypoint> waypoints, bool cycle, std::size_t first,
                                Plan& out) const;

  const PlannerConfig& config() const { return config_; }
  /// Radius that has to fit everywhere.
  double closest_m() const {
    return config_.closest_m > 0.0 ? config_.closest_m : config_.radius_m;
  }

 private:
  PlannerConfig config_{};
};

}  // namespace rosflight::autonomy::fixedwing
