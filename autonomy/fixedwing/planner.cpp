// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/planner.hpp"

#include <algorithm>
#include <array>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kNothing_m = 1e-6;
constexpr double kNoTurn_rad = 1e-9;
constexpr double kMaxFillet_rad = 175.0 * kRadPerDeg;

/// What lies at the end of a leg: a waypoint, or the start.
struct Node {
  Passing passing{Passing::kLine};
  Pose pose{};
  double height_m{};
  double airspeed_m_s{};
  double radius_m{};  ///< kCircle: signed, 0 while the sense is open.
  double hold_m{};    ///< kCircle: way to stay.
  bool forever{};
  std::size_t waypoint{};
};

/// From one node to the next: arc, straight, arc; any of them may be empty.
struct Leg {
  std::array<DubinsPath::Part, 3> parts{};
  double cut_start_m{};  ///< Taken from the straight by fillets.
  double cut_end_m{};
  double length_m{kInfinity};
  double course_rad{};  ///< Of the straight.
};

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

/// Shortest way over one straight; chooses the open sense of a circle at its end.
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

/// Puts nodes and legs into one row of segments, with the places where a height is given.
class Row {
 public:
  explicit Row(Plan& plan) : plan_(plan) {}

  void add(const Pose& start, double radius_m, double length_m, const Node& target) {
    if (!(length_m > kNothing_m)) return;
    Segment s;
    s.start = {start.p_m, wrap_angle(start.course_rad)};
    s.radius_m = radius_m;
    s.length_m = length_m;
    s.airspeed_m_s = target.airspeed_m_s;
    s.waypoint = target.waypoint;
    plan_.segments.push_back(s);
  }

  void pass(double turn_rad) {
    if (plan_.segments.empty()) return;
    plan_.segments.back().passes_waypoint = true;
    plan_.segments.back().corner_rad = turn_rad;
  }

  /// From here back to the last mark the height changes evenly to height_m.
  std::optional<PlanFault> mark(double height_m, const Node& target, const PlannerConfig& config) {
    double path_m = path_length();
    if (marked_) {
      const double rise_m = height_m - height_m_;
      const double allowed = rise_m > 0.0 ? config.climb_slope : config.descent_slope;
      const double needed_m = std::abs(rise_m) / allowed;
      if (needed_m > path_m + kNothing_m && wind_up(needed_m - path_m, config.radius_m)) {
        path_m = path_length();
      }
      if (needed_m > path_m + kNothing_m) {
        return PlanFault{rise_m > 0.0 ? PlanFaultKind::kTooSteep : PlanFaultKind::kTooSteepDown,
                         target.waypoint, std::abs(rise_m) / std::max(path_m, kNothing_m), allowed};
      }
      double height = height_m_;
      for (std::size_t k = from_; k < plan_.segments.size(); ++k) {
        Segment& s = plan_.segments[k];
        s.height0_m = height;
        if (path_m > 0.0) height += rise_m * s.length_m / path_m;
        s.height1_m = height;
      }
      if (from_ < plan_.segments.size()) plan_.segments.back().height1_m = height_m;
    }
    marked_ = true;
    height_m_ = height_m;
    from_ = plan_.segments.size();
    may_wind_ = kNowhere;
    return {};
  }

  /// The next segment may be given whole turns in front of it, on this circle.
  void allow_turns(const Pose& pose, double radius_m, const Node& target) {
    if (may_wind_ != kNowhere) return;
    may_wind_ = plan_.segments.size();
    turn_ = Segment{};
    turn_.start = pose;
    turn_.radius_m = radius_m;
    turn_.airspeed_m_s = target.airspeed_m_s;
    turn_.waypoint = target.waypoint;
  }

  /// A segment at one height.
  void circle(const Pose& start, double radius_m, double length_m, const Node& node) {
    add(start, radius_m, length_m, node);
    if (plan_.segments.size() == from_) return;
    plan_.segments.back().height0_m = plan_.segments.back().height1_m = node.height_m;
    from_ = plan_.segments.size();
  }

 private:
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

  double path_length() const {
    double path_m = 0.0;
    for (std::size_t k = from_; k < plan_.segments.size(); ++k)
      path_m += plan_.segments[k].length_m;
    return path_m;
  }

  bool wind_up(double missing_m, double radius_m) {
    if (may_wind_ == kNowhere) return false;
    turn_.length_m = 2.0 * kPi * radius_m * std::ceil(missing_m / (2.0 * kPi * radius_m));
    plan_.segments.insert(plan_.segments.begin() + static_cast<std::ptrdiff_t>(may_wind_), turn_);
    return true;
  }

  Plan& plan_;
  Segment turn_{};
  std::size_t from_{};
  std::size_t may_wind_{kNowhere};
  double height_m_{};
  bool marked_{false};
};

std::vector<Node> nodes_of(const std::optional<PathStart>& start,
                           std::span<const Waypoint> waypoints, bool cycle, std::size_t first,
                           const PlannerConfig& config) {
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
    if (wp.passing == Passing::kCircle) {
      node.radius_m = wp.turn * config.radius_m;
      node.hold_m = wp.hold_s * node.airspeed_m_s;
      node.forever = wp.hold_indefinitely;
    }
    nodes.push_back(node);
  }
  return nodes;
}

/// Fault of one leg by itself, and its course where it has none.
std::optional<PlanFault> make_leg(const Node& from, Node& to, bool from_start, double radius_m,
                                  Leg& leg) {
  const double distance_m = (to.pose.p_m - from.pose.p_m).norm();
  if (!from_start && distance_m < radius_m) {
    return PlanFault{PlanFaultKind::kTooClose, to.waypoint, distance_m, radius_m};
  }
  leg = connect(from, to, radius_m);
  if (leg.length_m == kInfinity) {
    return PlanFault{PlanFaultKind::kUnreachable, to.waypoint, distance_m, 2.0 * radius_m};
  }
  return {};
}

bool is_point(const Node& node) {
  return node.passing == Passing::kLine || node.passing == Passing::kFillet;
}

/// Cuts both legs for the arc between them. @return the turn, or a fault.
std::optional<PlanFault> fit_fillet(const Node& node, Leg& before, Leg& after, double radius_m) {
  const double turn = wrap_angle(after.course_rad - before.course_rad);
  if (std::abs(turn) > kMaxFillet_rad) {
    return PlanFault{PlanFaultKind::kReversal, node.waypoint, std::abs(turn), kMaxFillet_rad};
  }
  const double cut_m = radius_m * std::tan(0.5 * std::abs(turn));
  before.cut_end_m = after.cut_start_m = cut_m;
  for (const Leg* leg : {&before, &after}) {
    const double there_m = leg->parts[1].length_m;
    const double needed_m = leg->cut_start_m + leg->cut_end_m;
    if (needed_m > there_m + kNothing_m) {
      return PlanFault{PlanFaultKind::kTurn, node.waypoint, needed_m, there_m};
    }
  }
  return {};
}

/// All legs, with the cuts of their fillets.
std::optional<PlanFault> make_legs(std::vector<Node>& nodes, bool from_start, double radius_m,
                                   std::vector<Leg>& legs) {
  legs.resize(nodes.size() - 1);
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (auto fault = make_leg(nodes[k], nodes[k + 1], from_start && k == 0, radius_m, legs[k])) {
      return fault;
    }
  }
  for (std::size_t k = 1; k < legs.size(); ++k) {
    if (nodes[k].passing != Passing::kFillet) continue;
    if (auto fault = fit_fillet(nodes[k], legs[k - 1], legs[k], radius_m)) return fault;
  }
  return {};
}

/// Change of course at the end of a leg that has a point there.
double turn_after(const Leg& leg, const Node& to, const Leg* next) {
  if (next == nullptr || !is_point(to)) return 0.0;
  return wrap_angle(next->course_rad - leg.course_rad);
}

/// The parts of a leg less what fillets cut off.
void lay_leg(Row& row, const Leg& leg, const Node& from, const Node& to) {
  const auto& [arc1, straight, arc2] = leg.parts;
  if (from.passing == Passing::kDubins) {
    row.allow_turns(arc1.start, arc1.radius_m, to);
    row.add(arc1.start, arc1.radius_m, arc1.length_m, to);
  }
  if (straight.radius_m == 0.0) {
    const Pose begin{straight.start.p_m + leg.cut_start_m * along(leg.course_rad), leg.course_rad};
    row.add(begin, 0.0, straight.length_m - leg.cut_start_m - leg.cut_end_m, to);
  } else {
    row.add(straight.start, straight.radius_m, straight.length_m, to);
  }
  if (to.passing == Passing::kDubins) {
    row.allow_turns(arc2.start, arc2.radius_m, to);
    row.add(arc2.start, arc2.radius_m, arc2.length_m, to);
  }
}

enum class Half : bool { kFirst, kSecond };

/// Half of the arc that rounds off the corner behind a leg.
void lay_fillet(Row& row, Half half, const Leg& leg, const Node& corner, double turn_rad,
                double radius_m, const Node& target) {
  const double s = turn_rad > 0.0 ? radius_m : -radius_m;
  const double half_m = 0.5 * radius_m * std::abs(turn_rad);
  const Pose entry{corner.pose.p_m - leg.cut_end_m * along(leg.course_rad), leg.course_rad};
  const double middle = leg.course_rad + 0.5 * turn_rad;
  row.add(half == Half::kFirst ? entry : Pose{TurnCircle::at(entry, s).point(middle), middle}, s,
          half_m, target);
}

/// Around a kCircle for as long as it asks, to where the next leg begins.
void lay_circle(Row& row, const Leg& leg, const Node& node, const Leg* next, double radius_m) {
  const double s = node.radius_m;
  const Pose entry{TurnCircle{node.pose.p_m, s}.point(leg.course_rad), leg.course_rad};
  double length_m = node.forever ? kInfinity : node.hold_m;
  if (!node.forever && next != nullptr) {
    const double leaves = swept_angle(leg.course_rad, next->course_rad, s) * radius_m;
    const double round = 2.0 * kPi * radius_m;
    length_m = leaves + round * std::ceil(std::max(node.hold_m - leaves, 0.0) / round);
  }
  row.circle(entry, s, length_m, node);
}

/// The row of a cycle ends where its second waypoint is passed for the second time: on after the
/// first.
std::size_t loop_begin(const Plan& plan, std::size_t second) {
  for (std::size_t k = 0; k + 1 < plan.segments.size(); ++k) {
    const Segment& s = plan.segments[k];
    if (s.passes_waypoint && s.waypoint == second) return k + 1;
  }
  return Plan::kNoLoop;
}

}  // namespace

std::optional<PlanFault> Planner::plan(const std::optional<PathStart>& start,
                                       std::span<const Waypoint> waypoints, bool cycle,
                                       std::size_t first, Plan& out) const {
  out.segments.clear();
  out.loop_to = Plan::kNoLoop;
  if (waypoints.empty()) return {};
  const double radius_m = config_.radius_m;
  std::vector<Node> nodes = nodes_of(start, waypoints, cycle, first, config_);
  std::vector<Leg> legs;
  if (auto fault = make_legs(nodes, start.has_value(), radius_m, legs)) return fault;

  Row row(out);
  row.mark(nodes[0].height_m, nodes[0], config_);
  const bool looping = cycle && waypoints.size() > 1;
  const std::size_t end = looping ? legs.size() - 1 : legs.size();
  for (std::size_t k = 0; k < end; ++k) {
    const Leg& leg = legs[k];
    const Leg* const next = k + 1 < legs.size() ? &legs[k + 1] : nullptr;
    const Node& to = nodes[k + 1];
    const double turn = turn_after(leg, to, next);
    const bool fillet = to.passing == Passing::kFillet && std::abs(turn) > kNoTurn_rad;
    lay_leg(row, leg, nodes[k], to);
    if (fillet) lay_fillet(row, Half::kFirst, leg, to, turn, radius_m, to);
    if (auto fault = row.mark(to.height_m, to, config_)) {
      out.segments.clear();
      return fault;
    }
    row.pass(to.passing == Passing::kLine ? turn : 0.0);
    if (looping && k + 1 == end) break;
    if (fillet) lay_fillet(row, Half::kSecond, leg, to, turn, radius_m, nodes[k + 2]);
    if (to.passing == Passing::kCircle) lay_circle(row, leg, to, next, radius_m);
  }
  if (looping) out.loop_to = loop_begin(out, (first + 1) % waypoints.size());
  return {};
}

}  // namespace rosflight::autonomy::fixedwing
