// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_clock.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rosflight::core {
namespace {

using hal::microseconds;
using hal::milliseconds;

constexpr Time kPeriod = microseconds(2500);

/// A stream of samples that arrive 1 ms after their stamps.
class ImuClockTest : public ::testing::Test {
 protected:
  ImuClock::Step sample(Time offset = Time{0}) {
    now_ += kPeriod;
    return clock_.step(now_ + offset, now_ + milliseconds(1));
  }
  void stream(int count) {
    for (int k = 0; k < count; ++k) ASSERT_TRUE(sample().usable);
  }

  ImuClock clock_;
  Time now_{milliseconds(1000)};
};

TEST_F(ImuClockTest, TheFirstSampleHasNoTimeStepTheOthersHaveThatOfTheirStamps) {
  const ImuClock::Step first = sample();
  EXPECT_TRUE(first.usable && first.restarted);
  EXPECT_EQ(first.dt_s, 0.0f);
  for (int k = 0; k < 5; ++k) {
    const ImuClock::Step s = sample();
    EXPECT_TRUE(s.usable && !s.restarted && !s.backwards && !s.standing);
    EXPECT_FLOAT_EQ(s.dt_s, 0.0025f);
  }
}

TEST_F(ImuClockTest, ASingleOutlierIsUnusableAndChangesNothing) {
  for (const int ahead_ms : {60, 150, 100'000, -60, -150, -900}) {
    stream(10);
    const ImuClock::Step bad = sample(milliseconds(ahead_ms));
    EXPECT_FALSE(bad.usable) << ahead_ms;
    EXPECT_EQ(bad.backwards, ahead_ms < 0);
    const ImuClock::Step next = sample();
    EXPECT_TRUE(next.usable && !next.restarted);
    EXPECT_FLOAT_EQ(next.dt_s, 0.005f);
  }
}

TEST_F(ImuClockTest, FiftyMillisecondsOfJitterAreAllowed) {
  stream(10);
  EXPECT_TRUE(sample(milliseconds(50)).usable);
  now_ += milliseconds(100);
  stream(1);
  EXPECT_FALSE(sample(microseconds(50'001)).usable);
}

TEST_F(ImuClockTest, AGapIsATimeStepOfItsLength) {
  stream(10);
  now_ += milliseconds(5000);
  const ImuClock::Step s = sample();
  EXPECT_TRUE(s.usable && !s.restarted);
  EXPECT_FLOAT_EQ(s.dt_s, 5.0025f);
}

TEST_F(ImuClockTest, AClockThatWasSetIsFollowedAfterThreeSamples) {
  for (const std::int64_t jump_ms : {100LL, -100LL, 3'600'000LL, -500'000LL}) {
    clock_ = ImuClock{};
    now_ = milliseconds(1'000'000);
    stream(10);
    const Time jump = milliseconds(jump_ms);
    EXPECT_FALSE(sample(jump).usable);
    EXPECT_FALSE(sample(jump).usable);
    const ImuClock::Step third = sample(jump);
    EXPECT_TRUE(third.usable && third.restarted && !third.backwards);
    EXPECT_FLOAT_EQ(third.dt_s, 0.0075f);
    const ImuClock::Step next = sample(jump);
    EXPECT_TRUE(next.usable && !next.restarted);
    EXPECT_FLOAT_EQ(next.dt_s, 0.0025f);
  }
}

TEST_F(ImuClockTest, OutliersThatDisagreeAreNeverFollowed) {
  stream(10);
  for (int k = 0; k < 100; ++k) {
    EXPECT_FALSE(sample(milliseconds(k % 2 == 0 ? 200 : 400)).usable);
  }
  EXPECT_TRUE(sample().usable);
  // Two that agree, one good, two that agree: not in a row.
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(sample(k % 3 == 2 ? Time{0} : milliseconds(200)).usable, k % 3 == 2) << k;
  }
}

TEST_F(ImuClockTest, AClockThatRunsBackwardsIsNeverUsable) {
  stream(10);
  for (int k = 1; k < 1000; ++k) {
    const ImuClock::Step s = sample(microseconds(-5000) * k);
    EXPECT_FALSE(s.usable) << k;
    EXPECT_TRUE(s.backwards) << k;
  }
  now_ += milliseconds(1);
  EXPECT_TRUE(sample().usable);
}

TEST_F(ImuClockTest, TwentyEqualStampsAreAClockThatStands) {
  stream(10);
  const Time stamp = now_;
  for (int k = 2; k < 20; ++k) {
    now_ += kPeriod;
    const ImuClock::Step s = clock_.step(stamp, now_ + milliseconds(1));
    EXPECT_TRUE(s.usable) << k;
    EXPECT_EQ(s.dt_s, 0.0f);
  }
  for (int k = 20; k < 100; ++k) {
    now_ += kPeriod;
    const ImuClock::Step s = clock_.step(stamp, now_ + milliseconds(1));
    EXPECT_FALSE(s.usable) << k;
    EXPECT_TRUE(s.standing && !s.backwards);
  }
  const ImuClock::Step moves = sample();
  EXPECT_TRUE(moves.usable && !moves.restarted);
  EXPECT_FLOAT_EQ(moves.dt_s, 99 * 0.0025f);  // none of the time is lost
}

TEST_F(ImuClockTest, APausedSimulationIsNoClockThatStands) {
  stream(10);
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(clock_.step(now_, now_ + milliseconds(1)).usable);
}

TEST_F(ImuClockTest, TakesAnyNumber) {
  stream(10);
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t stamp_us : {kMin, kMax, kMin + 1, kMax - 1, std::int64_t{-1}}) {
    now_ += kPeriod;
    EXPECT_FALSE(clock_.step(Time{stamp_us}, now_).usable) << stamp_us;
  }
  EXPECT_TRUE(sample().usable);
}

}  // namespace
}  // namespace rosflight::core
