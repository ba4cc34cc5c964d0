// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/scenario.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "viewer/holoocean/test/standin.hpp"

namespace rosflight::viewer::holoocean {
namespace {

Scenario read(const std::string& text) {
  return read_scenario(config::Document::from_text(text, "s.json"));
}

/// A scenario with these members of the root and of its one sensor.
std::string text(const std::string& root, const std::string& sensor = "",
                 const std::string& agent = "") {
  return R"({"world": "Meadow", )" + root + R"( "agents": [{"agent_type": "UavAgent", )" + agent +
         R"("sensors": [{"sensor_type": "RGBCamera")" + sensor + "}]}]}";
}

std::string error_of(const std::string& scenario) {
  try {
    read(scenario);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(HoloOceanScenario, ReadsAScenarioOfHoloOcean) {
  const Scenario s = read(R"({
    "name": "Meadow-Quad", "world": "Meadow", "package_name": "Land", "main_agent": "quad", "ticks_per_sec": 60,
    "frames_per_sec": true, "window_width": 1000, "env_min": [-1, -2, -3], "octree_min": 0.1,
    "agents": [{"agent_name": "quad", "agent_type": "UavAgent", "control_scheme": 1, "location": [1, 2, 3.5],
      "rotation": [0, 0, 90], "sensors": [
        {"sensor_type": "DepthCamera", "sensor_name": "depth", "Hz": 20,
         "configuration": {"CaptureWidth": 64}},
        {"sensor_type": "RangeFinderSensor", "socket": "Viewport", "location": [0, 0.1, 0]}]}]})");
  EXPECT_EQ(s.world, "Meadow");
  EXPECT_EQ(s.agent, "quad");
  EXPECT_EQ(s.control_scheme, 1);
  EXPECT_EQ(s.frames_per_s, 60);
  EXPECT_EQ(s.window_height_px, 720);
  EXPECT_EQ(s.env_min_m->at(2), -3.0);
  EXPECT_FALSE(s.env_max_m);
  EXPECT_EQ(s.location_m[2], 3.5);
  ASSERT_EQ(s.sensors.size(), 2U);
  EXPECT_EQ(s.sensors[0].ticks_per_sample, 3);
  EXPECT_EQ(s.sensors[0].bytes(), 64U * 256 * 4);
  EXPECT_EQ(s.sensors[1].name, "RangeFinderSensor");
  EXPECT_EQ(s.sensors[1].rays, 1);
  EXPECT_EQ(s.sensors[1].max_range_m, 10.0);
}

TEST(HoloOceanScenario, ReadsAScenarioWithTheKeysOfRosflight) {
  const Scenario s = read(R"({
    "name": "Show", "world": "default", "package_name": "Land", "main_agent": "Quad", "ticks_per_sec": 30,
    "frames_per_sec": true, "octree_min": 0.02, "octree_max": 5.0, "ros_publish": true, "window_width": 2500,
    "window_height": 1000, "agents": [{"agent_name": "Quad", "agent_type": "UavAgent", "control_scheme": 2,
      "location": [0, 0, 0], "rotation": [0, 0, 0], "location_randomization": [0, 0, 0], "sensors": [
        {"sensor_type": "RGBCamera", "UseRPY": false, "ros_publish": true},
        {"sensor_type": "RangeFinderSensor", "socket": "COM", "ros_publish": true,
         "configuration": {"LaserMaxDistance": 100.0, "LaserCount": 5, "LaserAngle": 0, "LaserDebug": false}}]}]})");
  EXPECT_EQ(s.world, "default");
  EXPECT_EQ(s.control_scheme, 2);
  ASSERT_EQ(s.sensors.size(), 2U);
  EXPECT_EQ(s.sensors[1].rays, 5);
  EXPECT_EQ(s.sensors[1].socket, "COM");
  EXPECT_EQ(s.sensors[1].configuration.find("LaserDebug"), std::string::npos);
}

TEST(HoloOceanScenario, TheDefaultHasTheSensorsOfRosflightsNode) {
  const Scenario s = default_scenario(AgentType::kFixedWing);
  EXPECT_EQ(s.agent_type, AgentType::kFixedWing);
  EXPECT_EQ(s.control_scheme, 2);
  EXPECT_EQ(s.package, "Land");
  ASSERT_EQ(s.sensors.size(), 4U);
  EXPECT_EQ(s.sensors[0].name, "rgb_camera_sensor");
  EXPECT_EQ(s.sensors[0].width_px, 512);
  EXPECT_EQ(s.sensors[1].rays, 6);
  EXPECT_EQ(s.sensors[2].elevation_deg, -90.0);
  EXPECT_EQ(default_scenario(AgentType::kUav).control_scheme, 0);
}

struct Bad {
  const char* name;
  std::string scenario;
  std::string said;
};

class BadScenario : public testing::TestWithParam<Bad> {};

TEST_P(BadScenario, IsOneLineThatSaysWhatIsAllowed) {
  EXPECT_EQ(error_of(GetParam().scenario), "s.json:1: " + GetParam().said);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BadScenario,
    testing::Values(
        Bad{"UnknownKey", text(R"("weather": "rain",)"),
            "weather: found an unknown key, allowed name, package_name, world, ticks_per_sec, "
            "frames_per_sec, window_width, "
            "window_height, env_min, env_max, octree_min, octree_max, ros_publish, agents, "
            "main_agent"},
        Bad{"UnknownSetting", text("", R"(, "configuration": {"CaptureWith": 5})"),
            "agents.0.sensors.0.configuration.CaptureWith: found an unknown key, allowed "
            "CaptureWidth, CaptureHeight"},
        Bad{"TextForANumber", text(R"("ticks_per_sec": "30",)"),
            "ticks_per_sec: found \"30\", allowed an integer from 1 to 1000"},
        Bad{"RateThatDoesNotDivide", text("", R"(, "Hz": 7)"),
            "agents.0.sensors.0.Hz: found 7, allowed 30 (ticks_per_sec) divided by a whole number"},
        Bad{"RateAboveTheTicks", text("", R"(, "Hz": 31)"),
            "agents.0.sensors.0.Hz: found 31, allowed a number > 0 and <= 30"},
        Bad{"UnknownSensor",
            R"({"agents": [{"agent_type": "UavAgent", "sensors": [{"sensor_type": "Nose"}]}]})",
            "agents.0.sensors.0.sensor_type: found \"Nose\", allowed LocationSensor, "
            "RotationSensor, VelocitySensor, "
            "CollisionSensor, RangeFinderSensor, RGBCamera, DepthCamera, "
            "SemanticSegmentationCamera"},
        Bad{"EnginesNameOfTheAgent", R"({"agents": [{"agent_type": "UAV"}]})",
            "agents.0.agent_type: found \"UAV\", allowed UavAgent, FixedWing"},
        Bad{"SchemeThatIsNotThere", text("", "", R"("control_scheme": 3, )"),
            "agents.0.control_scheme: found 3, allowed an integer from 0 to 2"},
        Bad{"Randomisation", text("", "", R"("location_randomization": [1, 0, 0], )"),
            "agents.0.location_randomization: found numbers other than 0, allowed 0, 0, 0: two "
            "flights of a seed are the same"},
        Bad{"NameWithAQuote", text("", R"(, "sensor_name": "a\"b")"),
            "agents.0.sensors.0.sensor_name: found \"a\"b\", allowed 1 to 64 letters, digits, _ "
            "and -"},
        Bad{"TwoNumbersForAPlace", text("", R"(, "location": [1, 2])"),
            "agents.0.sensors.0.location: found a list of 2, allowed a list of 3 numbers, each a "
            "number from -1000000 to "
            "1000000"},
        Bad{"TwoAgents", R"({"agents": [{"agent_type": "UavAgent"}, {"agent_type": "UavAgent"}]})",
            "agents: found 2 agents, allowed one, the aircraft"},
        Bad{"OtherMainAgent", text(R"("main_agent": "me",)"),
            "main_agent: found me, allowed aircraft, the name of the agent"},
        Bad{"TwoSensorsOfOneName",
            R"({"agents": [{"agent_type": "UavAgent", "sensors": [{"sensor_type": "RGBCamera"}, {"sensor_type": "RGBCamera"}]}]})",
            "agents.0.sensors.1.sensor_type: found RGBCamera again, allowed each name once"},
        Bad{"PictureWithoutColumns", text("", R"(, "configuration": {"CaptureWidth": 0})"),
            "agents.0.sensors.0.configuration.CaptureWidth: found 0, allowed an integer from 1 to "
            "8192"}),
    [](const auto& bad) { return bad.param.name; });

/// A folder of packages in which `version` of Land has this config.json.
class Packages {
 public:
  ~Packages() { std::filesystem::remove_all(folder_); }
  void add(const std::string& version, const std::string& world) const {
    const auto land = folder_ / version / "worlds/Land";
    std::filesystem::create_directories(land);
    std::ofstream(land / "config.json")
        << R"({"path": "engine", "worlds": [{"name": ")" + world + R"("}]})";
    std::ofstream(land / "engine") << "#!/bin/sh\n";
    std::filesystem::permissions(land / "engine", std::filesystem::perms::owner_all);
  }
  std::string error_of(const Scenario& scenario) const {
    try {
      find_world(scenario, folder_);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "no error";
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_{[] {
    std::string pattern = (std::filesystem::temp_directory_path() / "packages_XXXXXX").string();
    return ::mkdtemp(pattern.data());
  }()};
};

TEST(HoloOceanPackage, TheNewestVersionWins) {
  const Packages packages;
  packages.add("2.9.1", "Old");
  packages.add("2.10.0", "New");
  const World world = find_world(default_scenario(AgentType::kUav), packages.folder());
  EXPECT_EQ(world.name, "New");
  EXPECT_EQ(world.program, packages.folder() / "2.10.0/worlds/Land/engine");
}

TEST(HoloOceanPackage, AMissingPackageSaysWhatToInstall) {
  const Packages packages;
  EXPECT_EQ(packages.error_of(default_scenario(AgentType::kUav)),
            "found no HoloOcean package Land in " + packages.folder().string() +
                "/VERSION/worlds; to install it, link your GitHub account to Epic Games, clone "
                "https://github.com/byu-holoocean/HoloOcean, in its folder client run python3 -m "
                "venv .venv && "
                ".venv/bin/pip install . && .venv/bin/python -c 'import holoocean; "
                "holoocean.install(\"Land\")'");
}

TEST(HoloOceanPackage, WithoutAWorldTheOneNamedDefaultElseTheFirstIsTaken) {
  const Packages packages;
  const Scenario scenario = default_scenario(AgentType::kUav);
  packages.add("2.3.0", R"(island"}, {"name": "default", "pre_start_steps": 4}, {"name": "forest)");
  EXPECT_EQ(find_world(scenario, packages.folder()).name, "default");
  EXPECT_EQ(find_world(scenario, packages.folder()).pre_start_steps, 4);
  packages.add("2.3.0", R"(island"}, {"name": "forest)");
  EXPECT_EQ(find_world(scenario, packages.folder()).name, "island");
}

TEST(HoloOceanPackage, AWorldThatIsNotThereAndAProgramThatIsNotThere) {
  const Packages packages;
  packages.add("2.3.0", "Meadow");
  Scenario scenario = default_scenario(AgentType::kUav);
  scenario.world = "Moon";
  EXPECT_EQ(packages.error_of(scenario),
            "world: found Moon, allowed Meadow, the worlds of package Land");
  const auto land = packages.folder() / "2.3.0/worlds/Land";
  std::filesystem::remove(land / "engine");
  EXPECT_EQ(packages.error_of(default_scenario(AgentType::kUav)),
            (land / "config.json").string() + ":1: path: found " + (land / "engine").string() +
                ", allowed the path of a program below " + land.string());
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
