// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/engine.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <string>

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
  EXPECT_TRUE(first.images.size() == 1 && first.images[0].type == SensorType::kDepthCamera)
      << "the other camera is due at every second tick";
  ASSERT_EQ(first.ranges.size(), 1U);
  EXPECT_NEAR(first.ranges[0].ranges_m.at(0), 43.0,
              1e-4);  // 40 m above an origin 3 m above the ground
  EXPECT_FALSE(*first.in_contact);

  const SensorFrame second = engine.tick(sim::Time(66'667), state({1, 2, -40}));
  ASSERT_EQ(second.images.size(), 2U);
  const Image& eye = second.images[0];
  EXPECT_EQ(eye.sensor, "eye");
  EXPECT_EQ(eye.width_px, 8);
  EXPECT_EQ(eye.height_px, 4);
  ASSERT_EQ(eye.bgra.size(), 8U * 4 * 4);
  const std::uint8_t* const pixel = eye.bgra.data() + 4 * (3 * 8 + 5);  // row 3, column 5
  EXPECT_EQ(pixel[0], 5);
  EXPECT_EQ(pixel[1], 3);
  EXPECT_NEAR(depth_m(second.images[1], 2, 1), 30.0, 1e-4);
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
                                          "-RenderOffScreen"};
  EXPECT_EQ(started[0]["arguments"].get<std::vector<std::string>>(), expected);
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

TEST(HoloOceanEngine, CamerasAndRangesAreReadWhenTheyAreDue) {
  StandIn standin;
  const Scenario all = scenario();
  Engine engine(all, options(standin, all));
  const int spawn_ticks = 3;  // pre_start_steps and one more
  int pictures = 0;
  int scans = 0;
  for (int n = 1; n <= 12; ++n) {
    const SensorFrame frame = engine.tick(sim::Time(n), state({0, 0, -20}));
    for (const Image& picture : frame.images) {
      if (picture.sensor != "eye") continue;
      ++pictures;
      EXPECT_EQ(n % 2, 0);
      EXPECT_NEAR(picture.bgra[2], n + spawn_ticks, 1) << "not older than the rate of the camera";
    }
    for (const Ranges& scan : frame.ranges) {
      if (scan.sensor != "around") continue;
      ++scans;
      EXPECT_EQ(n % 3, 0);
      ASSERT_EQ(scan.ranges_m.size(), 6U);
      for (const float range : scan.ranges_m)
        EXPECT_NEAR(range, 23.0 / 0.5, 1e-3);  // sin 30 degrees
    }
  }
  EXPECT_EQ(pictures, 6);
  EXPECT_EQ(scans, 4);
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

TEST(HoloOceanEngine, LeftoversOfAClientThatWasKilledAreRemovedByTheNext) {
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  const std::string theirs = "rosflight_" + std::to_string(dead) + "_0123456789abcdef";
  const std::string ours = unique_name();
  const std::string of_python = "3e1b1a66-rosflight";
  for (const std::string& name : {theirs, ours, of_python})
    std::ofstream("/dev/shm/HOLODECK_MEM" + name + "_RESET") << "x";
  EXPECT_EQ(remove_leftovers(), 1);
  EXPECT_TRUE(left_of(theirs).empty());
  for (const std::string& name : {ours, of_python}) {
    EXPECT_EQ(left_of(name).size(), 1U);
    std::filesystem::remove("/dev/shm/HOLODECK_MEM" + name + "_RESET");
  }
}

/// The message of the error that `run` ends with.
template <class Run>
std::string error_of(const Run& run) {
  try {
    run();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
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
            "holoocean: waited 0.3 s for its world to load; it printed nothing");
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
            "there is an engine named '" + named.name + "' already");
  EXPECT_EQ(first.tick(sim::Time(1), state({0, 0, -20})).tick, 1U);
}

/// A running engine, as an editor has it: no client started it.
class RunningEngine {
 public:
  RunningEngine() {
    child_.start({"/usr/bin/env", "python3", ROSFLIGHT_HOLOOCEAN_STANDIN, "--attach", "--",
                  "Meadow", "--HolodeckUUID=" + name_, "-TicksPerSec=30"},
                 {});
    while (!Semaphore::exists("/HOLODECK_SEMAPHORE_CLIENT" + name_)) child_.check();
  }
  ~RunningEngine() {
    child_.stop();
    for (const std::string& file : left_of(name_)) std::filesystem::remove("/dev/shm/" + file);
  }
  Engine::Options attach() const {
    Engine::Options options;
    options.name = name_;
    options.tick_timeout = 20s;
    return options;
  }

 private:
  std::string name_{unique_name()};
  boards::ChildProcess child_;
};

TEST(HoloOceanEngine, AttachesToARunningEngineAndLeavesItToTheNext) {
  const RunningEngine running;
  const Scenario all = scenario();
  for (int client = 0; client < 2; ++client) {
    Engine engine(all, running.attach());
    EXPECT_NEAR(engine.tick(sim::Time(1), state({5, 0, -20})).p_W->x(), 5.0, 1e-4) << client;
  }
}

TEST(HoloOceanEngine, OneEngineHasOneClient) {
  const RunningEngine running;
  const Scenario all = scenario();
  const Engine engine(all, running.attach());
  EXPECT_EQ(error_of([&] { const Engine second(all, running.attach()); }),
            "the engine named '" + engine.name() + "' is used by another client");
}

TEST(HoloOceanEngine, NoEngineToAttachToIsAnError) {
  const Scenario all = scenario();
  Engine::Options attach;
  attach.name = unique_name();
  EXPECT_EQ(error_of([&] { const Engine engine(all, attach); }),
            "found no running engine to attach to, allowed one that has loaded its world");
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
