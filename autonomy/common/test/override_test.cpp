// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy::test {
namespace {

constexpr std::uint16_t kNotActive = 0x3C0, kStickY = 0x08;
constexpr double kStep_s = 0.01;

TEST(OverrideWatch, AChannelThatIsNotActiveForAMomentIsNoPilot) {
  OverrideWatch watch;
  ASSERT_FALSE(watch.step(0, kStep_s).any());
  double waited_s = 0.0;
  while (!watch.step(kNotActive, kStep_s).any()) waited_s += kStep_s;
  EXPECT_NEAR(waited_s, OverrideWatch::kHandover_s, 1.5 * kStep_s);
  EXPECT_TRUE(watch.step(kNotActive, kStep_s).yaw);
  EXPECT_FALSE(watch.step(0, kStep_s).any());
  EXPECT_FALSE(watch.step(kNotActive, kStep_s).any()) << "another moment";
}

TEST(OverrideWatch, APilotCountsAtOnceAndUntilAutonomyHasControl) {
  OverrideWatch watch;
  ASSERT_FALSE(watch.step(0, kStep_s).any());
  EXPECT_TRUE(watch.step(kStickY, kStep_s).roll_pitch);
  EXPECT_TRUE(watch.step(kNotActive, kStep_s).any()) << "not given back yet";
}

TEST(OverrideWatch, BeforeTheFirstControlNotActiveMeansThePilot) {
  OverrideWatch watch;
  EXPECT_TRUE(watch.step(kNotActive, kStep_s).any());
}

}  // namespace
}  // namespace rosflight::autonomy::test
