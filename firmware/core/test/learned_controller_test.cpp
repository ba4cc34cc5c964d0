// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/learned_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rosflight::core {
namespace {

using End = LearnedController::End;

constexpr float kDt = 0.0025f;
constexpr std::array<float, 3> kMaxRates{3.0f, 2.0f, 1.5f};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Outputs are the commands.
Policy::Outputs follow(Policy::States& /*states*/, const Policy::Inputs& x) {
  return {x[6], x[7], x[8]};
}
constexpr Policy kFollow{"follow", 0.0f, follow};

CommandVector angles(float roll, float pitch, float yaw_rate) {
  CommandVector c;
  c.value = {0.0f, 0.0f, 0.6f, roll, pitch, yaw_rate};
  return c;
}

AttitudeEstimate attitude(float roll, float pitch, float yaw = 0.0f,
                          const Vector3& rates = Vector3::Zero()) {
  AttitudeEstimate s;
  s.q_WB = quaternion_from_euler(roll, pitch, yaw);
  s.rates_rad_s = rates;
  return s;
}

LearnedController make(const Policy& policy) {
  LearnedController c{&policy};
  c.configure(kMaxRates, 2);
  return c;
}

/// Steps; whether the policy flew.
bool flies(LearnedController& c, const CommandVector& given, const AttitudeEstimate& state,
           bool may_fly = true) {
  c.step(given, state, kDt, may_fly);
  return c.flying();
}

TEST(LearnedController, OutputsAreSharesOfTheLargestRates) {
  LearnedController c = make(kFollow);
  const CommandVector given = angles(0.5f, -0.25f, 1.0f);
  EXPECT_TRUE(flies(c, given, attitude(0, 0)));
  const CommandVector& out = c.commanded();
  EXPECT_EQ(out.value, (std::array<float, kAxes>{0.0f, 0.0f, 0.6f, 1.5f, -0.5f, 1.5f}));
  for (std::size_t k = 0; k < kAxes; ++k) {
    EXPECT_EQ(out.type[k], k >= 3 && k < 6 ? CommandType::kRate : given.type[k]) << k;
  }
}

/// Gravity in the body of a vehicle with roll f and pitch t: (-sin t, sin f cos t, cos f cos t) at any heading.
TEST(LearnedController, InputsAreGravityRatesCommandsAndTheLastOutputs) {
  static Policy::Inputs seen;
  constexpr Policy kSee{"see", 0.0f, [](Policy::States&, const Policy::Inputs& x) {
                          seen = x;
                          return Policy::Outputs{x[9] + 0.125f, x[10] - 0.25f, 0.5f};
                        }};
  LearnedController c = make(kSee);
  const AttitudeEstimate state = attitude(0.3f, -0.7f, 2.0f, {0.1f, 0.2f, 0.3f});
  c.step(angles(0.4f, 0.5f, 0.6f), state, kDt, true);
  const std::array<double, 12> expected{std::sin(0.7),
                                        std::sin(0.3) * std::cos(0.7),
                                        std::cos(0.3) * std::cos(0.7),
                                        0.1,
                                        0.2,
                                        0.3,
                                        0.4,
                                        0.5,
                                        0.6,
                                        0.0,
                                        0.0,
                                        0.0};
  for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(double{seen[k]}, expected[k], 1e-6) << k;
  c.step(angles(0.4f, 0.5f, 0.6f), state, kDt, true);
  EXPECT_EQ(seen[9], 0.125f);
  EXPECT_EQ(seen[10], -0.25f);
  EXPECT_EQ(seen[11], 0.5f);
}

/// Two inputs and the throttle come back, as motors.
TEST(LearnedController, APolicyOfMotorsGetsTheThrottleAndFourOutputs) {
  static Policy::Inputs seen;
  constexpr Policy kMotors{"motors", 0.0f,
                           [](Policy::States&, const Policy::Inputs& x) {
                             seen = x;
                             return Policy::Outputs{-1.0f, x[6], x[13], 1.0f};
                           },
                           Policy::Kind::kMotorOutputs};
  LearnedController c = make(kMotors);
  CommandVector given = angles(0.5f, 0.25f, 1.0f);
  EXPECT_TRUE(flies(c, given, attitude(0, 0)));
  EXPECT_TRUE(c.of_motors());
  EXPECT_EQ(c.motors(), (std::array<float, 4>{0.0f, 0.75f, 0.8f, 1.0f}));
  EXPECT_EQ(seen[13], 0.6f);
  EXPECT_TRUE(flies(c, given, attitude(0, 0)));
  EXPECT_EQ(seen[9], -1.0f);
  EXPECT_EQ(seen[12], 1.0f) << "its last output";
  given.value[2] = 1.01f;
  EXPECT_FALSE(flies(c, given, attitude(0, 0)));
  EXPECT_EQ(c.end(), End::kOutput);
  EXPECT_EQ(c.bad_output(), 1.01f);
  c.reset();
  given.value[2] = 0.5f;
  given.type[2] = CommandType::kPassThrough;
  EXPECT_FALSE(flies(c, given, attitude(0, 0))) << "a force";
  EXPECT_EQ(c.end(), End::kNone);
}

/// The first state counts inferences since the network was at rest.
Policy::Outputs count(Policy::States& states, const Policy::Inputs& /*x*/) {
  states[0] += 1.0f;
  return {states[0] / 1024.0f, 0.0f, 0.0f};
}

TEST(LearnedController, InfersOncePerPeriodAndHoldsTheOutputs) {
  for (const auto& [period_s, steps] : {std::pair{0.0f, 1}, {0.0025f, 1}, {0.01f, 4}, {0.02f, 8}}) {
    const Policy policy{"count", period_s, count};
    LearnedController c = make(policy);
    for (int k = 0; k < 400; ++k) {
      ASSERT_TRUE(flies(c, angles(0, 0, 0), attitude(0, 0)));
      ASSERT_EQ(c.commanded().value[3], static_cast<float>(1 + k / steps) / 1024.0f * kMaxRates[0])
          << period_s;
    }
  }
}

TEST(LearnedController, StartsFromRestAfterAPause) {
  constexpr Policy kCount{"count", 0.0f, count};
  LearnedController c = make(kCount);
  const auto fly = [&c](bool may_fly) {
    return flies(c, angles(0, 0, 0), attitude(0, 0), may_fly) ? c.commanded().value[3] : 0.0f;
  };
  const float first = fly(true);
  EXPECT_GT(fly(true), first);
  EXPECT_EQ(fly(false), 0.0f);
  EXPECT_EQ(fly(true), first);
  EXPECT_EQ(c.end(), End::kNone);
}

TEST(LearnedController, LeavesOtherCommandsAlone) {
  LearnedController c = make(kFollow);
  for (std::size_t axis = 3; axis < 6; ++axis) {
    CommandVector given = angles(0.1f, 0.2f, 0.3f);
    given.type[axis] = axis == 5 ? CommandType::kPassThrough : CommandType::kRate;
    EXPECT_FALSE(flies(c, given, attitude(0, 0))) << axis;
  }
  const CommandVector given = angles(5.0f, kNan, 0.3f);
  EXPECT_FALSE(flies(c, given, attitude(3, 0), false)) << "it must not fly";
  EXPECT_EQ(c.end(), End::kNone) << "it did not fly, so nothing was missed";
}

TEST(LearnedController, AnOutputThatIsNoNumberInRangeEndsItInTheSameStep) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {1.0001f, -1.0001f, 3e38f, kInf, -kInf, kNan}) {
    for (std::size_t axis = 3; axis < 6; ++axis) {
      LearnedController c = make(kFollow);
      EXPECT_TRUE(flies(c, angles(1.0f, -1.0f, 1.0f), attitude(0, 0)));
      CommandVector given = angles(0, 0, 0);
      given.value[axis] = bad;
      EXPECT_FALSE(flies(c, given, attitude(0, 0))) << bad;
      EXPECT_EQ(c.end(), End::kOutput);
      EXPECT_TRUE(c.bad_output() == bad || std::isnan(bad));
      const CommandVector good = angles(0.1f, 0.1f, 0.1f);
      for (int k = 0; k < 1000; ++k) {
        ASSERT_FALSE(flies(c, good, attitude(0, 0), k % 3 != 0)) << "until reset()";
      }
      c.reset();
      EXPECT_TRUE(flies(c, good, attitude(0, 0)));
    }
  }
}

TEST(LearnedController, ATiltBeyondNinetyDegreesEndsItInTheSameStep) {
  constexpr float kDegree = kPi / 180.0f;
  const CommandVector given = angles(0.1f, 0.1f, 0.1f);
  for (const auto& [roll_deg, pitch_deg] :
       {std::pair{91.0f, 0.0f}, {-91.0f, 0.0f}, {180.0f, 0.0f}, {179.0f, 89.0f}}) {
    LearnedController c = make(kFollow);
    EXPECT_TRUE(flies(c, given, attitude(std::copysign(89.0f, roll_deg) * kDegree, 0)));
    const AttitudeEstimate over = attitude(roll_deg * kDegree, pitch_deg * kDegree, 1.0f);
    EXPECT_FALSE(flies(c, given, over)) << roll_deg;
    EXPECT_EQ(c.end(), End::kTilt);
    EXPECT_FALSE(flies(c, given, attitude(0, 0))) << "until reset()";
    c.reset();
    EXPECT_TRUE(flies(c, given, attitude(0, 0)));
  }
  LearnedController c = make(kFollow);
  AttitudeEstimate unknown = attitude(0, 0);
  unknown.q_WB.x = kNan;
  EXPECT_FALSE(flies(c, given, unknown));
  EXPECT_EQ(c.end(), End::kTilt);
}

/// Against a model of one line: it flies if it may, angles are commanded, nothing has ended it since the last reset, the
/// vehicle is not over and the outputs, here the commands, are in range.
TEST(LearnedController, RandomSequencesFollowTheRule) {
  std::mt19937 random{1};
  std::uniform_real_distribution<float> share{0.0f, 1.0f};
  LearnedController c = make(kFollow);
  bool ended = false;
  int flown = 0;
  int endings = 0;
  for (int k = 0; k < 50'000; ++k) {
    if (share(random) < 0.02f) {
      c.reset();
      ended = false;
    }
    const bool may_fly = share(random) < 0.9f;
    CommandVector given = angles(1.01f * (2.0f * share(random) - 1.0f), share(random), 0.0f);
    if (share(random) < 0.01f) given.value[4] = kNan;
    if (share(random) < 0.1f) given.type[4] = CommandType::kRate;
    const float roll = share(random) < 0.99f ? 1.5f * share(random) : 3.0f;
    const bool called = may_fly && given.type[4] == CommandType::kAngle && !ended;
    const bool fine = roll < 1.57f && std::abs(given.value[3]) <= 1.0f && given.value[4] <= 1.0f;
    ended = ended || (called && !fine);
    ASSERT_EQ(flies(c, given, attitude(roll, 0), may_fly), called && fine) << k;
    ASSERT_EQ(c.end() != End::kNone, ended) << k;
    if (c.flying()) {
      ASSERT_EQ(c.commanded().value[3], given.value[3] * kMaxRates[0]) << k;
      ++flown;
    } else {
      endings += called ? 1 : 0;
    }
  }
  EXPECT_GT(flown, 2000);
  EXPECT_GT(endings, 200);
}

}  // namespace
}  // namespace rosflight::core
