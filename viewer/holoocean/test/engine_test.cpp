// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/engine.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <string>
#include <thread>

#include "viewer/holoocean/test/standin.hpp"

namespace rosflight::viewer::holoocean {
namespace {

using namespace std::chrono_literals;

constexpr const char* kAllSensors = R"({
  "package_name": "Land", "ticks_per_sec": 30, "frames_per_sec": false, "window_width": 640, "window_height": 480,
  "agents": [{"agent_name": "craft", "agent_type": "FixedWing", "location": [100, 200, 3], "sensors": [
    {"sensor_type": "LocationSensor"}, {"sensor_type": "RotationSensor"}, {"sensor_type": "VelocitySensor"},
    {"sensor_type": "CollisionSensor"},
    {"sensor_type": "RangeFinderSensor", "sensor_name": "down",
     "configuration": {"LaserMaxDistance": 100, "LaserAngle": -90}},
    {"sensor_type": "RangeFinderSensor", "sensor_name": "around", "Hz": 10,
     "configuration": {"LaserMaxDistance": 50, "LaserCount": 6, "LaserAngle": -30}},
    {"sensor_type": "RGBCamera", "sensor_name": "eye", "Hz": 15, "socket": "Viewport", "location": [0.5, 0, -0.1],
     "rotation": [0, 20, 0], "configuration": {"CaptureWidth": 8, "CaptureHeight": 4}},
    {"sensor_type": "DepthCamera", "configuration": {"CaptureWidth": 4, "CaptureHeight": 2}}
  ]}]})";

Scenario scenario(const char* text = kAllSensors) {
  return read_scenario(config::Document::from_text(text, "test"));
}

Engine::Options options(const StandIn& standin, const Scenario& scenario) {
  Engine::Options options;
  options.world = standin.world(scenario);
  options.window = false;
  options.load_timeout = options.tick_timeout = 20s;
  return options;
}

sim::BodyState state(const sim::Vector3& p_W, const sim::Vector3& v_B = sim::Vector3::Zero()) {
  sim::BodyState body;
  body.p_W = p_W;
  body.v_B = v_B;
  return body;
}

TEST(HoloOceanEngine, StateGoesInAndSensorsComeOutWithItsTime) {
  StandIn standin;
  const Scenario all = scenario();
  Engine engine(all, options(standin, all));
  const SensorFrame first = engine.tick(sim::Time(33'333), state({1, 2, -40}, {12, 0, 0}));
  EXPECT_EQ(first.time, sim::Time(33'333));
  EXPECT_LT((*first.p_W - sim::Vector3(1, 2, -40)).norm(), 1e-4);  // float at 200 m: 8e-6 m
  EXPECT_LT((*first.v_W - sim::Vector3(12, 0, 0)).norm(), 1e-5);
  ASSERT_EQ(first.images.size(), 2U);
  ASSERT_EQ(first.ranges.size(), 1U);
  EXPECT_NEAR(first.ranges[0].ranges_m.at(0), 43.0,
              1e-4);  // 40 m above an origin 3 m above the ground
  EXPECT_FALSE(*first.in_contact);

  const Image& eye = first.images[0];
  EXPECT_EQ(eye.sensor, "eye");
  EXPECT_EQ(eye.width_px, 8);
  EXPECT_EQ(eye.height_px, 4);
  ASSERT_EQ(eye.bgra.size(), 8U * 4 * 4);
  const std::uint8_t* const pixel = eye.bgra.data() + 4 * (3 * 8 + 5);  // row 3, column 5
  EXPECT_EQ(pixel[0], 5);
  EXPECT_EQ(pixel[1], 3);
  EXPECT_NEAR(depth_m(first.images[1], 2, 1), 30.0, 1e-4);

  const SensorFrame second = engine.tick(sim::Time(66'667), state({1, 2, -40}));
  EXPECT_TRUE(second.images.size() == 1 && second.images[0].type == SensorType::kDepthCamera)
      << "the other camera is due at every second tick";
}

TEST(HoloOceanEngine, StartsTheProgramWithTheArgumentsOfTheClient) {
  StandIn standin;
  const Scenario all = scenario();
  const Engine engine(all, options(standin, all));
  const auto started = standin.events("start");
  ASSERT_EQ(started.size(), 1U);
  const std::vector<std::string> expected{"Meadow",
                                          "-HolodeckOn",
                                          "-LOG=HolodeckLog.txt",
                                          "-ForceRes",
                                          "-ResX=640",
                                          "-ResY=480",
                                          "--HolodeckUUID=" + engine.name(),
                                          "-TicksPerSec=30",
                                          "-FramesPerSec=0",
                                          "-EnvMinX=-5",
                                          "-EnvMinY=-5",
                                          "-EnvMinZ=0",
                                          "-EnvMaxX=5",
                                          "-EnvMaxY=5",
                                          "-EnvMaxZ=9.5",
                                          "-OctreeMin=0.02",
                                          "-OctreeMax=5",
                                          "-RenderOffScreen"};
  EXPECT_EQ(started[0]["arguments"].get<std::vector<std::string>>(), expected);
}

TEST(HoloOceanEngine, AWorldWithoutABoxGetsThatOfTheClient) {
  StandIn standin;
  Scenario dunes = scenario();
  dunes.world = "Dunes";
  dunes.octree_max_m = 7.5;
  const Engine engine(dunes, options(standin, dunes));
  const auto arguments = standin.events("start").at(0)["arguments"].get<std::vector<std::string>>();
  const std::vector<std::string> box{arguments.begin() + 9, arguments.begin() + 17};
  EXPECT_EQ(box, (std::vector<std::string>{"-EnvMinX=-10", "-EnvMinY=-10", "-EnvMinZ=-10",
                                           "-EnvMaxX=10", "-EnvMaxY=10", "-EnvMaxZ=10",
                                           "-OctreeMin=0.02", "-OctreeMax=7.5"}));
}

TEST(HoloOceanEngine, SendsCommandsByteByByteInTheirOrder) {
  StandIn standin;
  const Scenario all = scenario();
  const Engine engine(all, options(standin, all));
  const auto commands = standin.events("commands");
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0]["text"],
            R"({"commands":[{"type":"RenderViewport","params":[{"value":0.0}]}]}0)");
  const std::string spawned = commands[1]["text"];
  EXPECT_TRUE(spawned.starts_with(
      R"({"commands":[{"type":"SpawnAgent","params":[{"value":"FixedWing"},{"value":"craft"},{"value":100.0},{"value":200.0},)"
      R"({"value":3.0},{"value":0.0},{"value":0.0},{"value":0.0},{"value":1.0}]},)"))
      << spawned;
  EXPECT_NE(
      spawned.find(
          R"({"type":"AddSensor","params":[{"value":"craft"},{"value":"eye"},{"value":"RGBCamera"},)"
          R"({"value":"{\"CaptureWidth\":8,\"CaptureHeight\":4,\"TicksPerCapture\":2}"},{"value":"Viewport"},)"
          R"({"value":0.5},{"value":0.0},{"value":-0.1},{"value":0.0},{"value":20.0},{"value":0.0}]})"),
      std::string::npos)
      << spawned;
  EXPECT_TRUE(spawned.ends_with("]}0"));
}

/// Flies `ticks` ticks. The number of the tick that a picture was taken in, counted as the engine does since
/// SpawnAgent, is that of the tick whose stamp it has.
void expect_pictures_of_their_tick(Engine& engine, int ticks, int spawn_ticks) {
  int pictures = 0;
  int scans = 0;
  for (int n = 1; n <= ticks; ++n) {
    const SensorFrame frame = engine.tick(sim::Time(n), state({0, 0, -20}));
    for (const Image& picture : frame.images) {
      if (picture.sensor != "eye") continue;
      ++pictures;
      EXPECT_EQ(picture.bgra[2], n + spawn_ticks);
    }
    for (const Ranges& scan : frame.ranges) {
      if (scan.sensor != "around") continue;
      ++scans;
      ASSERT_EQ(scan.ranges_m.size(), 6U);
      for (const float range : scan.ranges_m)
        EXPECT_NEAR(range, 23.0 / 0.5, 1e-3);  // sin 30 degrees
    }
  }
  EXPECT_EQ(pictures, ticks / 2);
  EXPECT_EQ(scans, ticks / 3);
}

TEST(HoloOceanEngine, ASlowCameraIsReadInTheTickThatItsPictureWasTakenIn) {
  StandIn standin;
  for (const auto& [world, spawn_ticks] : {std::pair{"Meadow", 3}, std::pair{"Dunes", 1}}) {
    Scenario all = scenario();
    all.world = world;
    Engine engine(all, options(standin, all));
    expect_pictures_of_their_tick(engine, 12, spawn_ticks);
    engine.tick(sim::Time(13), state({0, 0, -20}));
    engine.reset();
    expect_pictures_of_their_tick(engine, 12, spawn_ticks);
  }
}

TEST(HoloOceanEngine, TheControlSchemeDecidesWhetherAnAgentFalls) {
  // One step of semi-implicit Euler with h = 1/30 s: g h = 0.327 m/s and g h^2 = 10.9 mm.
  struct Case {
    const char* agent;
    int scheme;
    double falls_m;
  };
  const double h = 1.0 / 30.0;
  for (const Case& c : {Case{"FixedWing", 2, 0.0}, Case{"FixedWing", 0, 9.8 * h * h},
                        Case{"UavAgent", 0, 9.8 * h * h}, Case{"UavAgent", 2, 9.8 * h * h}}) {
    StandIn standin;
    Scenario one = scenario(
        R"({"agents": [{"agent_type": "FixedWing", "sensors": [{"sensor_type": "LocationSensor"}]}]})");
    one.agent_type = c.agent == std::string("UavAgent") ? AgentType::kUav : AgentType::kFixedWing;
    one.control_scheme = c.scheme;
    Engine engine(one, options(standin, one));
    EXPECT_NEAR(engine.tick(sim::Time(1), state({0, 0, -20})).p_W->z() + 20.0, c.falls_m, 1e-5)
        << c.agent << c.scheme;
  }
}

TEST(HoloOceanEngine, ARayThatHitsNothingIsInfinite) {
  StandIn standin;
  const Scenario all = scenario();
  Engine engine(all, options(standin, all));
  const SensorFrame frame = engine.tick(sim::Time(1), state({0, 0, -120}));
  ASSERT_EQ(frame.ranges.size(), 1U);
  EXPECT_EQ(frame.ranges[0].ranges_m[0], std::numeric_limits<float>::infinity());
}

TEST(HoloOceanEngine, AResetInFlightSpawnsAgainAndGoesOn) {
  StandIn standin;
  const Scenario all = scenario();
  Engine engine(all, options(standin, all));
  for (int n = 1; n <= 5; ++n) engine.tick(sim::Time(n), state({0, 0, -20}));
  engine.reset();
  const SensorFrame frame = engine.tick(sim::Time(6), state({7, 0, -20}));
  EXPECT_EQ(frame.tick, 1U);
  EXPECT_NEAR(frame.p_W->x(), 7.0, 1e-4);
  EXPECT_EQ(standin.events("reset").size(), 2U);
  EXPECT_EQ(standin.events("commands").size(), 3U);
}

TEST(HoloOceanEngine, NothingIsLeftBehind) {
  StandIn standin;
  const Scenario all = scenario();
  std::string name;
  pid_t process = 0;
  {
    const Engine engine(all, options(standin, all));
    name = engine.name();
    process = engine.process();
    EXPECT_GE(left_of(name).size(), 15U);  // 2 semaphores, 7 blocks, 8 sensors
  }
  EXPECT_EQ(left_of(name), std::vector<std::string>{});
  EXPECT_EQ(::kill(process, 0), -1);
}

TEST(HoloOceanEngine, AnEngineBehindAScriptEndsToo) {
  const StandIn standin("", "");  // no exec: the script waits for it
  const Scenario all = scenario();
  { const Engine engine(all, options(standin, all)); }
  const auto process = standin.events("start").at(0)["process"].get<pid_t>();
  const std::string program = "/proc/" + std::to_string(process) + "/exe";
  const auto end = std::chrono::steady_clock::now() + 10s;  // nobody waits for it
  while (std::filesystem::exists(program) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(std::filesystem::exists(program));
}

TEST(HoloOceanEngine, TheWindowIsRefusedBeforeTheFirstPicture) {
  for (const bool window : {false, true}) {
    StandIn standin;
    const Scenario all = scenario();
    Engine::Options shown = options(standin, all);
    shown.window = window;
    const Engine engine(all, shown);
    const auto switched = standin.events("viewport");
    ASSERT_EQ(switched.size(), window ? 0U : 1U);
    for (const auto& event : switched) EXPECT_FALSE(event["on"]);
  }
}

TEST(HoloOceanEngine, AnEngineThatDiesIsReportedWithItsLastWords) {
  StandIn standin("--die-at 8");
  const Scenario all = scenario();
  Engine engine(all, options(standin, all));
  const std::string why = error_of([&engine] {
    for (int n = 1; n < 100; ++n) engine.tick(sim::Time(n), state({0, 0, -20}));
  });
  EXPECT_EQ(why,
            "holoocean: its program ended with status 1; its last output: Fatal error: out of "
            "video memory");
}

TEST(HoloOceanEngine, AnEngineThatNeverLoadsIsGivenUp) {
  StandIn standin("--silent");
  const Scenario all = scenario();
  Engine::Options impatient = options(standin, all);
  impatient.load_timeout = 300ms;
  impatient.name = unique_name();
  EXPECT_EQ(error_of([&] { const Engine engine(all, impatient); }),
            std::string("holoocean: waited 0.3 s for its world to load") +
                (::geteuid() == 0 ? " (run by root, which Unreal's programs refuse)" : "") +
                "; it printed nothing");
  EXPECT_TRUE(left_of(impatient.name).empty());
}

TEST(HoloOceanEngine, AnEngineThatStopsAnsweringIsGivenUp) {
  StandIn standin("--hang-at 6");
  const Scenario all = scenario();
  Engine::Options impatient = options(standin, all);
  impatient.tick_timeout = 2s;  // its start is within this too
  Engine engine(all, impatient);
  const std::string why = error_of([&engine] {
    for (int n = 1; n < 100; ++n) engine.tick(sim::Time(n), state({0, 0, -20}));
  });
  EXPECT_EQ(why, "holoocean: waited 2 s for a tick; it printed nothing");
  EXPECT_EQ(engine.process(), -1);
}

TEST(HoloOceanEngine, AProgramThatDoesNotStartSaysWhy) {
  StandIn standin("--broken");
  const Scenario all = scenario();
  const std::string why = error_of([&] { const Engine engine(all, options(standin, all)); });
  EXPECT_EQ(why,
            "holoocean: its program ended with status 1; its last output: error while loading "
            "shared libraries: "
            "libvulkan.so.1");
}

TEST(HoloOceanEngine, TwoEnginesOfOneNameAreRefused) {
  StandIn standin;
  const Scenario all = scenario();
  Engine::Options named = options(standin, all);
  named.name = unique_name();
  Engine first(all, named);
  EXPECT_EQ(error_of([&] { const Engine second(all, named); }),
            "there is an engine named '" + named.name +
                "' already; if none runs, remove /dev/shm/sem.HOLODECK_*" + named.name +
                " and /dev/shm/HOLODECK_MEM" + named.name + "_*");
  EXPECT_EQ(first.tick(sim::Time(1), state({0, 0, -20})).tick, 1U);
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
