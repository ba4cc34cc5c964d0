// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/pid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rosflight::core {
namespace {

constexpr float kNoLimit = 1e9f;

Pid make(float p, float i, float d) {
  Pid pid;
  pid.configure({p, i, d});
  return pid;
}

TEST(Pid, IsTheSumOfItsThreeTerms) {
  Pid pid = make(2.0f, 0.5f, 0.1f);
  // e = 3 - 1 = 2: P = 4, D = 0.1 * 5, s = 2 * 0.01, I = 0.01
  EXPECT_FLOAT_EQ(pid.step(3.0f - 1.0f, 5.0f, 0.01f, true, false, kNoLimit), 4.0f - 0.5f + 0.01f);
  EXPECT_FLOAT_EQ(pid.step(3.0f - 1.0f, 5.0f, 0.01f, true, false, kNoLimit), 4.0f - 0.5f + 0.02f);
}

TEST(Pid, TermsWithoutGainDoNothing) {
  Pid pid = make(2.0f, 0.0f, 0.0f);
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(pid.step(1.0f, 50.0f, 0.01f, true, false, kNoLimit), 2.0f);
  }
  pid.configure({2.0f, 1.0f, 0.0f});  // nothing was collected meanwhile
  EXPECT_EQ(pid.step(0.0f, 0.0f, 0.01f, true, false, kNoLimit), 0.0f);
}

TEST(Pid, HoldsItsIntegralWhileIntegrationWaits) {
  // Weak point 40: in ROSflight 2.x the I term vanishes for as long as integration is paused.
  Pid pid = make(0.0f, 1.0f, 0.0f);
  for (int k = 0; k < 100; ++k) {
    static_cast<void>(pid.step(1.0f, 0.0f, 0.01f, true, false, kNoLimit));
  }
  EXPECT_NEAR(pid.step(5.0f, 0.0f, 0.01f, false, false, kNoLimit), 1.0f, 1e-5f);
  EXPECT_NEAR(pid.step(5.0f, 0.0f, 0.01f, false, false, kNoLimit), 1.0f, 1e-5f);
}

TEST(Pid, ClampsItsIntegralTerm) {
  Pid pid = make(0.0f, 2.0f, 0.0f);
  for (int k = 0; k < 1000; ++k) {
    ASSERT_LE(pid.step(1.0f, 0.0f, 0.01f, true, false, 0.3f), 0.3f + 1e-6f);
  }
  // It does not have to unwind what never counted: back below after one step of the other sign.
  EXPECT_LT(pid.step(-1.0f, 0.0f, 0.01f, true, false, 0.3f), 0.3f);
  for (int k = 0; k < 1000; ++k) {
    ASSERT_GE(pid.step(-1.0f, 0.0f, 0.01f, true, false, 0.3f), -0.3f - 1e-6f);
  }
}

TEST(Pid, AnotherIntegralGainMakesNoStep) {
  for (const float gain : {0.25f, 4.0f, 100.0f, 1e-6f, 0.0f}) {
    Pid pid = make(0.0f, 1.0f, 0.0f);
    for (int k = 0; k < 100; ++k) {
      static_cast<void>(pid.step(1.0f, 0.0f, 0.01f, true, false, kNoLimit));
    }
    pid.configure({0.0f, gain, 0.0f});
    EXPECT_NEAR(pid.step(0.0f, 0.0f, 0.01f, true, false, kNoLimit), 1.0f, 1e-5f) << gain;
    EXPECT_NEAR(pid.step(1.0f, 0.0f, 0.01f, true, false, kNoLimit), 1.0f + 0.01f * gain, 1e-5f);
  }
}

TEST(Pid, SaturationStopsTheIntegralOnlyInItsOwnDirection) {
  const auto integral = [](Pid& pid) { return pid.step(0.0f, 0.0f, 0.0f, false, false, kNoLimit); };
  for (const float sign : {1.0f, -1.0f}) {
    Pid pid = make(2.0f, 1.0f, 0.0f);
    for (int k = 0; k < 50; ++k) {
      static_cast<void>(pid.step(sign, 0.0f, 0.01f, true, true, kNoLimit));
    }
    EXPECT_EQ(integral(pid), 0.0f) << "an output that does not fit is not made larger";
    for (int k = 0; k < 50; ++k) {
      static_cast<void>(pid.step(sign, 0.0f, 0.01f, true, false, kNoLimit));
    }
    const float full = integral(pid);
    EXPECT_NEAR(full, 0.5f * sign, 1e-5f);
    static_cast<void>(pid.step(sign, 0.0f, 0.01f, true, true, kNoLimit));
    EXPECT_EQ(integral(pid), full);
    static_cast<void>(pid.step(-sign, 0.0f, 0.01f, true, true, kNoLimit));
    EXPECT_NEAR(integral(pid), full - 0.01f * sign, 1e-6f) << "but it unwinds";
    for (int k = 0; k < 1000; ++k) {
      static_cast<void>(pid.step(-sign, 0.0f, 0.01f, true, true, kNoLimit));
    }
    EXPECT_NEAR(integral(pid), 0.0f, 0.011f) << "to zero, and no further";
  }
  // The derivative saturates the output; an error of the other sign may be integrated.
  Pid pid = make(0.0f, 1.0f, 1.0f);
  static_cast<void>(pid.step(1.0f, 50.0f, 0.01f, true, true, kNoLimit));
  EXPECT_NEAR(integral(pid), 0.01f, 1e-6f);
}

TEST(Pid, NotANumberNeverStaysInALoop) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {kNan, kInf, -kInf}) {
    Pid pid = make(1.0f, 1.0f, 1.0f);
    static_cast<void>(pid.derivative(1.0f, 0.01f, 0.05f));
    const float d = pid.derivative(1.5f, 0.01f, 0.05f);
    static_cast<void>(pid.step(1.0f, d, 0.01f, true, false, 1.0f));
    EXPECT_FALSE(std::isfinite(pid.step(bad, 0.0f, 0.01f, true, false, 1.0f)));
    EXPECT_FALSE(std::isfinite(pid.derivative(bad, 0.01f, 0.05f)));
    EXPECT_FLOAT_EQ(pid.derivative(1.5f, 0.0f, 0.05f), d);
    EXPECT_FLOAT_EQ(pid.step(0.0f, 0.0f, 0.01f, true, false, 1.0f), 0.01f);
  }
}

TEST(Pid, ResetForgetsAllButTheGains) {
  Pid pid = make(1.0f, 1.0f, 1.0f);
  static_cast<void>(pid.derivative(1.0f, 0.01f, 0.05f));
  static_cast<void>(pid.derivative(2.0f, 0.01f, 0.05f));
  static_cast<void>(pid.step(1.0f, 0.0f, 1.0f, true, false, kNoLimit));
  pid.reset();
  EXPECT_EQ(pid.derivative(7.0f, 0.01f, 0.05f), 0.0f);
  EXPECT_EQ(pid.step(2.0f, 0.0f, 0.0f, true, false, kNoLimit), 2.0f);
}

TEST(PidDerivative, FollowsTheTustinFormula) {
  Pid pid = make(0.0f, 0.0f, 1.0f);
  constexpr float kDt = 0.0025f;
  constexpr float kTau = 0.05f;
  EXPECT_EQ(pid.derivative(1.0f, kDt, kTau), 0.0f);
  // x from 1 to 1.5: 2/(2 tau + dt) * 0.5 = 1/0.1025
  EXPECT_FLOAT_EQ(pid.derivative(1.5f, kDt, kTau), 1.0f / 0.1025f);
  // and then x rests: times (2 tau - dt)/(2 tau + dt) = 0.0975/0.1025
  EXPECT_FLOAT_EQ(pid.derivative(1.5f, kDt, kTau), 1.0f / 0.1025f * 0.0975f / 0.1025f);
}

TEST(PidDerivative, SettlesOnTheSlopeOfARamp) {
  Pid pid = make(0.0f, 0.0f, 1.0f);
  float d = 0.0f;
  for (int k = 0; k < 400; ++k)
    d = pid.derivative(3.0f * 0.0025f * static_cast<float>(k), 0.0025f, 0.05f);
  EXPECT_NEAR(d, 3.0f, 1e-3f);  // 1 s is 20 time constants; differences of floats near 3 remain
}

TEST(PidDerivative, IgnoresStepsOfNoTime) {
  // Weak point 38: a division by dt = 0 must not happen.
  Pid pid = make(0.0f, 0.0f, 1.0f);
  static_cast<void>(pid.derivative(1.0f, 0.0025f, 0.0f));
  static_cast<void>(pid.derivative(2.0f, 0.0025f, 0.0f));
  const float d = pid.derivative(2.0f, 0.0025f, 0.05f);
  for (const float dt : {0.0f, 1e-4f}) EXPECT_EQ(pid.derivative(9.0f, dt, 0.05f), d);
  EXPECT_TRUE(std::isfinite(pid.derivative(2.0f, 0.0f, 0.0f)));
}

TEST(PidDerivative, StartsFromRestWhenItsGainIsSetLater) {
  Pid pid = make(1.0f, 0.0f, 1.0f);
  static_cast<void>(pid.derivative(0.0f, 0.0025f, 0.05f));
  pid.configure({1.0f, 0.0f, 0.0f});
  static_cast<void>(pid.derivative(4.0f, 0.0025f, 0.05f));
  pid.configure({1.0f, 0.0f, 1.0f});
  EXPECT_EQ(pid.derivative(5.0f, 0.0025f, 0.05f), 0.0f);  // not a jump from 0 to 5
}

}  // namespace
}  // namespace rosflight::core
