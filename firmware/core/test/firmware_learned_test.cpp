// SPDX-License-Identifier: BSD-3-Clause
// The firmware of a build with a policy. The policy of this test stands for that of the build: it commands rates in
// proportion to the commanded angles, so that beyond half a radian its output is out of range.
#include <random>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kGain = 2.0f;
constexpr float kMaxRate = 3.14159f;  // RC_MAX_ROLLRATE
constexpr float kMaxRoll = 0.786f;    // RC_MAX_ROLL

Policy::Outputs proportional(Policy::States& /*states*/, const Policy::Inputs& x) {
  return {kGain * x[6], kGain * x[7], 0.5f * x[8]};
}
constexpr Policy kProportional{"proportional.onnx", 0.0f, proportional};

const std::string kBadOutput = "Learned control off until disarm: output ";
const std::string kTilt = "Learned control off until disarm: tilt > 90 deg";

}  // namespace

const Policy* built_in_policy() {
  return &kProportional;
}

namespace {

class FirmwareLearned : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
  }
  void fly() {
    start();
    take_off();
    rig_.inbox.clear();
  }
  void take_off() {
    rig_.arm();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(100);
  }
  /// @param stick  -1..1.
  void roll(float stick) { rig_.rc.channels[FirmwareRig::kRoll] = 0.5f + 0.5f * stick; }
  const LearnedController& learned() const { return rig_.firmware().learned(); }
  float roll_torque() const { return rig_.firmware().controller().output()[3]; }
  /// The torque by the rate loop, PID_ROLL_RATE_P alone, behind the policy.
  static float by_policy(float stick) { return 0.07f * kGain * kMaxRoll * stick * kMaxRate; }
  /// The torque by the angle loop with PID_ROLL_ANG_P, at rest and level.
  static float by_angle_loop(float stick) { return 0.15f * kMaxRoll * stick; }

  FirmwareRig rig_;
};

constexpr float kAlmost = 1e-3f;

TEST_F(FirmwareLearned, NamesItsPolicyAtTheStart) {
  start();
  rig_.run_for(200);
  EXPECT_TRUE(rig_.said("Learned controller: proportional.onnx"));
}

TEST_F(FirmwareLearned, FliesAnglesArmedOnly) {
  start();
  rig_.run_for(200);
  EXPECT_FALSE(learned().flying());
  take_off();
  EXPECT_TRUE(learned().flying());
  roll(0.3f);
  rig_.run_for(100);
  EXPECT_NEAR(roll_torque(), by_policy(0.3f), kAlmost);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareLearned, AnOutputOutOfRangeGivesTheSamePassToTheAngleLoops) {
  fly();
  roll(0.3f);
  rig_.run_for(100);
  roll(0.9f);
  while (learned().flying()) rig_.pass();
  EXPECT_NEAR(roll_torque(), by_angle_loop(0.9f), kAlmost) << "in the pass that ended it";
  rig_.run_for(500);
  EXPECT_EQ(rig_.count_text(kBadOutput + "1.41"), 1u) << "2 x 0.9 x 0.786";
  roll(0.3f);
  rig_.run_for(2000);
  EXPECT_FALSE(learned().flying()) << "latched";
  EXPECT_NEAR(roll_torque(), by_angle_loop(0.3f), kAlmost);
  EXPECT_TRUE(rig_.armed());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_GT(rig_.outputs()[k], 0.2f) << k << ": flies on";
}

TEST_F(FirmwareLearned, ADisarmingEndsTheLatch) {
  fly();
  roll(0.9f);
  rig_.run_for(200);
  ASSERT_EQ(learned().end(), LearnedController::End::kOutput);
  roll(0.0f);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig_.rc.channels[FirmwareRig::kYaw] = 0.0f;
  ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 2000), 0);
  EXPECT_EQ(learned().end(), LearnedController::End::kNone);
  rig_.release();
  rig_.run_for(3000);
  take_off();
  EXPECT_TRUE(learned().flying());
}

TEST_F(FirmwareLearned, ATiltBeyondNinetyDegreesEndsIt) {
  fly();
  rig_.gyro_rad_s[0] = 3.0f;
  ASSERT_GE(rig_.ms_until([this] { return !learned().flying(); }, 1500), 400);
  const Quaternion& q = rig_.firmware().estimator().estimate().q_WB;
  EXPECT_NEAR(roll_of(q), kPi / 2, 0.01f);
  rig_.gyro_rad_s[0] = 1e-6f;
  rig_.run_for(500);
  EXPECT_EQ(rig_.count_text(kTilt), 1u);
  EXPECT_EQ(learned().end(), LearnedController::End::kTilt);
}

TEST_F(FirmwareLearned, TheFailsafeIsFlownByTheAngleLoops) {
  fly();
  roll(0.3f);
  rig_.run_for(100);
  rig_.rc.failsafe = true;
  rig_.run_for(60);
  EXPECT_FALSE(learned().flying());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(rig_.outputs()[k], 0.28f, 1e-3f) << k;
  rig_.rc.failsafe = false;
  rig_.run_for(60);
  EXPECT_TRUE(learned().flying()) << "nothing was missed";
  EXPECT_EQ(rig_.count_text(kTilt), 0u);
}

/// Sticks, attitude and radio at random, from one arming to the next disarming: what holds in every pass.
TEST_F(FirmwareLearned, RandomFlightsKeepTheRules) {
  start();
  std::mt19937 random{7};
  std::uniform_real_distribution<float> share{-1.0f, 1.0f};
  int flown = 0;
  std::size_t endings = 0;
  for (int flight = 0; flight < 40; ++flight) {
    rig_.run_for(15'000);  // the attitude settles
    rig_.hold_arming_corner();
    ASSERT_GE(rig_.ms_until([this] { return rig_.armed(); }, 5000), 0) << flight;
    rig_.release();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    bool ended = false;
    for (int k = 0; k < 1200; ++k) {
      if (k % 80 == 0) {
        roll(std::pow(share(random), 3.0f));
        rig_.rc.failsafe = share(random) > 0.9f;
        rig_.gyro_rad_s[0] = share(random) > 0.8f ? 4.0f * share(random) : 1e-6f;
      }
      rig_.pass();
      const bool has_ended = learned().end() != LearnedController::End::kNone;
      ASSERT_TRUE(has_ended || !ended || !rig_.armed()) << "latched while armed";
      if (has_ended && !ended) ++endings;
      ended = has_ended;
      if (learned().flying()) {
        ++flown;
        const Quaternion& q = rig_.firmware().estimator().estimate().q_WB;
        ASSERT_TRUE(!has_ended && rig_.armed() && rotation_matrix(q)(2, 2) >= 0.0f) << k;
      }
      for (const float value : rig_.outputs()) ASSERT_TRUE(value >= 0.0f && value <= 1.0f) << k;
    }
    roll(0.0f);
    rig_.rc.failsafe = false;
    rig_.gyro_rad_s[0] = 1e-6f;
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
    rig_.rc.channels[FirmwareRig::kYaw] = 0.0f;
    ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 5000), 0) << flight;
    ASSERT_EQ(learned().end(), LearnedController::End::kNone);
    rig_.release();
  }
  std::size_t reported = 0;
  for (const std::string& text : rig_.texts()) {
    reported += text.rfind("Learned control off", 0) == 0 ? 1u : 0u;
  }
  EXPECT_EQ(reported, endings);
  EXPECT_GT(endings, 10u);
  EXPECT_GT(flown, 5000);
}

}  // namespace
}  // namespace rosflight::core
