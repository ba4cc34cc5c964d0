// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/gap_watch.hpp"

#include <gtest/gtest.h>

namespace rosflight::autonomy {
namespace {

TEST(GapWatch, AGapLastsFromTheLastGoodStepToTheNext) {
  GapWatch watch;
  watch.start(5.0);
  EXPECT_DOUBLE_EQ(watch.step(5.25, true, 0.0), 0.25);
  for (const double t_s : {5.5, 9.0, 16.0}) {
    EXPECT_EQ(watch.step(t_s, false, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(watch.lasts_s(t_s), t_s - 5.25);
  }
  EXPECT_DOUBLE_EQ(watch.step(16.25, true, 0.0), 11.0);
  EXPECT_DOUBLE_EQ(watch.step(16.5, true, 0.0), 0.25);
}

/// A state is believed for half a second after the link has fallen silent.
TEST(GapWatch, TheSilenceOfTheLinkCountsFromItsBeginning) {
  GapWatch watch;
  watch.start(0.0);
  watch.step(10.5, true, 0.5);
  watch.step(20.25, false, 10.25);
  EXPECT_DOUBLE_EQ(watch.step(20.5, true, 0.0), 10.25);
  watch.step(25.0, false, 0.0);
  EXPECT_DOUBLE_EQ(watch.step(26.0, true, 0.0), 5.5) << "the silence before is over";
}

TEST(GapWatch, ALinkIsSilentAfterHalfASecond) {
  EXPECT_TRUE(GapWatch::linked(0.5));
  EXPECT_FALSE(GapWatch::linked(0.51));
}

TEST(GapWatch, AStateIsMissedOnlyFromWhereTheLinkIsBack) {
  GapWatch watch;
  watch.start(0.0);
  watch.step(1.0, true, 0.0);
  watch.step(1.5, false, 0.0);
  EXPECT_DOUBLE_EQ(watch.linked_s(1.5), 0.5) << "the state alone is lost";
  watch.step(3.0, false, 2.0);
  EXPECT_EQ(watch.linked_s(3.0), 0.0);
  watch.step(3.25, false, 0.0);
  EXPECT_DOUBLE_EQ(watch.linked_s(3.25), 0.25);
}

}  // namespace
}  // namespace rosflight::autonomy
