// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "flight/guidance.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// What the distance of a waypoint is measured to.
enum class PassMeasure : std::uint8_t {
  kPoint,  ///< The waypoint, where the vehicle is next to it.
  kFlyBy,  ///< The planned path, where the vehicle is next to the waypoint: rounded corners, circles.
  kFigure  ///< The planned path, where the vehicle is farthest from it: figures of eight.
};

/// Such as "point", "fly_by", "figure".
const char* measure_name(PassMeasure measure);

/// How near one waypoint was passed. NaN: never flown to.
struct WaypointPass {
  PassMeasure measure{PassMeasure::kPoint};
  double truth_distance_m{std::numeric_limits<double>::quiet_NaN()};
  double estimate_distance_m{std::numeric_limits<double>::quiet_NaN()};  ///< As guidance saw it.
  double t_s{std::numeric_limits<double>::quiet_NaN()};                  ///< Since power-up.

  /// @param radius_m  the mission's score radius.
  bool within(double radius_m) const { return truth_distance_m <= radius_m; }
};

/// Measures the passes of all waypoints of a mission, from the true position and, beside it, from
/// the estimated one. A waypoint counts only while it is the target of guidance and guidance flies
/// the mission; the distance from the path is that from the setpoint across its velocity, and it
/// counts once the waypoint is behind.
class WaypointScore {
 public:
  struct Target {
    sim::Vector3 p_W{sim::Vector3::Zero()};
    PassMeasure measure{PassMeasure::kPoint};
  };

  explicit WaypointScore(const std::vector<Target>& targets);

  /// Once per step of a flight. @param estimate_W  not finite: none.
  void step(double t_s, const sim::Vector3& truth_W, const sim::Vector3& estimate_W,
            const GuidanceOutput& output);

  /// One per waypoint, in the order of the mission.
  std::vector<WaypointPass> passes() const;

 private:
  struct Nearest {
    double to_point_m{std::numeric_limits<double>::infinity()};
    double measured_m{std::numeric_limits<double>::quiet_NaN()};
    double t_s{std::numeric_limits<double>::quiet_NaN()};
  };
  struct Pass {
    Target target;
    bool behind{false};
    Nearest truth;
    Nearest estimate;
  };
  static void follow(Nearest& nearest, const Target& target, double t_s, const sim::Vector3& p_W,
                     const GuidanceOutput& output);

  std::vector<Pass> passes_;
  std::size_t target_{0};
};

}  // namespace rosflight::flight
