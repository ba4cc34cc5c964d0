// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/world_sensors.hpp"

#include <gtest/gtest.h>

#include <map>

#include "sim/sensors/register.hpp"
#include "sim/world_sensors/test/rig.hpp"

namespace rosflight::sim::testing {
namespace {

constexpr const char* kAll =
    "{scan: {type: lidar, rays: 9, noise_sigma_m: 0.01}, "
    "depth: {type: depth_camera, width_px: 4, height_px: 3, noise_share: 0.02, rate_Hz: 20}, "
    "mocap: {type: motion_capture, position_m: {noise_sigma: 0.002}, delay_us: 5000}}";

struct Rig {
  explicit Rig(const std::string& text) : vehicle{vehicle_with(text)} {
    register_world_sensors(registry);
    shapes.add_level_ground();
    sensors = WorldSensors(registry, vehicle, shapes, RandomSource{3}, kStep);
  }
  /// What each sensor measures in a second, as text.
  std::map<std::string, std::string> fly() {
    std::map<std::string, std::string> record;
    for (std::int64_t k = 0; k < 400; ++k) {
      sensors.step(at({0.0, 0.0, -2.0}, 0.3, Vector3::UnitY(), k * kStep),
                   [&](const std::string& name, const WorldSample& sample) {
                     record[name] += "@" + std::to_string(k) + text(sample);
                   });
    }
    return record;
  }
  static std::string text(const WorldSample& sample) {
    std::string out;
    if (const auto* scan = std::get_if<ScanSample>(&sample))
      for (const float range : scan->ranges_m) out += " " + std::to_string(range);
    if (const auto* image = std::get_if<DepthSample>(&sample))
      for (const float depth : image->depths_m) out += " " + std::to_string(depth);
    if (const auto* pose = std::get_if<PoseSample>(&sample))
      out += " " + std::to_string(pose->p_W.x() * 1e6);
    return out;
  }

  Registry registry;
  Vehicle vehicle;
  world::WorldShapes shapes;
  WorldSensors sensors;
};

std::string refusal(const std::string& text) {
  try {
    Rig{text};
  } catch (const config::Error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(WorldSensors, AVehicleWithoutTheSectionHasNone) {
  const Vehicle vehicle = Vehicle::from_file("vehicles/multirotor.yaml");
  Registry registry;
  register_world_sensors(registry);
  const world::WorldShapes shapes;
  EXPECT_TRUE(WorldSensors(registry, vehicle, shapes, RandomSource{1}, kStep).empty());
}

TEST(WorldSensors, EachHasItsRateAndTheSameBitsForTheSameSeed) {
  auto record = Rig{kAll}.fly();
  ASSERT_EQ(record.size(), 3U);
  const auto count = [&](const char* name) {
    return std::count(record[name].begin(), record[name].end(), '@');
  };
  EXPECT_EQ(count("scan"), 10);
  EXPECT_EQ(count("depth"), 20);
  EXPECT_EQ(count("mocap"), 100);
  EXPECT_EQ(record, Rig{kAll}.fly());
}

TEST(WorldSensors, AddingOneLeavesTheOthersBitForBit) {
  auto all = Rig{kAll}.fly();
  auto one = Rig{"{scan: {type: lidar, rays: 9, noise_sigma_m: 0.01}}"}.fly();
  EXPECT_EQ(one.size(), 1U);
  EXPECT_EQ(one["scan"], all["scan"]);
}

TEST(WorldSensors, AreOffWhenNotEnabled) {
  EXPECT_TRUE(Rig{"{scan: {type: lidar, enabled: false}}"}.fly().empty());
}

TEST(WorldSensors, BadKeysAreOneLineWithFoundAndAllowed) {
  const auto ends = [](const std::string& text, const std::string& end) {
    const std::string line = refusal(text);
    EXPECT_EQ(line.substr(line.size() - std::min(line.size(), end.size())), end) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  };
  ends("{scan: {type: lidar, min_m: -1}}",
       "world_sensors.scan.min_m: found -1, allowed a number from 0 to 100000");
  ends("{scan: {type: lidar, max_m: 0}}",
       "world_sensors.scan.max_m: found 0, allowed a number > 0 and <= 100000");
  ends("{scan: {type: lidar, min_m: 5, max_m: 4}}",
       "world_sensors.scan.max_m: found 4, allowed a number > min_m");
  ends("{scan: {type: lidar, rays: 0}}",
       "world_sensors.scan.rays: found 0, allowed an integer from 1 to 100000");
  ends("{scan: {type: lidar, rate_Hz: 500}}",
       "world_sensors.scan.rate_Hz: found 500, allowed a number up to 400, the rate of the "
       "simulation");
  ends("{scan: {type: lidar, angle_min_deg: 90, angle_max_deg: -90}}",
       "angle_max_deg: found -90, allowed a number > angle_min_deg");
  ends("{scan: {type: sonar}}",
       "world_sensors.scan.type: found sonar, allowed depth_camera, lidar, motion_capture");
  ends("{scan: {rays: 3}}", "world_sensors.scan.type: found nothing, allowed text");
  ends("{Scan: {type: lidar}}",
       "world_sensors.Scan: found the name Scan, allowed small letters, digits and _, a letter "
       "first");
  ends("{depth: {type: depth_camera, width_px: 0}}",
       "world_sensors.depth.width_px: found 0, allowed an integer from 1 to 2000");
  ends("{depth: {type: depth_camera, fov_deg: 180}}",
       "world_sensors.depth.fov_deg: found 180, allowed a number from 1 to 170");
  ends("{mocap: {type: motion_capture, dropout_interval_s: 9}}",
       "dropout_duration_s: found nothing, allowed a number >= 0.01 where there are drop-outs");
  EXPECT_NE(refusal("{scan: {type: lidar, ray: 3}}").find("world_sensors.scan.ray: found"),
            std::string::npos);
}

}  // namespace
}  // namespace rosflight::sim::testing
