// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/core/imu_clock.hpp"

namespace rosflight::flight {
namespace {

using core::ImuClock;
using hal::microseconds;
using hal::milliseconds;
using hal::Time;

constexpr Time kStep = microseconds(2500);
constexpr Time kStart = milliseconds(7000);

TEST(Pace, TicksDoNotDriftWhenServedLate) {
  Pace pace(kStart, kStep);
  for (int k = 0; k < 400; ++k) {
    EXPECT_EQ(pace.tick(), kStart + k * kStep);
    pace.begin(pace.tick() + (k % 7) * microseconds(300));
    pace.advance();
  }
  EXPECT_EQ(pace.tick(), kStart + milliseconds(1000));
  EXPECT_EQ(pace.slips(), 0u);
}

TEST(Pace, MakesUpForADelayItCanBear) {
  Pace pace(kStart, kStep);
  EXPECT_EQ(pace.begin(kStart + Pace::kMaxDelay), kStart);
  pace.advance();
  EXPECT_EQ(pace.tick(), kStart + kStep);
  EXPECT_EQ(pace.slips(), 0u);
}

TEST(Pace, MovesBehindALongPauseInsteadOfRacing) {
  Pace pace(kStart, kStep);
  const Time late = kStart + Pace::kMaxDelay + microseconds(1);
  EXPECT_EQ(pace.begin(late), late);
  pace.advance();
  EXPECT_EQ(pace.tick(), late + kStep);
  EXPECT_EQ(pace.slips(), 1u);
}

TEST(Pace, TheFirmwareTakesEachSampleOfADelayThatIsMadeUp) {
  static_assert(Pace::kMaxDelay < ImuClock::kTolerance);
  Pace pace(kStart, kStep);
  ImuClock clock;
  Time now = kStart;
  int rejected = 0;
  for (int k = 0; k < 4000; ++k) {
    now += k % 500 == 250 ? milliseconds(1 + 14 * (k / 500)) : Time{0};  // 1 to 99 ms late
    now = std::max(now, pace.tick());
    const Time stamp = pace.begin(now);
    rejected += k > 10 && !clock.step(stamp, now).usable ? 1 : 0;
    pace.advance();
  }
  EXPECT_EQ(rejected, 0);
  EXPECT_EQ(pace.slips(), 5u);
}

}  // namespace
}  // namespace rosflight::flight
