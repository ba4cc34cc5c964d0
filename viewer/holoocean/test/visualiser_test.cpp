// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/visualiser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "viewer/holoocean/test/standin.hpp"

namespace rosflight::viewer::holoocean {
namespace {

using namespace std::chrono_literals;

constexpr sim::Time kStep{2500};

double seconds(const SensorFrame& frame) {
  return std::chrono::duration<double>(frame.time).count();
}

Scenario scenario() {
  return read_scenario(config::Document::from_text(
      R"({"frames_per_sec": false, "agents": [{"agent_type": "FixedWing", "sensors": [
            {"sensor_type": "LocationSensor"}, {"sensor_type": "CollisionSensor"},
            {"sensor_type": "RGBCamera", "configuration": {"CaptureWidth": 2, "CaptureHeight": 2}}]}]})",
      "test"));
}

/// Something that flies north at 10 m/s, 50 m high, shown for some simulated time.
struct Show {
  std::vector<SensorFrame> frames;
  std::vector<std::string> notes;
  Visualiser::Counts counts;
  std::string failure;

  Show(const StandIn& standin, Visualiser::Pace pace, double duration_s, double height_m = 50.0,
       std::chrono::milliseconds timeout = 20s, std::chrono::microseconds pause = 0us) {
    const Scenario shown = scenario();
    Engine::Options options;
    options.world = standin.world(shown);
    options.load_timeout = options.tick_timeout = timeout;
    Visualiser visualiser(shown, options, pace,
                          {[this](SensorFrame&& frame) { frames.push_back(std::move(frame)); },
                           [this](const std::string& note) { notes.push_back(note); }});
    if (pace == Visualiser::Pace::kSkip) {
      while (!visualiser.started()) std::this_thread::sleep_for(1ms);
    }
    sim::Truth truth;
    truth.body.v_B = {10, 0, 0};
    const auto steps = static_cast<int>(duration_s / sim::to_seconds(kStep));
    for (int i = 0; i < steps; ++i) {
      truth.time += kStep;
      truth.body.p_W = {10.0 * sim::to_seconds(truth.time), 0, -height_m};
      visualiser.step(truth, {});
      std::this_thread::sleep_for(pause);
    }
    counts = visualiser.close();
    failure = visualiser.failure();
  }
};

TEST(HoloOceanVisualiser, SixtyPicturesInTwoSecondsEachOfItsStamp) {
  const StandIn standin;
  const Show show(standin, Visualiser::Pace::kWait, 1.99);  // the next picture is at 2 s
  ASSERT_EQ(show.frames.size(), 60U);
  EXPECT_EQ(show.counts.images, 60U);
  EXPECT_EQ(show.counts.skipped, 0U);
  EXPECT_EQ(show.failure, "");
  for (std::size_t n = 1; n < show.frames.size(); ++n) {
    const SensorFrame& frame = show.frames[n];
    // Frame n is of the first step at or after n / 30 s.
    const double late_s = seconds(frame) - static_cast<double>(n) / 30.0;
    EXPECT_GE(late_s, -1e-6);
    EXPECT_LT(late_s, sim::to_seconds(kStep));
    EXPECT_NEAR(frame.p_W->x(), 10.0 * seconds(frame), 1e-4);
  }
}

TEST(HoloOceanVisualiser, ASlowEngineSkipsStatesAndStampsStayRight) {
  const StandIn standin("--slow 0.02");
  const Show show(standin, Visualiser::Pace::kSkip, 2.0, 50.0, 20s, 100us);
  EXPECT_GT(show.counts.skipped, 10U);
  EXPECT_GT(show.frames.size(), 2U);
  EXPECT_LE(show.frames.size() + show.counts.skipped, 60U);
  for (const SensorFrame& frame : show.frames)
    EXPECT_NEAR(frame.p_W->x(), 10.0 * seconds(frame), 1e-4);
}

TEST(HoloOceanVisualiser, TheNextFlightIsShownToo) {
  const StandIn standin;
  const Scenario shown = scenario();
  Engine::Options options;
  options.world = standin.world(shown);
  std::vector<std::chrono::nanoseconds> times;
  Visualiser visualiser(shown, options, Visualiser::Pace::kWait,
                        {[&times](SensorFrame&& frame) { times.push_back(frame.time); }, {}});
  sim::Truth truth;
  for (const sim::Time t : {2500us, 40'000us, 10'000'000us, 2500us, 40'000us}) {
    truth.time = t;
    visualiser.step(truth, {});
  }
  visualiser.close();
  EXPECT_EQ(times.size(), 5U);
}

TEST(HoloOceanVisualiser, ATimeBelowAMicrosecondComesBack) {
  const StandIn standin;
  const Scenario shown = scenario();
  Engine::Options options;
  options.world = standin.world(shown);
  std::vector<std::chrono::nanoseconds> times;
  Visualiser visualiser(shown, options, Visualiser::Pace::kWait,
                        {[&times](SensorFrame&& frame) { times.push_back(frame.time); }, {}});
  const std::vector<std::chrono::nanoseconds> sent{1'764'455'750'123'456'789ns,  // a time of day
                                                   1'764'455'750'223'456'001ns};
  for (const auto time : sent) visualiser.show({}, time);
  visualiser.close();
  EXPECT_EQ(times, sent);
}

TEST(HoloOceanVisualiser, ContactIsCountedAndReportedOnly) {
  const StandIn standin;
  const Show show(standin, Visualiser::Pace::kWait, 0.5, -1.0);
  EXPECT_EQ(show.counts.contacts, show.frames.size());
  EXPECT_FALSE(show.counts.failed);
  EXPECT_NEAR(show.frames.back().p_W->z(), 0.0, 1e-6)
      << "the engine stopped the body at the ground";
}

TEST(HoloOceanVisualiser, AnEngineThatDiesIsOneNoteAndNoMoreWaiting) {
  for (const auto pace : {Visualiser::Pace::kWait, Visualiser::Pace::kSkip}) {
    const StandIn standin("--die-at 9");
    const Show show(standin, pace, 5.0, 50.0, 20s, 100us);
    EXPECT_TRUE(show.counts.failed);
    EXPECT_LT(show.frames.size(), 9U);
    ASSERT_EQ(show.notes.size(), 2U);
    EXPECT_EQ(show.notes[0], "the engine has loaded its world");
    EXPECT_EQ("warning: " + show.failure + "; the flight goes on without it", show.notes[1]);
    EXPECT_EQ(show.notes[1],
              "warning: holoocean: its program ended with status 1; its last output: Fatal error: "
              "out of video "
              "memory; the flight goes on without it");
  }
}

TEST(HoloOceanVisualiser, AnEngineThatNeverAnswersIsWaitedForOnce) {
  const StandIn standin("--silent");
  const auto begin = std::chrono::steady_clock::now();
  const Show show(standin, Visualiser::Pace::kWait, 5.0, 50.0, 400ms);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 400ms);
  EXPECT_EQ(show.notes.size(), 1U);
  EXPECT_EQ(show.counts.ticks, 0U);
  EXPECT_TRUE(show.counts.failed);
}

TEST(HoloOceanVisualiser, ClosingDoesNotWaitForAnEngineThatLoads) {
  const StandIn standin("--silent");
  const Scenario shown = scenario();
  Engine::Options options;
  options.world = standin.world(shown);
  options.load_timeout = 1h;
  std::vector<std::string> notes;
  {
    Visualiser visualiser(shown, options, Visualiser::Pace::kSkip,
                          {{}, [&notes](const std::string& note) { notes.push_back(note); }});
  }
  EXPECT_TRUE(notes.empty());
}

TEST(HoloOceanVisualiser, AResetInFlightLoadsTheLevelAgain) {
  const StandIn standin;
  const Scenario shown = scenario();
  Engine::Options options;
  options.world = standin.world(shown);
  std::vector<std::uint64_t> ticks;
  Visualiser visualiser(shown, options, Visualiser::Pace::kWait,
                        {[&ticks](SensorFrame&& frame) { ticks.push_back(frame.tick); }, {}});
  sim::Truth truth;
  for (int i = 0; i < 4; ++i) {
    if (i == 2) visualiser.reset();
    truth.time += 33'334us;
    visualiser.step(truth, {});
  }
  visualiser.close();
  EXPECT_EQ(ticks, (std::vector<std::uint64_t>{1, 2, 1, 2}));
  EXPECT_EQ(standin.events("reset").size(), 2U);
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
