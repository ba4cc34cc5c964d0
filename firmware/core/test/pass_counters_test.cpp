// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/pass_counters.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace rosflight::core {
namespace {

TEST(PassCounters, CountsPassesTheLongestAndThoseAboveTheBudget) {
  PassCounters c;
  Time now{};
  for (const int us : {100, 2000, 2001, 300}) c.pass(now, hal::microseconds(us), false);
  EXPECT_EQ(c.passes(), 4u);
  EXPECT_EQ(c.over_budget(), 1u);
  EXPECT_EQ(c.longest(), hal::microseconds(2001));
}

TEST(PassCounters, ThreeSlowPassesWithinASecondAreTooSlow) {
  PassCounters c;
  const Time slow = hal::milliseconds(3);
  c.pass(hal::milliseconds(0), slow, false);
  c.pass(hal::milliseconds(500), slow, false);
  EXPECT_TRUE(c.in_time(hal::milliseconds(500)));
  c.pass(hal::milliseconds(900), slow, false);
  EXPECT_FALSE(c.in_time(hal::milliseconds(900)));
  EXPECT_FALSE(c.in_time(hal::milliseconds(1000)));
  EXPECT_TRUE(c.in_time(hal::milliseconds(1001))) << "the oldest is more than a second ago";
}

TEST(PassCounters, WritingToStorageIsCountedButNotJudged) {
  PassCounters c;
  for (int k = 0; k < 110; ++k) c.pass(hal::milliseconds(8 * k), hal::milliseconds(8), true);
  EXPECT_EQ(c.over_budget(), 110u);
  EXPECT_TRUE(c.in_time(hal::milliseconds(880)));
}

TEST(PassCounters, JitterIsTheChangeOfTheDelayBetweenStampAndArrival) {
  PassCounters c;
  const auto arrive = [&c](std::int64_t stamp_us, std::int64_t delay_us) {
    c.imu(hal::microseconds(stamp_us + delay_us), hal::microseconds(stamp_us));
  };
  arrive(0, 0);
  for (int k = 1; k <= 10; ++k) arrive(2500 * k, 0);
  EXPECT_EQ(c.jitter()[0], 11u);
  arrive(30'000, 10);  // 10 us: the second bin begins there
  EXPECT_EQ(c.jitter()[1], 1u);
  arrive(32'500, 10'010);
  EXPECT_EQ(c.jitter()[7], 1u) << "10 ms and more";
  arrive(35'000, 9'710);
  EXPECT_EQ(c.jitter()[4], 1u) << "earlier counts as later: 300 us";
  EXPECT_EQ(std::accumulate(c.jitter().begin(), c.jitter().end(), 0u), 14u);
}

}  // namespace
}  // namespace rosflight::core
