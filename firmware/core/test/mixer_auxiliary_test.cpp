// SPDX-License-Identifier: BSD-3-Clause
// Auxiliary commands: channels that the mixer leaves free.
#include "firmware/core/test/mixer_rig.hpp"

namespace rosflight::core {
namespace {

using namespace mixer_rig;  // NOLINT(google-build-using-namespace): the vocabulary of these tests

TEST(MixerAux, DrivesWhatTheMixerLeavesFree) {
  Mixer m = make_mixer(MixerId::kQuadX);
  for (const std::size_t k : {4u, 9u, 10u, 13u}) {
    ASSERT_TRUE(m.set_auxiliary(aux(k, link::AuxType::kServo, 0.5f)));
    EXPECT_FLOAT_EQ(m.step(wrench(-0.5f), disarmed())[k], 0.75f) << k;
    static_cast<void>(m.step(wrench(-0.5f), armed()));
    ASSERT_TRUE(m.set_auxiliary(aux(k, link::AuxType::kMotor, 0.6f)));
    EXPECT_FLOAT_EQ(m.step(wrench(-0.5f), armed())[k], 0.6f) << k;
    EXPECT_EQ(m.step(wrench(-0.5f), disarmed())[k], 0.0f) << k;
  }
}

TEST(MixerAux, DoesNotTouchMixedChannels) {
  Mixer m = make_mixer(MixerId::kQuadX);
  ASSERT_TRUE(m.set_auxiliary(aux(0, link::AuxType::kServo, 1.0f)));
  EXPECT_NEAR(m.step(wrench(-0.35f), armed())[0], 0.35f, 1e-6f);
}

TEST(MixerAux, StaysUntilTheNextCommand) {
  Mixer m = make_mixer(MixerId::kQuadX);
  ASSERT_TRUE(m.set_auxiliary(aux(6, link::AuxType::kServo, -1.0f)));
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(m.step(wrench(-0.5f), armed())[6], 0.0f);
  ASSERT_TRUE(m.set_auxiliary(aux(6, link::AuxType::kServo, 1.0f)));
  EXPECT_EQ(m.step(wrench(-0.5f), armed())[6], 1.0f);
}

TEST(MixerAux, IsLimited) {
  Mixer m = make_mixer(MixerId::kQuadX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kServo, 7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 1.0f);
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kMotor, 7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 1.0f);
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kMotor, -7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 0.1f);  // idles as every motor
}

TEST(MixerAux, MotorsIdleAsTheOthers) {
  Mixer m = make_mixer(MixerId::kQuadX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kMotor, 0.0f)));
  EXPECT_EQ(m.step({}, armed())[10], 0.1f);
  Mixer::Config config = m.config();
  config.idle_throttle = 0.2f;
  m.configure(config);
  EXPECT_EQ(m.step({}, armed())[10], 0.2f);
}

/// A motor at 0.8 on channel 10 and a servo at 0.75 on channel 11.
link::AuxCommand motor_and_servo() {
  link::AuxCommand command = aux(10, link::AuxType::kMotor, 0.8f);
  command.type[11] = static_cast<std::uint8_t>(link::AuxType::kServo);
  command.value[11] = 0.5f;
  return command;
}

TEST(MixerAux, AMotorStopsOnDisarmFailsafeOrSilenceAndWaitsForANewCommandServosHold) {
  const auto with = [](void (*change)(Mixer::Conditions&)) {
    Mixer::Conditions c = armed();
    change(c);
    return c;
  };
  for (const Mixer::Conditions& end :
       {disarmed(), with([](Mixer::Conditions& c) { c.failsafe = true; }),
        with([](Mixer::Conditions& c) { c.companion_present = false; })}) {
    Mixer m = make_mixer(MixerId::kQuadX);
    static_cast<void>(m.step({}, armed()));
    ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
    for (int k = 0; k < 1000; ++k)
      ASSERT_FLOAT_EQ(m.step({}, armed())[10], 0.8f);  // once is enough
    EXPECT_EQ(m.step({}, end)[10], 0.0f) << "in the same pass, and no idle";
    EXPECT_FLOAT_EQ(m.outputs()[11], 0.75f);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(m.step({}, armed())[10], 0.0f) << "it is forgotten";
    EXPECT_FLOAT_EQ(m.outputs()[11], 0.75f);
    ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
    EXPECT_FLOAT_EQ(m.step({}, armed())[10], 0.8f);
  }
}

TEST(MixerAux, AMotorCommandThatCameBeforeOrWhileDisarmedNeverCounts) {
  Mixer m = make_mixer(MixerId::kQuadX);
  ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
  EXPECT_TRUE(m.end_auxiliary_motors(disarmed())) << "no pass with an IMU sample is needed";
  EXPECT_EQ(m.step({}, armed())[10], 0.0f);
  EXPECT_FLOAT_EQ(m.outputs()[11], 0.75f);
  ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
  static_cast<void>(m.step({}, disarmed()));
  EXPECT_EQ(m.step({}, armed())[10], 0.0f);
  Mixer::Conditions failsafe = armed();
  failsafe.failsafe = true;
  static_cast<void>(m.step({}, failsafe));
  ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
  EXPECT_EQ(m.step({}, failsafe)[10], 0.0f) << "the companion has no effect in failsafe";
  EXPECT_EQ(m.step({}, armed())[10], 0.0f) << "nor what it sent then";
}

TEST(MixerAux, AMotorOnAServosPinStopsAtZeroNotAtTheServosCentre) {
  for (const bool drop : {false, true}) {
    Mixer m = make_mixer(MixerId::kQuadX);
    ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kServo, 1.0f)));
    static_cast<void>(m.step({}, armed()));
    ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kMotor, 0.5f)));
    if (drop) m.drop_auxiliary_motors();
    EXPECT_EQ(m.step({}, drop ? armed() : disarmed())[10], 0.0f);
  }
}

TEST(MixerAux, AMotorStopsWhileTheMixIsNonsenseToo) {
  Mixer m = make_mixer(MixerId::kQuadX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(motor_and_servo()));
  static_cast<void>(m.step({}, armed()));
  static_cast<void>(m.step(wrench(kNan), disarmed()));
  EXPECT_EQ(m.outputs()[10], 0.0f);
  EXPECT_EQ(m.step({}, armed())[10], 0.0f);
}

TEST(MixerAux, AMotorOnAChannelThatTheMixerGivesUpIsForgottenToo) {
  Mixer m = make_mixer(MixerId::kQuadX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(aux(0, link::AuxType::kMotor, 0.8f)));
  static_cast<void>(m.step({}, disarmed()));
  MixerHeader header = m.header();
  header.type[0] = OutputType::kAux;
  m.set_header(header);
  EXPECT_EQ(m.step({}, armed())[0], 0.0f);
}

TEST(MixerAux, ReleasedChannelsReturnToADefinedIdle) {
  // Weak point 48: in ROSflight 2.x they keep their last value for ever.
  Mixer m = make_mixer(MixerId::kQuadX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(aux(11, link::AuxType::kServo, 1.0f)));
  EXPECT_EQ(m.step({}, armed())[11], 1.0f);
  ASSERT_TRUE(m.set_auxiliary({}));
  EXPECT_EQ(m.step({}, armed())[11], 0.5f);  // a servo: centre
  ASSERT_TRUE(m.set_auxiliary(aux(11, link::AuxType::kMotor, 1.0f)));
  EXPECT_EQ(m.step({}, armed())[11], 1.0f);
  ASSERT_TRUE(m.set_auxiliary({}));
  EXPECT_EQ(m.step({}, armed())[11], 0.0f);  // a motor: off
  EXPECT_EQ(m.step({}, armed())[12], 0.0f);  // never used
}

TEST(MixerAux, AMixerMotorThatIsReleasedStops) {
  Mixer m = make_mixer(MixerId::kFixedWing);
  static_cast<void>(m.step({0, 0, 0, 1.0f}, armed()));
  ASSERT_EQ(m.outputs()[0], 1.0f);
  MixerHeader header = m.header();
  header.type[0] = OutputType::kMotor;  // the servo's pin now drives a motor
  m.set_header(header);
  static_cast<void>(m.step({}, armed()));
  header.type[0] = OutputType::kAux;
  m.set_header(header);
  EXPECT_EQ(m.step({}, armed())[0], 0.0f);
  header.type[1] = OutputType::kAux;
  m.set_header(header);
  EXPECT_EQ(m.step({}, armed())[1], 0.5f);
}

TEST(MixerAux, NonsenseIsRefusedWhole) {
  Mixer m = make_mixer(MixerId::kQuadX);
  ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kServo, 0.5f)));
  link::AuxCommand bad = aux(10, link::AuxType::kServo, -0.5f);
  bad.type[13] = 3;
  EXPECT_FALSE(m.set_auxiliary(bad));
  for (const float value : {kNan, kInf, -kInf}) {
    EXPECT_FALSE(m.set_auxiliary(aux(10, link::AuxType::kServo, value)));
    EXPECT_FALSE(m.set_auxiliary(aux(10, link::AuxType::kMotor, value)));
  }
  EXPECT_FLOAT_EQ(m.step({}, armed())[10], 0.75f);
  EXPECT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kDisabled, kNan)));  // nobody reads it
  EXPECT_EQ(m.step({}, armed())[10], 0.5f);
}

}  // namespace
}  // namespace rosflight::core
