// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <random>
#include <thread>
#include <vector>

#include "rosflight_common/time.hpp"
#include "rosflight_sim/fine_ticks.hpp"
#include "rosflight_sim/frames.hpp"
#include "rosflight_sim/module_states.hpp"
#include "rosflight_sim/tick_tracker.hpp"
#include "rosflight_sim/timer_phase.hpp"
#include "rosflight_sim/topic_pace.hpp"
#include "rosflight_sim/waiting_clock.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;
namespace hal = rosflight::hal;
namespace {

using rosflight_common::nanoseconds;
using rosflight_common::stamp_of;

constexpr std::int64_t kTick_ns = 2'500'000;

TEST(Stamps, KeepNanosecondsAndNeverShowAWholeSecondOfThem) {
  EXPECT_EQ(nanoseconds(stamp_of(1'999'999'999)), 1'999'999'999);
  EXPECT_EQ(stamp_of(1'999'999'999).nanosec, 999'999'999U);
  EXPECT_EQ(stamp_of(2'000'000'000).sec, 2);
  EXPECT_EQ(stamp_of(2'000'000'000).nanosec, 0U);
  EXPECT_EQ(nanoseconds(stamp_of(-5)), 0);
  EXPECT_EQ(nanoseconds(stamp_of(4'300'000'000'000)), 4'300'000'000'000);  // beyond 2^32 us
}

// ---- ticks of /clock between two steps ------------------------------------------------------------

FineTicks::Step step_at(double factor, FineTicks::Wall::time_point wall =
                                           FineTicks::Wall::time_point(std::chrono::seconds(1))) {
  return {
      7 * kTick_ns, kTick_ns, 100'000, wall,
      std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(kTick_ns) / factor))};
}

TEST(FineTicks, AreTwentyFourBetweenTwoStepsAtTheWallTimesThatBelongToThem) {
  const FineTicks::Step step = step_at(1.0);
  std::int64_t tick = 0;
  int count = 0;
  while ((tick = FineTicks::next(step, tick, step.wall)) > 0) {
    EXPECT_EQ(tick, ++count);
    EXPECT_EQ(FineTicks::due(step, tick) - step.wall, std::chrono::microseconds(100 * count));
  }
  EXPECT_EQ(count, 24);
}

TEST(FineTicks, ThatAreLateOrTooCloseAreLeftOut) {
  const FineTicks::Step step = step_at(1.0);
  EXPECT_EQ(FineTicks::next(step, 3, step.wall + std::chrono::microseconds(1730)), 17);
  EXPECT_EQ(FineTicks::next(step, 3, step.wall + std::chrono::milliseconds(9)), 0)
      << "the next step is due";
  for (const double factor : {0.01, 1.0, 1.9, 2.1, 8.0, 100.0}) {
    const FineTicks::Step fast = step_at(factor);
    std::int64_t before = 0;
    for (std::int64_t tick = 0; (tick = FineTicks::next(fast, tick, fast.wall)) > 0; before = tick)
      EXPECT_GE(FineTicks::due(fast, tick) - FineTicks::due(fast, before), FineTicks::kMinGap)
          << factor;
  }
  EXPECT_EQ(FineTicks::next({0, kTick_ns, kTick_ns, {}, {}}, 0, {}), 0)
      << "no tick shorter than a step";
}

TEST(FineTicks, EndWhereTheyMustWaitAndReachThatAtOnceWhenTheyAreLate) {
  FineTicks::Step step = step_at(1.0);
  const auto late = step.wall + std::chrono::milliseconds(9);
  step.end_ns = step.time_ns + 1'260'000;
  EXPECT_EQ(FineTicks::next(step, 3, step.wall + std::chrono::microseconds(700)), 7);
  EXPECT_EQ(FineTicks::next(step, 11, step.wall + std::chrono::microseconds(1730)), 12);
  EXPECT_EQ(FineTicks::next(step, 3, late), 12);
  EXPECT_EQ(FineTicks::next(step, 12, late), 0);
  step.end_ns = step.time_ns - 1;
  EXPECT_EQ(FineTicks::next(step, 0, late), 0);
  step.end_ns = step.time_ns + step.step_ns;
  EXPECT_EQ(FineTicks::next(step, 12, late), 0) << "the next step is due";
}

TEST(FineTicks, GoOnWithTheRestOfAStep) {
  std::mutex mutex;
  std::vector<std::int64_t> told;
  FineTicks ticks([&](std::int64_t time_ns) {
    const std::lock_guard lock{mutex};
    told.push_back(time_ns);
  });
  const auto wait_for = [&](std::int64_t time_ns) {
    for (;; std::this_thread::yield()) {
      const std::lock_guard lock{mutex};
      if (!told.empty() && told.back() == time_ns) return;
    }
  };
  FineTicks::Step step = step_at(1.0);  // long ago: each end is reached at once
  for (const std::int64_t after_ns : {300'000, 300'000, 900'000, 2'400'000}) {
    step.end_ns = step.time_ns + after_ns;
    ticks.follow(step);
    wait_for(step.end_ns);
  }
  const std::lock_guard lock{mutex};
  EXPECT_EQ(told, (std::vector<std::int64_t>{17'800'000, 18'400'000, 19'900'000}));
}

TEST(FineTicks, AreToldInOrderAndEndWithTheStepOrAStop) {
  std::mutex mutex;
  std::vector<std::int64_t> told;
  FineTicks ticks([&](std::int64_t time_ns) {
    const std::lock_guard lock{mutex};
    told.push_back(time_ns);
  });
  const auto count = [&] {
    const std::lock_guard lock{mutex};
    return told.size();
  };
  ticks.follow(step_at(0.01, FineTicks::Wall::now()));  // a tick every 10 ms
  while (count() < 5) std::this_thread::yield();
  ticks.stop();
  const std::size_t stopped = count();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LE(count(), stopped + 1) << "one may have been under way";
  for (std::size_t k = 0; k < told.size(); ++k) {
    EXPECT_EQ(told[k] % 100'000, 0);
    EXPECT_GT(told[k], k == 0 ? 7 * kTick_ns : told[k - 1]);
    EXPECT_LT(told[k], 8 * kTick_ns);
  }
}

// ---- topics that time waits for -------------------------------------------------------------------

/// A world that is as fast as it may be, and a node that answers each step from a queue of five, in so much wall time.
struct Answered {
  TopicPace pace;
  TopicPace::Wall::time_point wall{std::chrono::seconds(100)};
  std::int64_t time_ns = 0;
  std::deque<std::int64_t> queue;
  int busy_us = 0;
  int lost = 0;

  /// @param answer_us  what each answer takes from now on
  void run(int ms, int answer_us) {
    for (int k = 0; k < ms * 10; ++k) {
      wall += std::chrono::microseconds(100);
      busy_us -= 100;
      if (busy_us <= 0 && !queue.empty()) {
        if (asked) pace.came(*asked, time_ns);
        asked = queue.front();
        queue.pop_front();
        busy_us = answer_us;
      }
      if (pace.look(time_ns, 2 * kTick_ns, wall) != TopicPace::Look::kNotBehind) continue;
      time_ns += kTick_ns;
      queue.push_back(time_ns);
      if (queue.size() <= 5) continue;
      queue.pop_front();
      ++lost;
    }
  }

 private:
  std::optional<std::int64_t> asked;
};

TEST(TopicPace, ANodeThatStartsSlowlyIsStillGivenEachStep) {
  Answered node;
  node.run(300, 50'000);
  const int before = node.lost;
  node.run(1000, 1000);
  EXPECT_EQ(node.lost, before);
  const std::int64_t start_ns = node.time_ns;
  node.run(1000, 1000);
  EXPECT_NEAR(static_cast<double>(node.time_ns - start_ns) * 1e-9, 2.5, 0.1)
      << "a step for each answer";
}

TEST(TopicPace, ANodeThatStallsLosesNoStep) {
  Answered node;
  node.run(1000, 1000);
  const int before = node.lost;
  for (const int stall_ms : {20, 300, 1500}) {
    node.run(2 * stall_ms, 1000 * stall_ms);
    node.run(500, 1000);
  }
  EXPECT_EQ(node.lost, before);
}

TEST(TopicPace, ATopicThatEndsWhileItIsLearntDoesNotSlowTimeForEver) {
  Answered node;
  node.pace.came(0, 0);
  node.pace.came(kTick_ns, kTick_ns);
  node.busy_us = 1'000'000'000;
  node.run(2100, 1000);  // 100 steps of 20 ms, then one every 0.1 ms
  EXPECT_GT(node.time_ns, 500 * kTick_ns);
}

// ---- timers that follow the finer ticks -----------------------------------------------------------

constexpr std::int64_t kFine_ns = 100'000;

TEST(TimerPhase, TellsStampsOfTicksFromThoseOfStepsAndOfSensors) {
  TimerPhase phase;
  for (int k = 1; k <= 20; ++k) phase.called(k * 2 * kTick_ns, kFine_ns);
  EXPECT_FALSE(phase.follows(kFine_ns, kTick_ns)) << "steps";
  phase.called(41 * kTick_ns + kFine_ns, kFine_ns);
  EXPECT_TRUE(phase.follows(kFine_ns, kTick_ns));
  EXPECT_FALSE(phase.follows(0, kTick_ns)) << "nobody is told ticks";
  phase.called(42 * kTick_ns + 12'345, kFine_ns);
  EXPECT_FALSE(phase.follows(kFine_ns, kTick_ns)) << "a sensor";
}

/// A node of 390 Hz as rcl runs it, and ticks that stop where the phase says, each 0.1 ms of wall time. The node works for as
/// long as it is told, and a message is on its way for 0.3 ms.
struct Timer {
  static constexpr std::int64_t kPeriod_ns = 2'564'000;
  std::mt19937 random{11};
  TimerPhase phase;
  TimerPhase::Wall::time_point wall{std::chrono::seconds(100)};
  std::int64_t time_ns = 40'000, due_ns = 0, busy_until_us = 0, wall_us = 0;
  std::optional<std::int64_t> under_way_us;
  std::vector<std::int64_t> stamps;
  bool working = false;

  void run(int ms, int max_work_us) {
    std::uniform_int_distribution<int> work_us(50, max_work_us);
    for (int k = 0; k < 10 * ms; ++k) {
      wall_us += 100;
      wall += std::chrono::microseconds(100);
      if (under_way_us && wall_us >= *under_way_us) {
        phase.called(stamps.back(), kFine_ns);
        under_way_us.reset();
      }
      if (working && wall_us >= busy_until_us && !under_way_us) {
        stamps.push_back(time_ns);
        under_way_us = wall_us + 300;
        working = false;
      }
      if (!working && time_ns >= due_ns) {
        working = true;
        busy_until_us = wall_us + work_us(random);
        due_ns += kPeriod_ns *
                  std::max<std::int64_t>(1, (time_ns - due_ns + kPeriod_ns - 1) / kPeriod_ns);
      }
      const bool learnt = stamps.size() > 12;
      if (!learnt ? time_ns < due_ns + 2 * kTick_ns
                  : time_ns + kFine_ns <= phase.ticks_end_ns(kFine_ns, 2 * kTick_ns))
        time_ns += kFine_ns;
      else
        phase.stands(wall);
    }
  }
};

TEST(TimerPhase, NoStampIsThereTwiceAndNoPeriodIsLeftOutWhileItsWorkTakesUpToThree) {
  for (const int max_work_us : {100, 800, 2500, 5500, 8000}) {
    Timer node;
    node.run(30'000, max_work_us);
    const std::size_t begin = node.stamps.size();
    const std::int64_t from_ns = node.time_ns;
    node.run(20'000, max_work_us);
    for (std::size_t k = begin + 1; k < node.stamps.size(); ++k)
      ASSERT_GT(node.stamps[k], node.stamps[k - 1]) << max_work_us << " us, message " << k - begin;
    const double periods = static_cast<double>(node.time_ns - from_ns) / Timer::kPeriod_ns;
    EXPECT_NEAR(static_cast<double>(node.stamps.size() - begin), periods, 2.0) << max_work_us;
  }
}

TEST(TimerPhase, AnotherPeriodIsLearntAndAGapIsNone) {
  TimerPhase phase;
  std::int64_t stamp_ns = 0;
  const auto call = [&](int times, std::int64_t apart_ns) {
    for (int k = 0; k < times; ++k) phase.called(stamp_ns += apart_ns, kFine_ns);
    return phase.ticks_end_ns(kFine_ns, 2 * kTick_ns) - stamp_ns;
  };
  EXPECT_NEAR(static_cast<double>(call(100, 2'600'000)), 3.9e6, 1e4);
  EXPECT_NEAR(static_cast<double>(call(1, 900'000'000)), 3.9e6, 1e4);
  EXPECT_NEAR(static_cast<double>(call(20, 10'000'000)), 15e6, 2e4)
      << "at most the lag of two steps";
}

// ---- the board's time without simulated time ------------------------------------------------------

/// A board that is looked at every millisecond, with an IMU every other one.
struct Stage {
  WaitingClock clock;
  WaitingClock::Wall::time_point wall{std::chrono::seconds(100)};
  hal::Time latest = clock.at(wall);

  void run(int ms, bool imu, int apart_ms = 1) {
    for (int k = 0; k < ms; k += apart_ms) {
      wall += std::chrono::milliseconds(apart_ms);
      if (imu && k % 2 == 0) clock.came(WaitingClock::Source::kImu, wall);
      const hal::Time now = clock.at(wall);
      ASSERT_GE(now, latest);
      latest = now;
    }
  }
  /// The first of each; board time runs with the IMU alone afterwards, as the receiver has been given up.
  void start() {
    clock.came(WaitingClock::Source::kReceiver, wall);
    run(1000, true);
    static_cast<void>(clock.take_stalls());
  }
  /// What board time gains in this.
  std::int64_t gain_ms(int ms, bool imu, int apart_ms = 1) {
    const hal::Time before = latest;
    run(ms, imu, apart_ms);
    return hal::to_ms(latest - before);
  }
};

TEST(WaitingClock, RunsAsTheWallWhileSamplesCome) {
  Stage stage;
  stage.start();
  EXPECT_EQ(stage.gain_ms(3000, true), 3000);
  EXPECT_EQ(stage.clock.take_stalls().count, 0);
}

TEST(WaitingClock, WaitsAtTheStartForTheFirstOfEachButNotForEver) {
  Stage stage;
  EXPECT_EQ(stage.gain_ms(1000, false), 20);
  EXPECT_EQ(stage.gain_ms(1000, true), 40);  // and for the receiver 60 ms
  stage.clock.came(WaitingClock::Source::kReceiver, stage.wall);
  EXPECT_EQ(stage.gain_ms(50, true), 50);
  EXPECT_EQ(stage.clock.take_stalls().count, 0);

  Stage alone;
  EXPECT_EQ(alone.gain_ms(3100, false), 121);  // 20 before, 101 after 3 s
  EXPECT_EQ(alone.gain_ms(1000, false), 1000);
}

TEST(WaitingClock, StandsWhileSamplesAreLateAndSaysForHowLong) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(stage.gain_ms(300, false), 19);  // 20 ms after the last one, a millisecond ago
    EXPECT_EQ(stage.gain_ms(100, true), 99);   // which the first sample ends
  }
  const WaitingClock::Stalls stalls = stage.clock.take_stalls();
  EXPECT_EQ(stalls.count, 5);
  EXPECT_EQ(stalls.sum, hal::milliseconds(5 * 282));
  EXPECT_EQ(stage.clock.take_stalls().count, 0);
}

TEST(WaitingClock, GoesOnWithoutASourceThatIsDead) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  EXPECT_EQ(stage.gain_ms(3000, false), 3000 - 500);
  EXPECT_EQ(stage.gain_ms(100, true), 100);  // and it comes back
  EXPECT_EQ(stage.gain_ms(400, false), 19);
}

TEST(WaitingClock, AProcessThatStoodStillItselfGivesNobodyUp) {
  Stage stage;
  stage.start();
  stage.run(100, true);
  EXPECT_EQ(stage.gain_ms(3000, false, 3000), 19);
  EXPECT_EQ(stage.gain_ms(300, false), 0);
}

TEST(WaitingClock, WaitsForTheReceiver) {
  Stage stage;
  stage.clock.came(WaitingClock::Source::kReceiver, stage.wall);
  EXPECT_EQ(stage.gain_ms(400, true), 60);
}

TEST(TickTracker, JitterNeitherLosesNorDoublesATick) {
  std::mt19937 random{1};
  std::uniform_int_distribution<std::int64_t> jitter(-700'000, 700'000);
  TickTracker ticks{kTick_ns};
  const std::int64_t start = 1'780'000'000'000'000'000;
  ASSERT_TRUE(ticks.step(start));
  for (int k = 1; k < 10'000; ++k) {
    ASSERT_TRUE(ticks.step(start + k * kTick_ns + jitter(random))) << k;
    ASSERT_EQ(ticks.time().count(), k * kTick_ns / 1000);
  }
}

TEST(TickTracker, AFirstStampThatCameLateIsForgotten) {
  TickTracker ticks{kTick_ns};
  ticks.step(1'100'000);  // 1.1 ms late
  int came = 0;
  for (int k = 1; k < 1000; ++k) came += ticks.step(k * kTick_ns) ? 1 : 0;
  EXPECT_EQ(came, 999);
}

TEST(TickTracker, LostStampsLeaveAGap) {
  TickTracker ticks{kTick_ns};
  ticks.step(0);
  ticks.step(kTick_ns);
  EXPECT_TRUE(ticks.step(5 * kTick_ns));
  EXPECT_EQ(ticks.time().count(), 12'500);
}

TEST(TickTracker, AFasterWorldGivesNoMoreTicks) {
  TickTracker ticks{kTick_ns};
  int came = 0;
  for (int k = 0; k < 1000; ++k) came += ticks.step(k * 1'000'000) ? 1 : 0;
  EXPECT_NEAR(came, 400, 2);
}

TEST(TickTracker, TimeGoesOnWhenTheClockIsSetBack) {
  TickTracker ticks{kTick_ns};
  ticks.step(100'000'000'000);
  ticks.step(100'000'000'000 + kTick_ns);
  EXPECT_TRUE(ticks.step(0));
  EXPECT_EQ(ticks.time().count(), 5000);
  EXPECT_TRUE(ticks.step(kTick_ns));
  EXPECT_EQ(ticks.time().count(), 7500);
}

/// dx/dt = -x/tau with tau = 0.1 s.
class Lag final : public sim::ForcesAndMoments {
 public:
  std::size_t state_size() const override { return 1; }
  void initial_state(std::span<double> x) const override { x[0] = 1.0; }
  void evaluate(const Input& /*in*/, std::span<const double> x, sim::Wrench& wrench,
                std::span<double> x_dot) const override {
    wrench.force_B.x() = x[0];
    x_dot[0] = -x[0] / 0.1;
  }
};

class ModuleStatesTest : public testing::Test {
 protected:
  double force_after(double dt_s, int steps) {
    Lag lag;
    ModuleStates states{lag};
    const sim::BodyState body;
    const sim::Matrix3 R = sim::Matrix3::Identity();
    const sim::Vector3 v = sim::Vector3::Zero();
    const sim::Air air;
    const hal::OutputValues outputs{};
    sim::Wrench wrench;
    sim::Truth truth;
    for (int i = 0; i < steps; ++i)
      states.step({body, R, v, air, outputs, 0.0}, dt_s, wrench, truth);
    return wrench.force_B.x();
  }
};

TEST_F(ModuleStatesTest, FollowTheExactSolution) {
  EXPECT_NEAR(force_after(0.0025, 40), std::exp(-1.0), 1e-8);
  EXPECT_NEAR(force_after(0.1, 1), std::exp(-1.0), 1e-8);  // split
}

TEST_F(ModuleStatesTest, APauseAndAStepBackChangeNothing) {
  EXPECT_EQ(force_after(3600.0, 1), 1.0);
  EXPECT_EQ(force_after(-0.1, 1), 1.0);
  EXPECT_EQ(force_after(0.0, 1), 1.0);
}

/// Direction of a vector of `child` in `map`, along the tree.
sim::Vector3 in_map(const sim::Vector3& v, const std::string& child,
                    const sim::Quaternion& q_WB = sim::Quaternion::Identity()) {
  if (child == "map") return v;
  if (child == "aircraft_body") return in_map(q_WB * v, "NED");
  for (const FrameEdge& edge : fixed_frames())
    if (child == edge.child) return in_map(edge.rotation * v, edge.parent, q_WB);
  ADD_FAILURE() << child << " is not in the tree";
  return v;
}

TEST(Frames, MapIsEastNorthUp) {
  EXPECT_TRUE(in_map({1, 0, 0}, "NED").isApprox(sim::Vector3(0, 1, 0), 1e-12));   // north
  EXPECT_TRUE(in_map({0, 1, 0}, "NED").isApprox(sim::Vector3(1, 0, 0), 1e-12));   // east
  EXPECT_TRUE(in_map({0, 0, 1}, "NED").isApprox(sim::Vector3(0, 0, -1), 1e-12));  // down
}

TEST(Frames, BaseLinkIsForwardLeftUp) {
  EXPECT_TRUE(in_map({1, 0, 0}, "base_link").isApprox(sim::Vector3(0, 1, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 1, 0}, "base_link").isApprox(sim::Vector3(-1, 0, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 0, 1}, "base_link").isApprox(sim::Vector3(0, 0, 1), 1e-12));
}

TEST(Frames, TheMeshFliesNoseFirstAndTopUp) {  // its nose is at -y, as in ROSflight 2.x
  EXPECT_TRUE(in_map({0, -1, 0}, "stl_frame").isApprox(sim::Vector3(0, 1, 0), 1e-12));
  EXPECT_TRUE(in_map({0, 0, 1}, "stl_frame").isApprox(sim::Vector3(0, 0, 1), 1e-12));
}

TEST(Frames, NamesOfASecondVehicleAreItsOwn) {
  EXPECT_EQ(frame_prefix("/"), "");
  EXPECT_EQ(frame_prefix("/air/two"), "air/two/");
}

}  // namespace
}  // namespace rosflight_sim
