// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "flight/landing_score.hpp"
#include "flight/mission_runner.hpp"
#include "flight/waypoint_score.hpp"

namespace rosflight::flight {

struct FlightSetup;

/// How a flight ended, judged by the true motion of the vehicle.
enum class Outcome : std::uint8_t {
  kMissionDone,      ///< Every waypoint passed, landed softly in the landing area, disarmed.
  kLandedElsewhere,  ///< Landed softly, but something of that is missing.
  kHardLanding,      ///< Faster or with more bank than allowed; no crash.
  kCrash,            ///< Above 4 m/s, tilted by more than 45 deg, or a contact before the landing.
  kTimeout,          ///< Still in the air at the end, or never there.
  kInterrupted       ///< Stopped by a person.
};
/// Such as "mission_done".
const char* outcome_name(Outcome outcome);

struct FlightScore {
  Outcome outcome{Outcome::kTimeout};
  std::string verdict;  ///< One sentence.
  double score_radius_m{};
  std::vector<WaypointPass> waypoints;
  LandingScore landing;
  LandingLimits limits;
  std::string collision;  ///< What the vehicle hit; empty: nothing.

  std::size_t waypoints_reached() const;
  bool success() const { return outcome == Outcome::kMissionDone; }
};

/// Measures a flight while it is flown.
class FlightScorer {
 public:
  explicit FlightScorer(const FlightSetup& setup);

  /// Once per step from the stage kFly on. @param estimate_W  as guidance received it.
  void step(const sim::Truth& truth, const sim::Vector3& estimate_W, const GuidanceOutput& output);

  /// The vehicle has hit something, whatever follows. @param what  such as "hit house at 3.1 m/s".
  void crash(const std::string& what) { collision_ = what; }

  const LandingScore& landing() const { return landing_; }
  /// @param interrupted  a person stopped the flight.
  FlightScore score(const MissionRunner& runner, bool landed, bool interrupted) const;

 private:
  double radius_m_;
  LandingLimits limits_;
  bool runway_;  ///< The landing area has a course.
  WaypointScore waypoints_;
  LandingScore landing_;
  std::string collision_;  ///< Empty: none.
};

}  // namespace rosflight::flight
