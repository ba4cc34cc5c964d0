// SPDX-License-Identifier: BSD-3-Clause
#include "sim/time_sources.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace rosflight::sim {
namespace {

/// A wall clock in the test's hands: sleeping moves it, work is added by hand.
class FakeWall : public WallClock {
 public:
  Time now() override { return now_; }
  void sleep_until(Time wall) override {
    ++sleeps_;
    now_ = wall;
  }
  void work(Time duration) { now_ += duration; }
  int sleeps() const { return sleeps_; }

 private:
  Time now_{5'000'000};
  int sleeps_{0};
};

TEST(LockStepTime, StepsAreAllTheSame) {
  LockStepTime time(Time{2500});
  EXPECT_EQ(time.advance(Time{0}), Time{2500});
  EXPECT_EQ(time.advance(Time{1'000'000}), Time{1'002'500});
  EXPECT_THROW(LockStepTime(Time{0}), std::invalid_argument);
  EXPECT_THROW(LockStepTime(Time{-1}), std::invalid_argument);
}

TEST(PacedTime, KeepsTheFactorToTheMicrosecondWhateverTheWorkCosts) {
  FakeWall wall;
  PacedTime time(Time{2500}, 3.0, wall);
  const Time wall_start = wall.now();
  Time t{};
  for (int i = 0; i < 3000; ++i) {
    t = time.advance(t);
    wall.work(Time{(i * 7) % 500});  // always less than the 833 us there are
  }
  t = time.advance(t);
  EXPECT_EQ(t, Time{3001 * 2500});
  EXPECT_EQ(wall.now() - wall_start, Time{2'500'833});  // 7.5025 s / 3
  EXPECT_EQ(time.slips(), 0U);
}

TEST(PacedTime, CatchesUpASmallDelay) {
  FakeWall wall;
  PacedTime time(Time{10'000}, 1.0, wall);
  const Time wall_start = wall.now();
  Time t = time.advance(Time{0});
  wall.work(Time{55'000});
  for (int i = 0; i < 9; ++i) t = time.advance(t);
  EXPECT_EQ(wall.now() - wall_start, Time{100'000});
  EXPECT_EQ(time.slips(), 0U);
}

TEST(PacedTime, DoesNotRaceAfterALongStop) {
  FakeWall wall;
  PacedTime time(Time{10'000}, 1.0, wall);
  Time t = time.advance(Time{0});
  wall.work(Time{60'000'000});
  t = time.advance(t);
  EXPECT_EQ(time.slips(), 1U);
  const Time resumed = wall.now();
  for (int i = 0; i < 10; ++i) t = time.advance(t);
  EXPECT_EQ(wall.now() - resumed, Time{100'000});
  EXPECT_EQ(t, Time{120'000});
}

TEST(PacedTime, ChangesItsFactorWithoutAJump) {
  FakeWall wall;
  PacedTime time(Time{10'000}, 1.0, wall);
  Time t = time.advance(Time{0});
  time.set_factor(10.0);
  const Time changed = wall.now();
  t = time.advance(t);
  EXPECT_EQ(wall.now() - changed, Time{1000});
  EXPECT_EQ(t, Time{20'000});
}

TEST(PacedTime, RefusesNonsense) {
  FakeWall wall;
  for (const double factor : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(PacedTime(Time{1}, factor, wall), std::invalid_argument);
  }
  EXPECT_THROW(PacedTime(Time{0}, 1.0, wall), std::invalid_argument);
}

TEST(SteadyWallClock, SleepsAtLeastUntilTheTimeGiven) {
  SteadyWallClock wall;
  const Time until = wall.now() + Time{2000};
  wall.sleep_until(until);
  EXPECT_GE(wall.now(), until);
}

}  // namespace
}  // namespace rosflight::sim
