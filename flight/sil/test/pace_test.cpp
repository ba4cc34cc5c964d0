// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/pace.hpp"

#include <gtest/gtest.h>

namespace rosflight::flight {
namespace {

using hal::microseconds;
using hal::milliseconds;
using hal::Time;

constexpr Time kStep = microseconds(2500);
constexpr Time kStart = milliseconds(7000);

TEST(Pace, TicksDoNotDriftWhenServedLate) {
  Pace pace(kStart, kStep);
  for (int k = 0; k < 400; ++k) {
    EXPECT_EQ(pace.tick(), kStart + k * kStep);
    pace.advance(pace.tick() + (k % 7) * microseconds(300));
  }
  EXPECT_EQ(pace.tick(), kStart + milliseconds(1000));
  EXPECT_EQ(pace.slips(), 0u);
}

TEST(Pace, MakesUpForADelayItCanBear) {
  Pace pace(kStart, kStep);
  pace.advance(kStart + Pace::kMaxDelay);
  EXPECT_EQ(pace.tick(), kStart + kStep);
  EXPECT_EQ(pace.slips(), 0u);
}

TEST(Pace, MovesBehindALongPauseInsteadOfRacing) {
  Pace pace(kStart, kStep);
  const Time late = kStart + Pace::kMaxDelay + microseconds(1);
  pace.advance(late);
  EXPECT_EQ(pace.tick(), late + kStep);
  EXPECT_EQ(pace.slips(), 1u);
}

}  // namespace
}  // namespace rosflight::flight
