// SPDX-License-Identifier: BSD-3-Clause
// Sensors of the world in a flight: what they see, and that they change nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr const char* kField = "flight/gazebo/test/worlds/field.sdf";

FlightChoice hop(const std::string& world_sensors) {
  FlightChoice choice;
  choice.mission = "hop";
  if (!world_sensors.empty()) choice.overrides = {"world_sensors=" + world_sensors};
  return choice;
}

TEST(WorldSensors, ChangeNothingOfAFlight) {
  Rig without(hop(""));
  without.flight->run();
  Rig with(
      hop("{scan: {type: lidar, noise_sigma_m: 0.02, dropout_share: 0.1}, "
          "depth: {type: depth_camera, width_px: 8, height_px: 6}}"));
  int samples = 0;
  with.flight->set_world_receiver(
      [&](sim::Time, const std::string&, const sim::WorldSample&) { ++samples; });
  with.flight->run();
  EXPECT_GT(samples, 200);
  EXPECT_EQ(with.flight->now(), without.flight->now());
  EXPECT_EQ(with.flight->truth().body.p_W, without.flight->truth().body.p_W);
  EXPECT_EQ(with.flight->truth().body.q_WB.coeffs(), without.flight->truth().body.q_WB.coeffs());
  EXPECT_EQ(with.flight->runner().estimate().p_W, without.flight->runner().estimate().p_W);
}

TEST(WorldSensors, MeasureTheHouseOfTheWorldFileAndTheGround) {
  FlightChoice choice =
      hop("{scan: {type: lidar, rays: 1, angle_min_deg: 0, angle_max_deg: 1, max_m: 60}, "
          "below: {type: lidar, rays: 1, angle_min_deg: 0, angle_max_deg: 1, "
          "rotation_deg: [0, -90, 0], min_m: 0}}");
  choice.world = kField;
  Rig rig(choice);
  int ahead = 0;
  int below = 0;
  rig.flight->set_world_receiver(
      [&](sim::Time t, const std::string& name, const sim::WorldSample& sample) {
        const auto range_m = static_cast<double>(std::get<sim::ScanSample>(sample).ranges_m.at(0));
        const sim::Truth& truth = rig.flight->truth();
        ASSERT_EQ(truth.time, t);
        const sim::Matrix3 R_WB = truth.body.q_WB.toRotationMatrix();
        if (name == "below") {
          EXPECT_NEAR(range_m, -truth.body.p_W.z() / R_WB(2, 2), 1e-5);
          ++below;
          return;
        }
        // A house has its south wall 20 m north and is 6 m high; below the horizon the ground is nearer.
        const double wall_m = (20.0 - truth.body.p_W.x()) / R_WB(0, 0);
        const double at_wall_m = -truth.body.p_W.z() - wall_m * R_WB(2, 0);
        const double east_m = truth.body.p_W.y() + wall_m * R_WB(1, 0);
        const bool on_the_wall =
            wall_m > 0.0 && at_wall_m > 0.1 && at_wall_m < 5.9 && std::abs(east_m) < 4.9;
        if (!on_the_wall) return;
        EXPECT_NEAR(range_m, wall_m, 1e-4);
        ++ahead;
      });
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
  EXPECT_GT(ahead, 50);
  EXPECT_GT(below, 100);
}

TEST(WorldSensors, NeedAWorldThatCanBeRead) {
  const auto refusal = [](const FlightChoice& choice) -> std::string {
    const FlightSetup setup(choice);
    try {
      const Flight flight(setup);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "nothing";
  };
  FlightChoice choice = hop("{scan: {type: lidar}}");
  choice.world = "/nowhere/field.sdf";
  EXPECT_EQ(refusal(choice), "/nowhere/field.sdf: found no such file");
  choice.overrides.clear();
  EXPECT_EQ(
      refusal(choice),
      "--world: found /nowhere/field.sdf with --physics runge_kutta, allowed with gazebo or with "
      "world_sensors in the vehicle file");
}

}  // namespace
}  // namespace rosflight::flight::testing
