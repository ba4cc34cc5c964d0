// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/pid.hpp"

#include <gtest/gtest.h>

namespace rosflight::autonomy {
namespace {

constexpr double kExact = 1e-12;  // a few roundings of numbers near one

TEST(Pid, ProportionalAndRateTerms) {
  Pid pid({2.0, 0.0, 0.5});
  EXPECT_NEAR(pid.step_with_rate(1.0, 0.25, 0.4, 0.01), 2.0 * 0.75 - 0.5 * 0.4, kExact);
}

TEST(Pid, IntegralIsTheTrapezoidOfTheError) {
  Pid pid({0.0, 2.0, 0.0});
  // errors 1, 3, 2 at 0.1 s: areas 0.1*1 (nothing before it), 0.1*2, 0.1*2.5; times ki
  EXPECT_NEAR(pid.step(1.0, 0.0, 0.1), 0.2, kExact);
  EXPECT_NEAR(pid.step(3.0, 0.0, 0.1), 0.6, kExact);
  EXPECT_NEAR(pid.step(2.0, 0.0, 0.1), 1.1, kExact);
}

TEST(Pid, DirtyDerivativeByHand) {
  // tau 0.05, dt 0.02: factors (0.1-0.02)/(0.12) = 2/3 and 2/0.12 = 50/3. x = 1, 1.3, 1.3
  Pid pid({0.0, 0.0, 3.0}, {}, 0.05);
  EXPECT_NEAR(pid.step(0.0, 1.0, 0.02), 0.0, kExact);
  EXPECT_NEAR(pid.step(0.0, 1.3, 0.02), -3.0 * 5.0, 1e-11);
  EXPECT_NEAR(pid.step(0.0, 1.3, 0.02), -3.0 * 10.0 / 3.0, 1e-11);
}

TEST(Pid, DirtyDerivativeOfARampSettlesAtItsSlope) {
  Pid pid({0.0, 0.0, 1.0}, {}, 0.05);
  double out = 0.0;
  for (int k = 0; k < 200; ++k) out = pid.step(0.0, 0.7 * 0.01 * k, 0.01);
  EXPECT_NEAR(out, -0.7, 1e-9);  // after 40 time constants
}

// Weak point 39: the first derivative sample took the value before it as 0.
TEST(Pid, FirstSampleHasNoDerivativeKick) {
  Pid pid({0.0, 0.0, 1.0});
  EXPECT_EQ(pid.step(100.0, 100.0, 0.01), 0.0);
  pid.step(100.0, 50.0, 0.01);
  pid.reset();
  EXPECT_EQ(pid.step(-30.0, -30.0, 0.01), 0.0);
}

// Weak point 40: I was dropped for each sample in which P - D alone saturated.
TEST(Pid, SaturationHoldsTheIntegral) {
  Pid pid({1.0, 1.0, 0.0}, {-1.0, 1.0}, 0.05);
  for (int k = 0; k < 50; ++k) pid.step(0.5, 0.0, 0.01);
  const double before = pid.integral();
  EXPECT_NEAR(before, 0.25, 1e-9);
  EXPECT_EQ(pid.step(10.0, 0.0, 0.01), 1.0);
  EXPECT_EQ(pid.integral(), before);
  // out of saturation the integral is still there: 0.1 + 0.25 plus one step of the trapezoid, 0.01
  // * 5.05
  EXPECT_NEAR(pid.step(0.1, 0.0, 0.01), 0.1 + before + 0.01 * 0.5 * (10.0 + 0.1), 1e-9);
}

TEST(Pid, IntegralStopsExactlyAtTheLimit) {
  Pid pid({1.0, 10.0, 0.0}, {-1.0, 1.0}, 0.05);
  for (int k = 0; k < 1000; ++k) EXPECT_LE(pid.step(0.6, 0.0, 0.01), 1.0);
  EXPECT_NEAR(pid.integral(), 0.4, kExact);
  // no winding up: an opposite error acts at once
  EXPECT_LT(pid.step(-0.1, 0.0, 0.001), 0.4);
}

TEST(Pid, SaturatedIntegralStillUnwinds) {
  Pid pid({0.0, 1.0, 0.0}, {-1.0, 1.0}, 0.05);
  pid.set_integral(5.0);
  EXPECT_EQ(pid.step(-1.0, 0.0, 0.1), 1.0);
  EXPECT_NEAR(pid.integral(), 4.9, kExact);
}

// Weak point 40: gains below zero were ignored.
TEST(Pid, NegativeGainsAct) {
  Pid pid({-1.0, -2.0, -0.5}, {-10.0, 10.0}, 0.05);
  EXPECT_NEAR(pid.step_with_rate(1.0, 0.0, 3.0, 0.1), -1.0 - 0.2 + 1.5, kExact);
  Pid limited({0.0, -1.0, 0.0}, {-0.3, 0.3}, 0.05);
  for (int k = 0; k < 100; ++k) limited.step(1.0, 0.0, 0.1);
  EXPECT_NEAR(limited.integral(), -0.3, kExact);
}

TEST(Pid, GainChangeDoesNotJump) {
  Pid pid({1.0, 1.0, 0.0});
  double before = 0.0;
  for (int k = 0; k < 100; ++k) before = pid.step(1.0, 0.0, 0.01);
  pid.set_gains({1.0, 5.0, 0.0});
  EXPECT_NEAR(pid.step(1.0, 0.0, 1e-9), before, 1e-6);
  pid.set_gains({1.0, 0.0, 0.0});
  EXPECT_EQ(pid.integral(), 0.0);
}

TEST(Pid, NotIntegratingKeepsTheIntegral) {
  Pid pid({0.0, 1.0, 0.0});
  pid.step(1.0, 0.0, 0.1);
  EXPECT_NEAR(pid.step(1.0, 0.0, 0.1, Pid::Integrate::kNo), 0.1, kExact);
}

// Weak point 31: a repeated stamp (dt = 0) gave an output of 0.
TEST(Pid, RepeatedTimeRepeatsTheOutput) {
  Pid pid({2.0, 1.0, 0.1});
  const double out = pid.step(1.0, 0.5, 0.01);
  EXPECT_EQ(pid.step(9.0, -4.0, 0.0), out);
  EXPECT_EQ(pid.step(9.0, -4.0, -1.0), out);
  EXPECT_EQ(pid.step_with_rate(9.0, -4.0, 1.0, 0.0), out);
}

TEST(Pid, BadNumbersChangeNothing) {
  Pid pid({2.0, 1.0, 0.1});
  Pid twin = pid;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double out = pid.step(1.0, 0.5, 0.01);
  twin.step(1.0, 0.5, 0.01);
  EXPECT_EQ(pid.step(nan, 0.5, 0.01), out);
  EXPECT_EQ(pid.step(1.0, nan, 0.01), out);
  EXPECT_EQ(pid.step(1.0, kInfinity, 0.01), out);
  EXPECT_EQ(pid.step(1.0, 0.5, nan), out);
  EXPECT_EQ(pid.step_with_rate(1.0, 0.5, nan, 0.01), out);
  EXPECT_EQ(pid.step(0.9, 0.6, 0.01), twin.step(0.9, 0.6, 0.01));
}

TEST(Pid, LongGapRestartsTheDerivativeAndKeepsTheIntegral) {
  Pid pid({0.0, 1.0, 1.0});
  pid.step(1.0, 0.0, 0.5);
  EXPECT_NEAR(pid.step(100.0, 50.0, 5.0), pid.integral(), kExact);
  EXPECT_NEAR(pid.integral(), 0.5, kExact);
}

}  // namespace
}  // namespace rosflight::autonomy
