// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/mission.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

using config::number_text;
using config::Range;
using config::Section;

constexpr double kMaxRadius_m = 2000.0;

const Section::Choices<Passing> kPassings{
    {"line", Passing::kLine}, {"fillet", Passing::kFillet}, {"dubins", Passing::kDubins}};

double rounded(double x, double step) {
  return std::round(x / step) * step;
}

std::string metres(double x) {
  return number_text(rounded(x, 0.1)) + " m";
}

std::string percent(double slope) {
  return number_text(rounded(100.0 * slope, 0.1)) + " %";
}

/// One of two spellings of a key.
std::string_view spelling(const Section& wp, std::string_view ours, std::string_view theirs) {
  if (!wp.has(theirs)) return ours;
  if (wp.has(ours)) throw wp.error(theirs, std::string(ours) + " beside it", "one of the two");
  return theirs;
}

Passing passing_of(const Section& wp, Passing usual) {
  if (!wp.has("use_chi")) return wp.choice<Passing>("path", kPassings, usual);
  if (wp.has("path")) throw wp.error("use_chi", "path beside it", "one of the two");
  return wp.boolean("use_chi") ? Passing::kDubins : Passing::kFillet;
}

Waypoint waypoint_of(const Section& wp, Passing usual, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  Waypoint out;
  const WaypointType type = wp.has("type") ? waypoint_type(wp) : WaypointType::kGoto;
  out.p_W = waypoint_position(wp, limits.area, origin);
  const std::string_view radians = spelling(wp, "psi", "chi_d");
  const auto heading_rad = waypoint_heading_rad(wp, radians);
  out.passing = passing_of(wp, usual);
  if (out.passing == Passing::kDubins && type == WaypointType::kGoto && !heading_rad) {
    throw wp.error("heading_deg", "nothing", "a course, because path is dubins");
  }
  out.course_rad = heading_rad.value_or(0.0);
  const std::string_view speed = spelling(wp, "speed", "va_d");
  out.airspeed_m_s =
      wp.number(speed, Range::between(limits.min_airspeed_m_s, limits.max_airspeed_m_s),
                limits.plan.airspeed_m_s);
  const HoldTime hold = waypoint_hold(wp, type);
  const bool circle = type == WaypointType::kHold;
  if (wp.has("turn") && !circle) throw wp.error("turn", wp.raw("turn"), "type hold with it");
  out.turn = wp.choice<int>("turn", {{"right", 1}, {"left", -1}}, circle ? 1 : 0);
  if (circle) out.passing = Passing::kCircle;
  out.hold_s = hold.hold_s;
  out.hold_indefinitely = hold.indefinitely;
  return out;
}

LandingSite landing_of(const Section& in, const MissionLimits& limits) {
  LandingSite out;
  const std::vector<double> aim = in.numbers("aim", 2, Range::any(), {0.0, 0.0});
  out.aim_W = {aim[0], aim[1], -in.number("height_m", Range::between(-200.0, 200.0), 0.0)};
  if (std::hypot(aim[0], aim[1]) > limits.area.max_distance_m) {
    throw in.error("aim", metres(std::hypot(aim[0], aim[1])) + " from the start",
                   "at most " + metres(limits.area.max_distance_m));
  }
  out.course_rad = waypoint_heading_rad(in, "psi");
  return out;
}

MissionFault fault_of(const PlanFault& fault) {
  const double found = fault.found;
  const double allowed = fault.allowed;
  const std::size_t k = fault.waypoint;
  switch (fault.kind) {
    case PlanFaultKind::kTooClose:
      return {k, "w", metres(found) + " to the waypoint before",
              "at least the turn radius of " + metres(allowed)};
    case PlanFaultKind::kTurn:
      return {k, "w", "a turn that needs " + metres(found) + " of a leg of " + metres(allowed),
              "longer legs, a smaller radius_m, or path line or dubins"};
    case PlanFaultKind::kReversal:
      return {k, "w", "a turn of " + number_text(rounded(found / kRadPerDeg, 1.0)) + " deg",
              "at most " + number_text(rounded(allowed / kRadPerDeg, 1.0)) +
                  " deg for a fillet; or path dubins"};
    case PlanFaultKind::kTooSteep:
      return {k, "w", "a climb of " + percent(found), "at most " + percent(allowed)};
    case PlanFaultKind::kTooSteepDown:
      return {k, "w", "a descent of " + percent(found), "at most " + percent(allowed)};
    case PlanFaultKind::kUnreachable:
      return {k, "w", "no path to it from the circle before, " + metres(found) + " away",
              "a distance of " + metres(allowed) + ", or the same turn"};
  }
  return {k, "w", "a leg that cannot be flown", "another"};
}

std::optional<MissionFault> bank_fault(std::size_t k, const Waypoint& waypoint, double radius_m,
                                       const MissionLimits& limits) {
  const double v = waypoint.airspeed_m_s;
  const double bank = std::atan(v * v / (limits.gravity_m_s2 * radius_m));
  if (bank <= limits.max_bank_rad) return {};
  return MissionFault{
      k, "speed",
      number_text(v) + " m/s in turns of " + metres(radius_m) + ", a bank of " +
          number_text(rounded(bank / kRadPerDeg, 1.0)) + " deg",
      "a bank of at most " + number_text(rounded(limits.max_bank_rad / kRadPerDeg, 1.0)) + " deg"};
}

Mission read(const MissionFile& file, const MissionLimits& limits,
             const std::optional<Geodetic>& origin) {
  Mission mission;
  mission.takeoff_height_m = file.takeoff_height_m(limits.area);
  mission.score_radius_m = file.score_radius_m().value_or(mission.score_radius_m);
  mission.at_end = file.at_end({{"land", AtEnd::kLand},
                                {"hold", AtEnd::kHold},
                                {"cycle", AtEnd::kCycle},
                                {"return", AtEnd::kReturn}});
  mission.fence = file.fence();
  Passing usual = Passing::kFillet;
  if (file.root) {
    usual = file.root->choice<Passing>("path", kPassings, usual);
    if (file.root->has("radius_m")) {
      mission.radius_m =
          file.root->number("radius_m", Range::between(limits.plan.radius_m, kMaxRadius_m));
    }
    if (const auto landing = file.root->optional_section("landing")) {
      mission.landing = landing_of(*landing, limits);
    }
  }
  for (const Section& wp : file.waypoints) {
    if (!mission.waypoints.empty() && mission.waypoints.back().hold_indefinitely) {
      throw wp.error("a waypoint behind one that holds for ever",
                     "hold_indefinitely at the last waypoint only");
    }
    mission.waypoints.push_back(waypoint_of(wp, usual, limits, origin));
    check_fence(wp, mission.fence, mission.waypoints.back().p_W);
    wp.finish();
  }
  file.finish();
  close_mission(mission);
  if (const auto fault = check_mission(mission, limits)) {
    throw file.waypoints[fault->waypoint].error(fault->key, fault->found, fault->allowed);
  }
  return mission;
}

}  // namespace

PlannerConfig MissionLimits::plan_for(const Mission& mission) const {
  PlannerConfig out = plan;
  out.radius_m = mission.radius_m.value_or(plan.radius_m);
  return out;
}

void close_mission(Mission& mission) {
  if (mission.waypoints.empty()) return;
  Waypoint& last = mission.waypoints.back();
  const bool stays = mission.at_end == AtEnd::kHold ||
                     (mission.at_end == AtEnd::kCycle && mission.waypoints.size() == 1);
  if (!stays || last.hold_indefinitely) return;
  if (last.passing != Passing::kCircle) last.turn = 1;
  last.passing = Passing::kCircle;
  last.hold_indefinitely = true;
}

std::optional<MissionFault> check_mission(const Mission& mission, const MissionLimits& limits) {
  const PlannerConfig plan = limits.plan_for(mission);
  for (std::size_t k = 0; k < mission.waypoints.size(); ++k) {
    if (auto fault = bank_fault(k, mission.waypoints[k], plan.radius_m, limits)) return fault;
  }
  Plan out;
  const bool cycle = mission.at_end == AtEnd::kCycle;
  if (const auto fault = Planner(plan).plan({}, mission.waypoints, cycle, 0, out)) {
    return fault_of(*fault);
  }
  return {};
}

Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  return read(MissionFile::read(text, name), limits, origin);
}

Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  return read(MissionFile::load(file), limits, origin);
}

}  // namespace rosflight::autonomy::fixedwing
