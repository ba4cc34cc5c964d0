// SPDX-License-Identifier: BSD-3-Clause
// Clients of an engine that none of them has started: it maps a block once for all of them.
#include <gtest/gtest.h>

#include <fstream>

#include "viewer/holoocean/engine.hpp"
#include "viewer/holoocean/test/standin.hpp"

namespace rosflight::viewer::holoocean {
namespace {

using namespace std::chrono_literals;

/// A running engine, as an editor has it: no client started it.
class RunningEngine {
 public:
  explicit RunningEngine(const std::string& ticks_per_s = "30") {
    child_.start(
        {"/usr/bin/env", "python3", ROSFLIGHT_HOLOOCEAN_STANDIN, "--attach", "--", "Meadow",
         "--HolodeckUUID=" + name_, "-TicksPerSec=" + ticks_per_s, "-FramesPerSec=0"},
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
  std::string block(const std::string& key) const {
    return "/dev/shm/HOLODECK_MEM" + name_ + "_" + key;
  }

 private:
  std::string name_{unique_name()};
  boards::ChildProcess child_;
};

Scenario scenario(int picture_px = 4, const std::string& frames_per_s = "false") {
  return read_scenario(config::Document::from_text(
      R"({"ticks_per_sec": 30, "frames_per_sec": )" + frames_per_s +
          R"(, "agents": [{"agent_name": "craft", "agent_type": "FixedWing", "sensors": [
            {"sensor_type": "LocationSensor"}, {"sensor_type": "VelocitySensor"},
            {"sensor_type": "RGBCamera", "Hz": 10, "configuration": {"CaptureWidth": )" +
          std::to_string(picture_px) + R"(, "CaptureHeight": 2}}]}]})",
      "test"));
}

sim::BodyState state(double north_m, double speed_m_s = 0.0) {
  sim::BodyState body;
  body.p_W = {north_m, 0, -20};
  body.v_B = {speed_m_s, 0, 0};
  return body;
}

TEST(HoloOceanAttach, EveryClientFliesAndSeesItsOwnTicks) {
  const RunningEngine running;
  // The third client has larger pictures, so the engine maps another block of that name.
  for (const auto& [client, width_px] : {std::pair{1, 4}, std::pair{2, 4}, std::pair{3, 16}}) {
    const Scenario craft = scenario(width_px);
    Engine engine(craft, running.attach());
    int pictures = 0;
    for (int n = 1; n <= 9; ++n) {
      const SensorFrame frame = engine.tick(sim::Time(n), state(100.0 * client + n));
      EXPECT_NEAR(frame.p_W->x(), 100.0 * client + n, 1e-4) << client;
      if (frame.images.empty()) continue;
      ++pictures;
      EXPECT_EQ(frame.images[0].bgra.size(), 4U * static_cast<std::size_t>(width_px) * 2);
      EXPECT_EQ(frame.images[0].bgra[2], n + 1) << client;  // one tick of spawning
    }
    EXPECT_EQ(pictures, 3) << client;
  }
}

TEST(HoloOceanAttach, AnActionOfTheClientBeforeIsCleared) {
  const RunningEngine running;
  const Scenario craft = scenario();
  {
    Engine engine(craft, running.attach());
    engine.tick(sim::Time(1), state(5.0));
  }
  const std::array<float, 8> action{30.0F, 0.0F, 0.0F};  // 30 m/s^2 to the north
  std::ofstream(running.block("craft"), std::ios::in | std::ios::binary)
      .write(reinterpret_cast<const char*>(action.data()), sizeof(action));
  Engine engine(craft, running.attach());
  EXPECT_NEAR(engine.tick(sim::Time(1), state(5.0)).v_W->x(), 0.0, 1e-6);
}

TEST(HoloOceanAttach, TheEngineGetsTheRatesOfTheScenario) {
  const RunningEngine running("60");
  const Scenario craft = scenario(4, "20");
  Engine engine(craft, running.attach());
  const auto begin = std::chrono::steady_clock::now();
  for (int n = 1; n <= 11; ++n) {
    // With steps of 1/60 s it would be 12 m/s / 60 = 0.2 m behind.
    EXPECT_NEAR(engine.tick(sim::Time(n), state(5.0, 12.0)).p_W->x(), 5.0, 1e-4) << n;
  }
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 500ms);  // ten frames at 20 per second
}

TEST(HoloOceanAttach, OneEngineHasOneClientAndARefusedOneTakesNothingFromIt) {
  const RunningEngine running;
  const Scenario craft = scenario();
  Engine engine(craft, running.attach());
  const auto before = left_of(engine.name());
  EXPECT_EQ(error_of([&] { const Engine second(craft, running.attach()); }),
            "the engine named '" + engine.name() + "' is used by another client");
  EXPECT_EQ(left_of(engine.name()), before);
  EXPECT_NEAR(engine.tick(sim::Time(1), state(5.0)).p_W->x(), 5.0, 1e-4);
}

TEST(HoloOceanAttach, BlocksThatAnotherClientHasRemovedAreReported) {
  for (const std::string key : {"craft_teleport_flag", "RESET"}) {
    const RunningEngine running;
    const Scenario craft = scenario();
    {
      Engine engine(craft, running.attach());
      engine.tick(sim::Time(1), state(5.0));
    }
    std::filesystem::remove(running.block(key));  // as the client in Python does at its end
    EXPECT_EQ(error_of([&] {
                Engine engine(craft, running.attach());
                for (int n = 1; n <= 5; ++n) {
                  EXPECT_FALSE(engine.tick(sim::Time(n), state(5.0)).p_W) << "not of this state";
                }
              }),
              "the engine reads blocks that a client before this one has removed; restart it");
  }
}

TEST(HoloOceanAttach, NoEngineToAttachToIsAnError) {
  const Scenario craft = scenario();
  Engine::Options attach;
  attach.name = unique_name();
  EXPECT_EQ(error_of([&] { const Engine engine(craft, attach); }),
            "found no running engine to attach to, allowed one that has loaded its world");
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
