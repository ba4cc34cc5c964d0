// SPDX-License-Identifier: BSD-3-Clause
// A mission that is revised in flight, and what that leaves of the progress and of what was asked for.
#include "autonomy/fixedwing/guidance.hpp"

#include <gtest/gtest.h>

#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

/// Guidance of an aircraft that is where it is put, at the start of the hourglass's long leg.
class Led {
 public:
  Led() : guidance(default_config(), hourglass()) {
    state_.attitude = state_.heading = state_.horizontal = state_.vertical = Quality::kGood;
    state_.air_valid = true;
    put(0.0, 0.0, 0.0);
    state_.v_W.setZero();
    state_.airspeed_m_s = 0.0;
    step(2);
    status_.armed = true;
    step(2);
    put(100.0, 0.0, 10.0);
    step(2);
    put(200.0, 0.0, 70.0);
    step(2);
    // Over the first waypoint, then along the second leg.
    put(430.0, -265.0, 70.0, 2.6);
    step(2);
  }
  /// @param course_rad  flown at 17 m/s.
  void put(double north_m, double east_m, double height_m, double course_rad = 0.0) {
    state_.p_W = {north_m, east_m, -height_m};
    state_.course_rad = course_rad;
    state_.airspeed_m_s = 17.0;
    state_.v_W << 17.0 * along(course_rad), 0.0;
    state_.q_WB = Quaternion(Eigen::AngleAxisd(course_rad, Vector3::UnitZ()));
  }
  Phase step(int times = 1) {
    for (int k = 0; k < times; ++k) {
      t_s_ += 0.1;
      state_.t_s = t_s_;
      guidance.step(
          {.t_s = t_s_, .state = state_, .status = status_, .range_m = {}, .last = last_});
    }
    return guidance.output().phase;
  }
  void battery(double cell_V) {
    status_.battery_fresh = true;
    status_.battery_voltage_V = 6.0 * cell_V;
  }

  void failsafe(bool on) { status_.failsafe = on; }
  /// It sinks at full throttle, as with a dead motor.
  void sink() {
    state_.v_W.z() = 3.0;
    last_.throttle_full = true;
  }

  Guidance guidance;

 private:
  double t_s_{100.0};
  StateEstimate state_;
  Status status_{};
  Guidance::Last last_{};
};

TEST(Guidance, TheThrottleOfTheFailsafeCommandIsNoDeadMotor) {
  Led led;
  led.sink();
  led.failsafe(true);
  EXPECT_EQ(led.step(60), Phase::kLoiter);
  led.failsafe(false);
  EXPECT_NE(led.step(), Phase::kGlide);
  EXPECT_EQ(led.step(40), Phase::kGlide) << "its own full throttle is";
}

TEST(Guidance, ARevisedMissionGoesOnWithItsWaypoint) {
  Led led;
  ASSERT_EQ(led.step(), Phase::kMission);
  led.guidance.set_mission(hourglass(), 2);
  led.step(2);
  ASSERT_EQ(led.guidance.output().waypoint, 2U);
  Mission wider = hourglass();
  wider.radius_m = 70.0;
  led.guidance.revise_mission(wider, led.guidance.output().waypoint);
  EXPECT_EQ(led.step(2), Phase::kMission);
  EXPECT_EQ(led.guidance.output().waypoint, 2U);
  EXPECT_GE(led.guidance.path().planner().config().radius_m, 70.0) << "planned again";
}

TEST(Guidance, ARevisedMissionLeavesAReturnAndALandingThatWereAskedFor) {
  Led led;
  led.guidance.request_return();
  ASSERT_EQ(led.step(), Phase::kReturn);
  led.guidance.revise_mission(hourglass(), 1);
  EXPECT_EQ(led.step(5), Phase::kReturn);
  led.guidance.set_mission(hourglass());
  EXPECT_EQ(led.step(2), Phase::kMission) << "another mission ends it";
  led.guidance.request_land();
  led.guidance.revise_mission(hourglass(), 1);
  EXPECT_EQ(led.step(), Phase::kApproach);
}

TEST(Guidance, AnotherEndOfADoneMissionIsFlownFromItsLastWaypoint) {
  Led led;
  Mission home = hourglass();
  home.at_end = AtEnd::kReturn;
  home.waypoints.resize(1);
  led.guidance.set_mission(home);
  led.put(300.0, -187.5, 70.0, -0.5586);
  led.step(2);
  led.put(403.0, -252.0, 70.0, -0.5586);
  led.step(2);
  ASSERT_TRUE(led.guidance.output().mission_done);
  ASSERT_EQ(led.step(), Phase::kReturn);
  led.guidance.revise_mission(home, 0);
  EXPECT_EQ(led.step(3), Phase::kReturn) << "nothing has changed";
  home.at_end = AtEnd::kLand;
  led.guidance.revise_mission(home, 0);
  EXPECT_EQ(led.step(2), Phase::kMission);
  EXPECT_FALSE(led.guidance.output().mission_done);
}

TEST(Guidance, AnotherFenceEndsWhatTheOneBeforeHasAskedFor) {
  Led led;
  led.guidance.set_fence(Fence{300.0, 120.0});
  ASSERT_EQ(led.step(10), Phase::kReturn) << "half a second outside";
  EXPECT_TRUE(led.guidance.limits().asks_return());
  led.guidance.set_fence(Fence{3000.0, 120.0});
  EXPECT_EQ(led.step(10), Phase::kMission);
  led.guidance.revise_mission(hourglass(), 1);
  EXPECT_EQ(led.guidance.mission().fence, (Fence{3000.0, 120.0})) << "the fence is no part of it";
  led.guidance.set_fence({});
  EXPECT_EQ(led.step(10), Phase::kMission);
}

TEST(Guidance, ABatteryThatAsksForTheReturnOutlastsAnotherMissionAndAnotherFence) {
  FlightConfig config = default_config();
  config.battery.cells = 6.0;
  Led led;
  led.guidance.configure(config);
  led.battery(3.70);
  led.step(35);
  ASSERT_EQ(led.step(), Phase::kReturn);
  led.guidance.set_mission(hourglass());
  led.guidance.set_fence(Fence{3000.0, 120.0});
  EXPECT_EQ(led.step(5), Phase::kReturn);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
