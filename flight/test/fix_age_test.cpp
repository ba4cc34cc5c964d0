// SPDX-License-Identifier: BSD-3-Clause
#include "flight/fix_age.hpp"

#include <gtest/gtest.h>

namespace rosflight::flight {
namespace {

constexpr double kUnix_s = 1'780'336'800.0;

TEST(FixAge, AFixThatIsHalfASecondLateWasTakenHalfASecondEarlier) {
  FixAge age;
  for (int k = 0; k < 100; ++k) {
    const double t = 10.0 + 0.1 * k;
    EXPECT_EQ(age.time_of_fix(t, kUnix_s + t - 10.0), t);
  }
  EXPECT_NEAR(age.time_of_fix(20.5, kUnix_s + 10.0), 20.0, 2e-4);
}

TEST(FixAge, JitterBelowTheToleranceChangesNothing) {
  FixAge age;
  EXPECT_EQ(age.time_of_fix(10.0, kUnix_s), 10.0);
  EXPECT_EQ(age.time_of_fix(10.18, kUnix_s + 0.1), 10.18);
}

TEST(FixAge, ClocksThatDriftApartAreNoDelay) {
  FixAge age;
  for (int k = 0; k < 40'000; ++k) {
    const double t = 0.1 * k;
    ASSERT_EQ(age.time_of_fix(t, kUnix_s + t * (1.0 - 5e-5)), t) << "50 ppm";
  }
}

TEST(FixAge, AReceiverThatIsOnTimeAgainIsBelieved) {
  FixAge age;
  static_cast<void>(age.time_of_fix(9.5, kUnix_s + 9.0));  // late from the start on
  EXPECT_EQ(age.time_of_fix(10.0, kUnix_s + 10.0), 10.0);
  EXPECT_NEAR(age.time_of_fix(11.5, kUnix_s + 11.0), 11.0, 2e-4);
}

TEST(FixAge, WithoutUtcThereIsNoAge) {
  FixAge age;
  EXPECT_EQ(age.time_of_fix(10.0, 0.0), 10.0);
  EXPECT_EQ(age.time_of_fix(20.0, 0.0), 20.0);
}

}  // namespace
}  // namespace rosflight::flight
