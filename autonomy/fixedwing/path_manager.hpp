// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "autonomy/fixedwing/planner.hpp"

namespace rosflight::autonomy::fixedwing {

/// Leads along a plan: which segment is flown, and where on it the vehicle is.
///
/// A segment ends when the distance along it (Segment::progress) reaches its length; for segments
/// that join smoothly this is the half plane of Beard & McLain, Small Unmanned Aircraft, 2012, sec.
/// 11.1, and on arcs it counts turns, so no plane can be taken from the wrong side. At a corner the
/// plane bisects it: (p - w) . along(chi + corner/2) > 0, from a turn radius before the corner on.
///
/// The altitude reference is that of the path beside the vehicle. The path for the follower leads
/// it by `lead_m`, about the distance flown while the vehicle rolls: the fields of two segments
/// that join smoothly are the same there but for lead^2/(2 R), and the bank is there when the arc
/// begins. Corners are not led.
class PathManager {
 public:
  struct Output {
    CurrentPath path{};                 ///< Not valid before start() and after stop().
    Segment segment{};                  ///< The one that is flown.
    double progress_m{};                ///< Along it.
    double height_m{};                  ///< Reference.
    double cross_track_m{};             ///< Positive right of the path.
    std::size_t waypoint{};             ///< Target of the present leg.
    std::optional<std::size_t> passed;  ///< Waypoint that this step has passed.
    double passed_at_m{};               ///< Horizontal distance from it.
    bool done{};                        ///< The path ends; the last segment is extended.
  };

  PathManager() = default;
  /// Plans with these limits; there is no path before set_waypoints() and start().
  explicit PathManager(const PlannerConfig& config) : planner_(config) {}

  /// Replaces the list; the path is planned by start().
  void set_waypoints(std::vector<Waypoint> waypoints, bool cycle);
  /// Plans from here to waypoint `first` and on. Allocates.
  std::optional<PlanFault> start(const PathStart& from, std::size_t first = 0);
  /// Ends the path: output().path is not valid until the next start().
  void stop() { started_ = false; }
  bool started() const { return started_; }

  /// p_W finite. Every call may end at most a few segments, the last stays.
  const Output& step(const Vector3& p_W, double lead_m = 0.0);

  const std::vector<Waypoint>& waypoints() const { return waypoints_; }
  const Plan& plan() const { return plan_; }
  const Output& output() const { return out_; }
  const Planner& planner() const { return planner_; }

 private:
  bool over(const Segment& segment, const Vector2& p_m) const;
  std::size_t next() const;

  Planner planner_;
  std::vector<Waypoint> waypoints_;
  Plan plan_{};
  Output out_{};
  std::size_t index_{};
  double progress_m_{};
  bool cycle_{false};
  bool started_{false};
  bool done_{false};
};

}  // namespace rosflight::autonomy::fixedwing
