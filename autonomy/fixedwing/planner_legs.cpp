// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/planner_legs.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMaxFillet_rad = 175.0 * kRadPerDeg;

struct Options {
  std::array<double, 2> radius_m{};
  std::size_t count{1};
};

Options circles_of(const Node& node, double radius_m) {
  if (node.passing == Passing::kDubins) return {{radius_m, -radius_m}, 2};
  if (node.passing != Passing::kCircle) return {};
  if (node.radius_m == 0.0) return {{radius_m, -radius_m}, 2};
  return {{node.radius_m, 0.0}, 1};
}

TurnCircle circle_of(const Node& node, double radius_m) {
  if (node.passing == Passing::kDubins) return TurnCircle::at(node.pose, radius_m);
  return {node.pose.p_m, radius_m};
}

/// Shortest path over one straight; chooses the open sense of a circle at its end.
Leg connect(const Node& from, Node& to, double radius_m) {
  Leg best;
  double sense = to.radius_m;
  const Options starts = circles_of(from, radius_m);
  const Options ends = circles_of(to, radius_m);
  for (std::size_t i = 0; i < starts.count; ++i) {
    for (std::size_t k = 0; k < ends.count; ++k) {
      const double s1 = starts.radius_m[i];
      const double s2 = ends.radius_m[k];
      const TurnCircle first = circle_of(from, s1);
      const TurnCircle last = circle_of(to, s2);
      const auto tangent = Tangent::between(first, last);
      if (!tangent) continue;
      const double chi = tangent->course_rad;
      const double turn1 =
          from.passing == Passing::kDubins ? swept_angle(from.pose.course_rad, chi, s1) : 0.0;
      const double turn2 =
          to.passing == Passing::kDubins ? swept_angle(chi, to.pose.course_rad, s2) : 0.0;
      Leg leg;
      leg.parts = {{{from.pose, s1, std::abs(s1) * turn1},
                    {{first.point(chi), chi}, 0.0, tangent->length_m},
                    {{last.point(chi), chi}, s2, std::abs(s2) * turn2}}};
      leg.course_rad = chi;
      leg.length_m = std::abs(s1) * turn1 + tangent->length_m + std::abs(s2) * turn2;
      if (leg.length_m < best.length_m - kNothing_m) {
        best = leg;
        sense = s2;
      }
    }
  }
  if (from.passing == Passing::kDubins && to.passing == Passing::kDubins) {
    const DubinsPath path = shortest_dubins_path(from.pose, to.pose, radius_m);
    if (path.length_m < best.length_m - kNothing_m) {
      best = Leg{path.parts, 0.0, 0.0, path.length_m, path.parts[1].start.course_rad};
    }
  }
  if (to.passing == Passing::kCircle) to.radius_m = sense;
  return best;
}

/// Fault of one leg by itself, and its course where it has none.
std::optional<PlanFault> make_leg(const Node& from, Node& to, bool from_start,
                                  const Planner& planner, Leg& leg) {
  const double distance_m = (to.pose.p_m - from.pose.p_m).norm();
  if (!from_start && distance_m < planner.closest_m()) {
    return PlanFault{PlanFaultKind::kTooClose, to.waypoint, distance_m, planner.closest_m()};
  }
  const double radius_m = planner.config().radius_m;
  leg = connect(from, to, radius_m);
  if (leg.length_m == kInfinity) {
    return PlanFault{PlanFaultKind::kUnreachable, to.waypoint, distance_m, 2.0 * radius_m};
  }
  return {};
}

double half_tangent(const Leg& before, const Leg& after) {
  return std::tan(0.5 * std::abs(wrap_angle(after.course_rad - before.course_rad)));
}

/// Cuts both legs for the arc between them.
std::optional<PlanFault> fit_fillet(const Node& node, Leg& before, Leg& after) {
  const double turn = wrap_angle(after.course_rad - before.course_rad);
  if (std::abs(turn) > kMaxFillet_rad) {
    return PlanFault{PlanFaultKind::kReversal, node.waypoint, std::abs(turn), kMaxFillet_rad};
  }
  before.cut_end_m = after.cut_start_m = node.radius_m * half_tangent(before, after);
  for (const Leg* leg : {&before, &after}) {
    if (leg->spare_m() < -kNothing_m) {
      return PlanFault{PlanFaultKind::kTurn, node.waypoint, leg->cut_start_m + leg->cut_end_m,
                       leg->parts[1].length_m};
    }
  }
  return {};
}

/// Fillets as wide as both legs have room for, the same whenever a cycle comes to them.
void widen_fillets(std::vector<Node>& nodes, std::vector<Leg>& legs, double radius_m) {
  std::size_t waypoints = 0;
  for (const Node& node : nodes) waypoints = std::max(waypoints, node.waypoint + 1);
  std::vector<double> wider_m(waypoints, kInfinity);
  for (std::size_t k = 1; k < legs.size(); ++k) {
    if (nodes[k].passing != Passing::kFillet) continue;
    const double room_m = std::min(legs[k - 1].share_m(), legs[k].share_m());
    const double tangent = std::max(half_tangent(legs[k - 1], legs[k]), kNothing_m);
    double& wider = wider_m[nodes[k].waypoint];
    wider = std::min({wider, room_m / tangent, radius_m - nodes[k].radius_m});
  }
  for (std::size_t k = 1; k < legs.size(); ++k) {
    if (nodes[k].passing != Passing::kFillet) continue;
    nodes[k].radius_m += std::max(wider_m[nodes[k].waypoint], 0.0);
    legs[k - 1].cut_end_m = legs[k].cut_start_m =
        nodes[k].radius_m * half_tangent(legs[k - 1], legs[k]);
  }
}

}  // namespace

std::vector<Node> nodes_of(const std::optional<PathStart>& start,
                           std::span<const Waypoint> waypoints, bool cycle, std::size_t first,
                           const Planner& planner) {
  const PlannerConfig& config = planner.config();
  std::vector<Node> nodes;
  const std::size_t n = waypoints.size();
  if (start) {
    Node node;
    node.passing = Passing::kDubins;
    node.pose = start->pose;
    node.height_m = start->height_m;
    nodes.push_back(node);
  }
  // A cycle ends at its second waypoint, and that one's fillet needs the third.
  const std::size_t count = cycle && n > 1 ? n + 3 : n - first;
  for (std::size_t k = 0; k < count; ++k) {
    const Waypoint& wp = waypoints[(first + k) % n];
    Node node;
    node.passing = wp.passing;
    node.pose = {wp.p_W.head<2>(), wp.course_rad};
    node.height_m = -wp.p_W.z();
    node.airspeed_m_s = wp.airspeed_m_s > 0.0 ? wp.airspeed_m_s : config.airspeed_m_s;
    node.waypoint = (first + k) % n;
    if (wp.passing == Passing::kFillet) node.radius_m = planner.closest_m();
    if (wp.passing == Passing::kCircle) {
      node.radius_m = wp.turn * config.radius_m;
      node.hold_m = wp.hold_s * node.airspeed_m_s;
      node.forever = wp.hold_indefinitely;
    }
    nodes.push_back(node);
  }
  return nodes;
}

std::optional<PlanFault> make_legs(std::vector<Node>& nodes, bool from_start,
                                   const Planner& planner, std::vector<Leg>& legs) {
  legs.resize(nodes.size() - 1);
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (auto fault = make_leg(nodes[k], nodes[k + 1], from_start && k == 0, planner, legs[k])) {
      return fault;
    }
  }
  for (std::size_t k = 1; k < legs.size(); ++k) {
    if (nodes[k].passing != Passing::kFillet) continue;
    if (auto fault = fit_fillet(nodes[k], legs[k - 1], legs[k])) return fault;
  }
  widen_fillets(nodes, legs, planner.config().radius_m);
  return {};
}

}  // namespace rosflight::autonomy::fixedwing
