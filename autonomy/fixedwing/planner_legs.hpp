// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "autonomy/fixedwing/dubins.hpp"
#include "autonomy/fixedwing/planner.hpp"

/// Inside of Planner: the legs between waypoints, before they are laid into one row of segments.
namespace rosflight::autonomy::fixedwing {

inline constexpr double kNothing_m = 1e-6;  // shorter is no length

/// What lies at the end of a leg: a waypoint, or the start.
struct Node {
  Passing passing{Passing::kLine};
  Pose pose{};
  double height_m{};
  double airspeed_m_s{};
  double radius_m{};  ///< kFillet; kCircle: signed, 0 while the sense is open.
  double hold_m{};    ///< kCircle: length of path on the circle.
  bool forever{};
  std::size_t waypoint{};
};

/// From one node to the next: arc, straight, arc; any of them may be empty.
struct Leg {
  std::array<DubinsPath::Part, 3> parts{};
  double cut_start_m{};  ///< Taken from the straight by fillets.
  double cut_end_m{};
  double length_m{kInfinity};
  double course_rad{};  ///< Course of the straight.

  double spare_m() const { return parts[1].length_m - cut_start_m - cut_end_m; }
  /// What each fillet at its ends can have more.
  double share_m() const {
    return cut_start_m > 0.0 && cut_end_m > 0.0 ? 0.5 * spare_m() : spare_m();
  }
};

/// The start, if there is one, then the waypoints from `first` on; a cycle until its second one again.
std::vector<Node> nodes_of(const std::optional<PathStart>& start,
                           std::span<const Waypoint> waypoints, bool cycle, std::size_t first,
                           const Planner& planner);
/// All legs, with the cuts of their fillets. Chooses open senses and the radii of fillets.
std::optional<PlanFault> make_legs(std::vector<Node>& nodes, bool from_start,
                                   const Planner& planner, std::vector<Leg>& legs);

}  // namespace rosflight::autonomy::fixedwing
