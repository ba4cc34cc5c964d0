// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/planner.hpp"

#include <algorithm>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/planner_legs.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kNoTurn_rad = 1e-9;

bool is_point(const Node& node) {
  return node.passing == Passing::kLine || node.passing == Passing::kFillet;
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
    row.add(begin, 0.0, leg.spare_m(), to);
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
                const Node& target) {
  const double s = turn_rad > 0.0 ? corner.radius_m : -corner.radius_m;
  const double half_m = 0.5 * corner.radius_m * std::abs(turn_rad);
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

double Plan::radius_at(std::size_t waypoint) const {
  for (const Segment& s : segments) {
    if (s.passes_waypoint && s.waypoint == waypoint && !s.straight()) return std::abs(s.radius_m);
  }
  return kInfinity;
}

std::optional<PlanFault> Planner::plan(const std::optional<PathStart>& start,
                                       std::span<const Waypoint> waypoints, bool cycle,
                                       std::size_t first, Plan& out) const {
  out.segments.clear();
  out.loop_to = Plan::kNoLoop;
  if (waypoints.empty()) return {};
  const double radius_m = config_.radius_m;
  std::vector<Node> nodes = nodes_of(start, waypoints, cycle, first, *this);
  std::vector<Leg> legs;
  if (auto fault = make_legs(nodes, start.has_value(), *this, legs)) return fault;

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
    if (fillet) lay_fillet(row, Half::kFirst, leg, to, turn, to);
    if (auto fault = row.mark(to.height_m, to, config_)) {
      out.segments.clear();
      return fault;
    }
    row.pass(to.passing == Passing::kLine ? turn : 0.0);
    if (looping && k + 1 == end) break;
    if (fillet) lay_fillet(row, Half::kSecond, leg, to, turn, nodes[k + 2]);
    if (to.passing == Passing::kCircle) lay_circle(row, leg, to, next, radius_m);
  }
  if (looping) out.loop_to = loop_begin(out, (first + 1) % waypoints.size());
  return {};
}

}  // namespace rosflight::autonomy::fixedwing
