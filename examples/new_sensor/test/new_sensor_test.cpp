// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/registry.hpp"
#include "sim/world/read_sdf.hpp"
#include "sim/world_sensors/world_sensors.hpp"

namespace rosflight::sim {
namespace {

const std::string kVehicle = "examples/new_sensor/nose_range.yaml";
constexpr Time kStep{2500};

/// The readings of a second at rest at a place, heading by an angle [rad] to the east of north.
std::vector<float> readings(const Vector3& p_W, double heading_rad,
                            const std::vector<std::string>& overrides = {}) {
  Registry registry;
  registry.load_plugin(NEW_SENSOR_BUILT);
  const Vehicle vehicle = Vehicle::from_file(kVehicle, overrides);
  const world::WorldShapes shapes = world::read_sdf_world("examples/new_sensor/wall.sdf");
  WorldSensors sensors(registry, vehicle, shapes, RandomSource{1}, kStep);
  std::vector<float> out;
  Truth truth;
  truth.body.p_W = p_W;
  truth.body.q_WB = Quaternion(Eigen::AngleAxisd(heading_rad, Vector3::UnitZ()));
  for (std::int64_t k = 0; k < 400; ++k) {
    truth.time = k * kStep;
    sensors.step(truth, [&](const std::string& name, const WorldSample& sample) {
      EXPECT_EQ(name, "ahead");
      out.push_back(std::get<hal::RangeSample>(sample).range_m);
    });
  }
  return out;
}

TEST(NewSensor, MeasuresTheWallAheadAtItsRate) {
  // From 0.2 m in front of the centre, 12 m to the wall: 11.8 m; at 60 degrees from it twice 12 m less 0.2 m.
  const auto ahead = readings({0.0, 0.0, -2.0}, 0.0);
  ASSERT_EQ(ahead.size(), 20U);
  EXPECT_FLOAT_EQ(ahead[0], 11.8F);
  const auto aslant = readings({4.0, 0.0, -2.0}, std::acos(0.5));
  ASSERT_EQ(aslant.size(), 20U);
  EXPECT_NEAR(static_cast<double>(aslant[7]), 15.8, 1e-5);
}

TEST(NewSensor, HasNoEchoBeyondItsReach) {
  EXPECT_TRUE(readings({0.0, 0.0, -2.0}, 3.0).empty());
  EXPECT_TRUE(readings({0.0, 0.0, -2.0}, 0.0, {"world_sensors.ahead.max_m=11.7"}).empty());
}

TEST(NewSensor, ItsParametersAreCheckedLikeThoseOfTheProject) {
  try {
    readings({0.0, 0.0, -2.0}, 0.0, {"world_sensors.ahead.max_m=-3"});
    ADD_FAILURE() << "took a negative range";
  } catch (const config::Error& error) {
    EXPECT_NE(
        std::string(error.what()).find("world_sensors.ahead.max_m: found -3, allowed a number > 0"),
        std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace rosflight::sim
