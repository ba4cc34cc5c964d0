// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "rosflight_sim/fine_ticks.hpp"
#include "rosflight_sim/timer_phase.hpp"
#include "rosflight_sim/topic_pace.hpp"

/// How simulated time goes on: the ticks between two steps, and whom they and the steps wait for.
namespace rosflight_sim {
namespace {

constexpr std::int64_t kStep_ns = 2'500'000;
constexpr std::int64_t kFine_ns = 100'000;

// ---- ticks of /clock between two steps ------------------------------------------------------------

/// The ticks that a thread was told.
class Told {
 public:
  void add(std::int64_t time_ns) {
    const std::lock_guard lock{mutex_};
    times_ns_.push_back(time_ns);
  }
  std::vector<std::int64_t> all() const {
    const std::lock_guard lock{mutex_};
    return times_ns_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::int64_t> times_ns_;
};

FineTicks::Step step_at(double factor, FineTicks::Wall::time_point wall =
                                           FineTicks::Wall::time_point(std::chrono::seconds(1))) {
  return {
      7 * kStep_ns, kStep_ns, kFine_ns, wall,
      std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(kStep_ns) / factor))};
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
  EXPECT_EQ(FineTicks::next({0, kStep_ns, kStep_ns, {}, {}}, 0, {}), 0)
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
  Told told;
  FineTicks ticks([&](std::int64_t time_ns) { told.add(time_ns); });
  FineTicks::Step step = step_at(1.0);  // long ago: each end is reached at once
  for (const std::int64_t after_ns : {300'000, 300'000, 900'000, 2'400'000}) {
    step.end_ns = step.time_ns + after_ns;
    ticks.follow(step);
    while (told.all().empty() || told.all().back() != step.end_ns) std::this_thread::yield();
  }
  EXPECT_EQ(told.all(), (std::vector<std::int64_t>{17'800'000, 18'400'000, 19'900'000}));
}

TEST(FineTicks, AreToldInOrderAndEndWithTheStepOrAStop) {
  Told told;
  FineTicks ticks([&](std::int64_t time_ns) { told.add(time_ns); });
  ticks.follow(step_at(0.01, FineTicks::Wall::now()));  // a tick every 10 ms
  while (told.all().size() < 5) std::this_thread::yield();
  ticks.stop();
  const std::size_t stopped = told.all().size();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const std::vector<std::int64_t> times_ns = told.all();
  EXPECT_LE(times_ns.size(), stopped + 1) << "one may have been under way";
  for (std::size_t k = 0; k < times_ns.size(); ++k) {
    EXPECT_EQ(times_ns[k] % kFine_ns, 0);
    EXPECT_GT(times_ns[k], k == 0 ? 7 * kStep_ns : times_ns[k - 1]);
    EXPECT_LT(times_ns[k], 8 * kStep_ns);
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
      if (pace.look(time_ns, 2 * kStep_ns, wall) != TopicPace::Look::kNotBehind) continue;
      time_ns += kStep_ns;
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
  node.pace.came(kStep_ns, kStep_ns);
  node.busy_us = 1'000'000'000;
  node.run(2100, 1000);  // 100 steps of 20 ms, then one every 0.1 ms
  EXPECT_GT(node.time_ns, 500 * kStep_ns);
}

// ---- timers that follow the finer ticks -----------------------------------------------------------

TEST(TimerPhase, TellsStampsOfTicksFromThoseOfStepsAndOfSensors) {
  TimerPhase phase;
  for (int k = 1; k <= 20; ++k) phase.called(k * 2 * kStep_ns, kFine_ns);
  EXPECT_FALSE(phase.follows(kFine_ns, kStep_ns)) << "steps";
  phase.called(41 * kStep_ns + kFine_ns, kFine_ns);
  EXPECT_TRUE(phase.follows(kFine_ns, kStep_ns));
  EXPECT_FALSE(phase.follows(0, kStep_ns)) << "nobody is told ticks";
  phase.called(42 * kStep_ns + 12'345, kFine_ns);
  EXPECT_FALSE(phase.follows(kFine_ns, kStep_ns)) << "a sensor";
}

/// A node of 390 Hz as rcl runs it, and ticks that stop where the phase says, up to `ticks_at_once` each 0.1 ms of wall time while
/// they are behind the wall. The node works for as long as it is told.
struct Timer {
  static constexpr std::int64_t kPeriod_ns = 2'564'000;
  explicit Timer(unsigned seed) : random{seed} {}
  std::mt19937 random;
  int ticks_at_once = 1;
  int way_us = 300;  ///< What a message is on its way for.
  TimerPhase phase;
  TimerPhase::Wall::time_point wall{std::chrono::seconds(100)};
  std::int64_t time_ns = 0, due_ns = 0, busy_until_us = 0, wall_us = 0;
  std::optional<std::int64_t> under_way_us;
  std::vector<std::int64_t> stamps;
  bool working = false;

  void run(int ms, const std::function<int()>& work_us) {
    const std::int64_t begin_ns = time_ns - 1000 * wall_us;
    for (int k = 0; k < 10 * ms; ++k) {
      wall_us += 100;
      wall += std::chrono::microseconds(100);
      if (under_way_us && wall_us >= *under_way_us) {
        phase.called(stamps.back(), kFine_ns);
        under_way_us.reset();
      }
      if (working && wall_us >= busy_until_us && !under_way_us) {
        stamps.push_back(time_ns);
        under_way_us = wall_us + way_us;
        working = false;
      }
      if (!working && time_ns >= due_ns) {
        working = true;
        busy_until_us = wall_us + work_us();
        due_ns += kPeriod_ns *
                  std::max<std::int64_t>(1, (time_ns - due_ns + kPeriod_ns - 1) / kPeriod_ns);
      }
      for (int tick = 0; tick < ticks_at_once && time_ns < begin_ns + 1000 * wall_us; ++tick) {
        const bool learnt = stamps.size() > 12;
        const bool goes_on = learnt
                                 ? time_ns + kFine_ns <= phase.ticks_end_ns(kFine_ns, 2 * kStep_ns)
                                 : time_ns < due_ns + 2 * kStep_ns;
        if (goes_on) {
          time_ns += kFine_ns;
        } else {
          phase.stands(wall);
          break;
        }
      }
    }
  }
};

TEST(TimerPhase, HardlyAStampIsThereTwiceAndNoPeriodIsLeftOutWhileItsWorkTakesUpToThree) {
  for (const int max_work_us : {100, 800, 2500, 5500, 8000}) {
    std::size_t twice = 0;
    std::size_t all = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
      Timer node{seed};
      std::uniform_int_distribution<int> work_us(50, max_work_us);
      const auto work = [&] { return work_us(node.random); };
      node.run(30'000, work);
      const std::size_t begin = node.stamps.size();
      const std::int64_t from_ns = node.time_ns;
      node.run(5'000, work);
      for (std::size_t k = begin + 1; k < node.stamps.size(); ++k)
        twice += node.stamps[k] <= node.stamps[k - 1] ? 1U : 0U;
      all += node.stamps.size() - begin;
      const double periods = static_cast<double>(node.time_ns - from_ns) / Timer::kPeriod_ns;
      EXPECT_NEAR(static_cast<double>(node.stamps.size() - begin), periods, 2.0) << max_work_us;
    }
    const bool fast = max_work_us < 1e-3 * Timer::kPeriod_ns;
    EXPECT_LE(twice, fast ? 0 : all / 1000) << max_work_us;
  }
}

TEST(TimerPhase, ANodeThatIsFastEnoughHoldsThePaceOfTheWallWhateverDelaysItNowAndThen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Timer node{seed};
    node.ticks_at_once = 4;
    node.way_us = 700;
    std::uniform_int_distribution<int> work_us(500, 1500), delay_us(3000, 6000);
    std::bernoulli_distribution delayed(0.03);
    node.run(20'000,
             [&] { return delayed(node.random) ? delay_us(node.random) : work_us(node.random); });
    EXPECT_GT(static_cast<double>(node.time_ns), 0.98 * 1e3 * static_cast<double>(node.wall_us));
  }
}

TEST(TimerPhase, AMessageThatIsLostLeavesThePhase) {
  TimerPhase phase;
  std::int64_t stamp_ns = 0;
  for (int k = 0; k < 100; ++k) phase.called(stamp_ns += Timer::kPeriod_ns, kFine_ns);
  const std::int64_t before_ns = phase.ticks_end_ns(kFine_ns, 2 * kStep_ns) - stamp_ns;
  phase.called(stamp_ns += 2 * Timer::kPeriod_ns, kFine_ns);
  EXPECT_NEAR(static_cast<double>(phase.ticks_end_ns(kFine_ns, 2 * kStep_ns) - stamp_ns),
              static_cast<double>(before_ns), 1e5);
}

TEST(TimerPhase, AnotherPeriodIsLearntAndAGapIsNone) {
  TimerPhase phase;
  std::int64_t stamp_ns = 0;
  const auto call = [&](int times, std::int64_t apart_ns) {
    for (int k = 0; k < times; ++k) phase.called(stamp_ns += apart_ns, kFine_ns);
    return phase.ticks_end_ns(kFine_ns, 2 * kStep_ns) - stamp_ns;
  };
  EXPECT_NEAR(static_cast<double>(call(100, 2'600'000)), 3.9e6, 1e4);
  EXPECT_NEAR(static_cast<double>(call(1, 900'000'000)), 3.9e6, 1e4);
  EXPECT_NEAR(static_cast<double>(call(20, 10'000'000)), 15e6, 2e4)
      << "at most the lag of two steps";
}

}  // namespace
}  // namespace rosflight_sim
