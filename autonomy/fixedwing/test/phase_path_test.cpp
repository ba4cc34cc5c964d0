// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/phase_path.hpp"

#include <gtest/gtest.h>

namespace rosflight::autonomy::fixedwing {
namespace {

/// Course that the rudder keeps after a touchdown in a crosswind: the nose 10 degrees to the right of
/// the way over the ground.
double rollout_course_deg(bool position_lost) {
  StateEstimate state;
  state.q_WB = Eigen::AngleAxisd(40.0 * kRadPerDeg, Eigen::Vector3d::UnitZ());
  state.course_rad = 30.0 * kRadPerDeg;
  FlightConfig config;
  Mission mission;
  const PhasePath::Input in{
      .state = state, .config = config, .mission = mission, .position_lost = position_lost};
  PhasePath path;
  FlightEvents events;
  path.begin(Phase::kRollout, 0, in, events);
  return *path.step(Phase::kRollout, in).direct.ground_course_rad / kRadPerDeg;
}

TEST(PhasePath, RollsOutAlongItsWayOverTheGround) {
  EXPECT_NEAR(rollout_course_deg(false), 30.0, 1e-9);
}

TEST(PhasePath, RollsOutAlongItsNoseWhenThePositionIsLost) {
  EXPECT_NEAR(rollout_course_deg(true), 40.0, 1e-9);
}

/// Lowest pitch that the flare may command at this height.
double lowest_pitch_deg(double height_m) {
  const StateEstimate state;
  const FlightConfig config;
  const Mission mission;
  const PhasePath::Input in{
      .state = state, .config = config, .mission = mission, .height_above_ground_m = height_m};
  PhasePath path;
  FlightEvents events;
  path.begin(Phase::kFlare, 0, in, events);
  return path.step(Phase::kFlare, in).direct.min_pitch_rad / kRadPerDeg;
}

/// A gust that lifts the wing in the flare would carry it on with its nose at the horizon. Where it
/// touches down, the nose wheel must not be the first.
TEST(PhasePath, TheFlareMayLowerItsNoseUntilTheGroundIsNear) {
  for (const double height_m : {0.31, 1.0, 3.0})
    EXPECT_NEAR(lowest_pitch_deg(height_m), -4.0, 1e-9);
  for (const double height_m : {0.3, 0.1, 0.0, -0.1}) EXPECT_EQ(lowest_pitch_deg(height_m), 0.0);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
