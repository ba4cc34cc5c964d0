// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/config.hpp"

#include <gtest/gtest.h>

#include "autonomy/multirotor/test/plant.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

VehicleFacts facts() {
  return {3.5, 9.81, test::default_rotors(), {0.7, 0.0}};
}

AutonomyConfig parse(const std::string& text, const VehicleFacts& vehicle = facts()) {
  return read_autonomy(config::Document::from_text(text, "v.yaml").root(), vehicle);
}

std::string refusal(const std::string& text, const VehicleFacts& vehicle = facts()) {
  try {
    parse(text, vehicle);
  } catch (const config::Error& error) {
    return error.what();
  }
  return {};
}

void expect_refused(const std::string& text, const std::vector<std::string>& says,
                    const VehicleFacts& vehicle = facts()) {
  const std::string message = refusal(text, vehicle);
  EXPECT_FALSE(message.empty()) << text;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : says) EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(AutonomyConfig, EmptySectionTakesTheDefaultsOfThisVehicle) {
  const AutonomyConfig c = parse("{}");
  EXPECT_EQ(c.flight.controller.mass_kg, 3.5);
  EXPECT_EQ(c.flight.follower.mass_kg, 3.5);
  EXPECT_NEAR(c.flight.controller.min_thrust_N, 0.2 * 3.5 * 9.81, 1e-9);
  // twice the weight would be 68.67 N, 95 % of full throttle are less
  EXPECT_NEAR(c.flight.controller.max_thrust_N, 0.95 * 71.9812, 1e-3);
  EXPECT_EQ(c.mission.max_speed_m_s, c.flight.path.limits.speed_m_s);
}

// Weak point 33: limits in degrees were taken as radians, and defaults of 1 deg/s would have
// crippled it.
TEST(AutonomyConfig, DegreesBecomeRadiansOnce) {
  const AutonomyConfig c = parse(
      "limits: {tilt_deg: 25, yaw_rate_deg_s: 60, roll_pitch_rate_deg_s: 90, leg_yaw_rate_deg_s: "
      "45}\n");
  EXPECT_NEAR(c.flight.controller.max_tilt_rad, 0.436332, 1e-6);
  EXPECT_NEAR(c.flight.follower.max_tilt_rad, 0.436332, 1e-6);
  EXPECT_NEAR(c.flight.controller.max_yaw_rate_rad_s, 1.047198, 1e-6);
  EXPECT_NEAR(c.flight.follower.max_yaw_rate_rad_s, 1.047198, 1e-6);
  EXPECT_NEAR(c.flight.controller.max_roll_pitch_rate_rad_s, 1.570796, 1e-6);
  EXPECT_NEAR(c.flight.path.limits.yaw_rate_rad_s, 0.785398, 1e-6);
  EXPECT_GT(parse("{}").flight.controller.max_yaw_rate_rad_s, 0.5);
}

TEST(AutonomyConfig, ReadsGainsUnderTheirUnits) {
  const AutonomyConfig c = parse(
      "follower: {horizontal: {kp_1_s2: 3, ki_1_s3: 0.4, kd_1_s: 2}, heading: {kp_1_s: 1.5}, "
      "drag_1_s: 0.3}\n"
      "controller: {velocity_vertical: {kp_1_s: 2, ki_1_s2: 0.7, kd: 0.1}, roll_to_torque: "
      "{kp_Nm_rad: 4, kd_Nms_rad: 1}}\n"
      "landing: {speed_m_s: 0.8, touchdown_speed_m_s: 0.3}\n"
      "hold: {time_s: 2, settle_distance_m: 0.2}\n"
      "takeoff: {height_m: 5, speed_m_s: 1.5}\n"
      "path: {interpolation: linear, waypoint_tolerance_m: 0.8}\n");
  EXPECT_EQ(c.flight.follower.horizontal.kp, 3.0);
  EXPECT_EQ(c.flight.follower.horizontal.ki, 0.4);
  EXPECT_EQ(c.flight.follower.horizontal.kd, 2.0);
  EXPECT_EQ(c.flight.follower.heading.kp, 1.5);
  EXPECT_EQ(c.flight.follower.heading.ki, 0.0);
  EXPECT_EQ(c.flight.follower.drag_1_s, 0.3);
  EXPECT_EQ(c.flight.controller.velocity_vertical.kd, 0.1);
  EXPECT_EQ(c.flight.controller.roll_to_torque.kp, 4.0);
  EXPECT_EQ(c.flight.states.landing.speed_m_s, 0.8);
  EXPECT_EQ(c.flight.states.hold_s, 2.0);
  EXPECT_EQ(c.flight.states.takeoff_height_m, 5.0);
  EXPECT_EQ(c.flight.path.interpolation, Interpolation::kLinear);
  EXPECT_EQ(c.flight.path.waypoint_tolerance_m, 0.8);
}

TEST(AutonomyConfig, MeasuredThrustCurveReplacesTheComputedOne) {
  const AutonomyConfig c =
      parse("thrust_curve: {max_thrust_N: 100, constant: 0, root: 0, nominal_voltage_V: 24}\n");
  EXPECT_NEAR(c.flight.thrust.throttle(35.0), 0.5, 1e-12);  // linear, over 0.7
}

TEST(AutonomyConfig, OwnAttitudeLoopsNeedAMixerInNewtons) {
  expect_refused("attitude_loops: autonomy\n", {"v.yaml:1:", "attitude_loops", "USE_MOTOR_PARAM"});
  VehicleFacts newtons = facts();
  newtons.throttle.firmware_max_thrust_N = 98.0;
  EXPECT_EQ(parse("attitude_loops: autonomy\n", newtons).flight.controller.attitude_loops,
            AttitudeLoops::kAutonomy);
}

TEST(AutonomyConfig, RefusesWithOneLine) {
  expect_refused("folower: {}\n", {"v.yaml:1:", "folower", "unknown key"});
  expect_refused("follower: {horizontal: {kp: 3}}\n", {"follower.horizontal.kp_1_s2", "nothing"});
  expect_refused("follower: {horizontal: {kp_1_s2: 3, kp: 3}}\n", {"kp", "unknown key"});
  expect_refused("follower: {drag_1_s: -1}\n", {"drag_1_s", "-1"});
  expect_refused("limits: {tilt_deg: 80}\n", {"tilt_deg", "80", "60"});
  expect_refused("limits: {tilt_deg: steep}\n", {"tilt_deg", "steep"});
  expect_refused("limits: 5\n", {"limits", "a map"});
  expect_refused("controller: {min_throttle: 0.5, max_throttle: 0.4}\n",
                 {"min_throttle", "less than"});
  expect_refused("takeoff: {height_m: 1, tolerance_m: 2}\n", {"tolerance_m", "2"});
  expect_refused("landing: {speed_m_s: 0.2, touchdown_speed_m_s: 0.5}\n",
                 {"touchdown_speed_m_s", "0.5"});
  expect_refused("thrust_curve: {max_thrust_N: 100}\n", {"thrust_curve.constant"});
  expect_refused(
      "thrust_curve: {max_thrust_N: 100, constant: 0.5, root: 0.9, nominal_voltage_V: 24}\n",
      {"thrust curve"});
}

TEST(AutonomyConfig, TheShippedVehicleLoads) {
  const auto document = config::Document::from_file("vehicles/multirotor.yaml");
  const AutonomyConfig c = read_autonomy(document.root().section("autonomy"), facts());
  EXPECT_LT(c.flight.path.waypoint_tolerance_m, 1.0);
  EXPECT_NO_THROW(load_mission("missions/default.yaml", c.mission));
  EXPECT_NO_THROW(load_mission("missions/reference_example.yaml", c.mission));
}

TEST(AutonomyConfig, RefusesAVehicleThatCannotFly) {
  VehicleFacts heavy = facts();
  heavy.mass_kg = 7.0;
  expect_refused("{}", {"full throttle", "68.6"}, heavy);
  VehicleFacts nothing = facts();
  nothing.rotors = RotorData{};
  expect_refused("{}", {"thrust curve"}, nothing);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
