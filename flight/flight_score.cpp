// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "flight/flight_setup.hpp"

namespace rosflight::flight {
namespace {

LandingLimits limits_of(const FlightSetup& setup) {
  LandingLimits limits;
  if (const auto* fixedwing = std::get_if<FixedWingPlan>(&setup.plan)) {
    limits.aim_W = fixedwing->mission.landing.aim_W;
    limits.max_speed_m_s = 2.0;
    limits.max_bank_rad = 15.0 * base::kRadPerDeg;
    limits.half_length_m = 50.0;
    limits.half_width_m = 5.0;
  } else {
    limits.aim_W = setup.waypoints.back().p_W;
  }
  return limits;
}

std::vector<WaypointScore::Target> targets_of(const FlightSetup& setup) {
  std::vector<WaypointScore::Target> out;
  for (const ShownWaypoint& waypoint : setup.waypoints)
    out.push_back({waypoint.p_W, waypoint.measure});
  return out;
}

/// What keeps a soft landing from being a mission done; empty: nothing.
std::string missing(const FlightScore& s, const MissionRunner& runner, bool landed) {
  if (!runner.failure().empty()) return runner.failure();
  for (std::size_t k = 0; k < s.waypoints.size(); ++k) {
    const WaypointPass& pass = s.waypoints[k];
    if (!std::isfinite(pass.truth_distance_m)) return fmt::format("waypoint {} not flown", k + 1);
    if (!pass.within(s.score_radius_m)) {
      return fmt::format("waypoint {} missed by {:.2f} m, {:g} m allowed", k + 1,
                         pass.truth_distance_m, s.score_radius_m);
    }
  }
  if (!s.landing.inside(s.limits)) {
    return fmt::format("touchdown {:.1f} m from the aim, outside the landing area",
                       s.landing.distance_m(s.limits));
  }
  return landed && runner.disarmed() ? "" : "not disarmed";
}

std::string touchdown_text(const LandingScore::Touchdown& t) {
  return fmt::format(
      "touchdown at {:.2f} m/s{}, tilted by {:.0f} degrees", t.speed_m_s,
      t.hardest_m_s > t.speed_m_s ? fmt::format(", a rebound at {:.2f} m/s", t.hardest_m_s) : "",
      t.tilt_rad / base::kRadPerDeg);
}

/// Sets outcome and verdict.
void judge(FlightScore& s, const MissionRunner& runner, bool landed) {
  const std::string why = runner.failure().empty() ? "" : fmt::format(" ({})", runner.failure());
  const auto& touchdown = s.landing.touchdown();
  if (!s.collision.empty()) {
    s.outcome = Outcome::kCrash;
    s.verdict = fmt::format("Crash: {}.", s.collision);
  } else if (s.landing.crashed()) {
    s.outcome = Outcome::kCrash;
    s.verdict = fmt::format("Crash: {}{}.",
                            s.landing.early_contacts() > 0 || !touchdown
                                ? "touched the ground before the landing"
                                : touchdown_text(*s.landing.hardest()),
                            why);
  } else if (!touchdown) {
    s.outcome = Outcome::kTimeout;
    s.verdict =
        fmt::format("Failed: {}{}.",
                    s.landing.airborne() ? "still in the air at the end" : "never took off", why);
  } else if (!s.landing.soft(s.limits)) {
    s.outcome = Outcome::kHardLanding;
    s.verdict = fmt::format("Hard landing: {}, {:g} m/s allowed{}.",
                            touchdown_text(*s.landing.hardest()), s.limits.max_speed_m_s, why);
  } else if (const std::string lacks = missing(s, runner, landed); !lacks.empty()) {
    s.outcome = Outcome::kLandedElsewhere;
    s.verdict = fmt::format("Failed: {}.", lacks);
  } else {
    s.outcome = Outcome::kMissionDone;
    s.verdict =
        fmt::format("All waypoints passed within {:g} m, landed and disarmed.", s.score_radius_m);
  }
}

}  // namespace

const char* outcome_name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kMissionDone:
      return "mission_done";
    case Outcome::kLandedElsewhere:
      return "landed_elsewhere";
    case Outcome::kHardLanding:
      return "hard_landing";
    case Outcome::kCrash:
      return "crash";
    case Outcome::kTimeout:
      return "timeout";
    case Outcome::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::size_t FlightScore::waypoints_reached() const {
  return static_cast<std::size_t>(
      std::count_if(waypoints.begin(), waypoints.end(),
                    [this](const WaypointPass& pass) { return pass.within(score_radius_m); }));
}

FlightScorer::FlightScorer(const FlightSetup& setup)
    : radius_m_{setup.score_radius_m},
      limits_{limits_of(setup)},
      runway_{setup.fixed_wing()},
      waypoints_{targets_of(setup)},
      landing_{setup.fixed_wing() ? 2.0 : 0.5} {}

void FlightScorer::step(const sim::Truth& truth, const sim::Vector3& estimate_W,
                        const GuidanceOutput& output) {
  waypoints_.step(sim::to_seconds(truth.time), truth.body.p_W, estimate_W, output);
  const sim::Vector3& v_W = output.setpoint.v_W;
  if (runway_ && output.coming_down && !landing_.touchdown() && v_W.head<2>().norm() > 1.0)
    limits_.course_rad = std::atan2(v_W.y(), v_W.x());
  landing_.step(truth);
}

FlightScore FlightScorer::score(const MissionRunner& runner, bool landed, bool interrupted) const {
  FlightScore s;
  s.score_radius_m = radius_m_;
  s.waypoints = waypoints_.passes();
  s.landing = landing_;
  s.limits = limits_;
  s.collision = collision_;
  if (runway_ && !s.limits.course_rad && landing_.touchdown())
    s.limits.course_rad = landing_.touchdown()->course_rad;
  judge(s, runner, landed);
  if (interrupted) {
    s.outcome = Outcome::kInterrupted;
    s.verdict = fmt::format("Interrupted in stage {}.", stage_name(runner.stage()));
  }
  return s;
}

}  // namespace rosflight::flight
