// SPDX-License-Identifier: BSD-3-Clause
// What reaches the pins: limits by type, auxiliary channels, nonsense in.
#include "firmware/core/test/mixer_rig.hpp"

namespace rosflight::core {
namespace {

using namespace mixer_rig;  // NOLINT(google-build-using-namespace): the vocabulary of these tests

// ---- limits by type

TEST(MixerLimits, MotorsStandStillDisarmed) {
  Mixer m = make_mixer(MixerId::kQuadX);
  expect_near(m.step(wrench(-0.8f), Mixer::Conditions{}), {0, 0, 0, 0});
}

TEST(MixerLimits, MotorsIdleOnlyIfAskedTo) {
  for (const bool spin : {true, false}) {
    Mixer::Config config;
    config.spin_when_armed = spin;
    config.idle_throttle = 0.15f;
    Mixer m = make_mixer(MixerId::kQuadX, config);
    const float lowest = spin ? 0.15f : 0.0f;
    EXPECT_EQ(m.step(wrench(0.5f), armed())[0], lowest);
    EXPECT_NEAR(m.step(wrench(-0.05f), armed())[0], spin ? 0.15f : 0.05f, 1e-6f);
    EXPECT_NEAR(m.step(wrench(-0.2f), armed())[0], 0.2f, 1e-6f);
  }
}

TEST(MixerLimits, ServosMoveDisarmedToo) {
  Mixer::Config config;
  config.fixed_wing = true;
  Mixer m = make_mixer(MixerId::kFixedWing, config);
  const auto at = [&](float aileron) { return m.step({0, 0, 0, aileron}, Mixer::Conditions{})[0]; };
  EXPECT_FLOAT_EQ(at(0.0f), 0.5f);
  EXPECT_FLOAT_EQ(at(0.5f), 0.75f);
  EXPECT_FLOAT_EQ(at(-1.0f), 0.0f);
  EXPECT_FLOAT_EQ(at(1.0f), 1.0f);
  EXPECT_FLOAT_EQ(at(3.0f), 1.0f);
  EXPECT_FLOAT_EQ(at(-3.0f), 0.0f);
}

TEST(MixerLimits, GpioPinsAreLowOrHigh) {
  // Weak point 48: in the reference the type has no effect.
  Mixer m = custom_mixer({OutputType::kGpio});
  m.primary()(0, 6) = 1.0f;
  Inputs u{};
  for (const auto& [value, level] :
       {std::pair{0.0f, 0.0f}, {0.49f, 0.0f}, {0.5f, 1.0f}, {7.0f, 1.0f}, {-1.0f, 0.0f}}) {
    u[6] = value;
    EXPECT_EQ(m.step(u, armed())[0], level) << value;
    EXPECT_EQ(m.step(u, Mixer::Conditions{})[0], level) << value;
  }
}

// ---- auxiliary commands

link::AuxCommand aux(std::size_t channel, link::AuxType type, float value) {
  link::AuxCommand command;
  command.type[channel] = static_cast<std::uint8_t>(type);
  command.value[channel] = value;
  return command;
}

TEST(MixerAux, DrivesWhatTheMixerLeavesFree) {
  Mixer m = make_mixer(MixerId::kQuadX);
  for (const std::size_t k : {4u, 9u, 10u, 13u}) {
    ASSERT_TRUE(m.set_auxiliary(aux(k, link::AuxType::kServo, 0.5f)));
    EXPECT_FLOAT_EQ(m.step(wrench(-0.5f), Mixer::Conditions{})[k], 0.75f) << k;
    ASSERT_TRUE(m.set_auxiliary(aux(k, link::AuxType::kMotor, 0.6f)));
    EXPECT_EQ(m.step(wrench(-0.5f), Mixer::Conditions{})[k], 0.0f) << k;
    EXPECT_FLOAT_EQ(m.step(wrench(-0.5f), armed())[k], 0.6f) << k;
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
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kServo, 7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 1.0f);
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kMotor, 7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 1.0f);
  ASSERT_TRUE(m.set_auxiliary(aux(5, link::AuxType::kMotor, -7.0f)));
  EXPECT_EQ(m.step({}, armed())[5], 0.1f);  // idles as every motor
}

TEST(MixerAux, MotorsFollowArmingAndTheIdleThrottle) {
  Mixer m = make_mixer(MixerId::kQuadX);
  ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kMotor, 0.0f)));
  EXPECT_EQ(m.step({}, armed())[10], 0.1f);
  EXPECT_EQ(m.step({}, Mixer::Conditions{})[10], 0.0f);
  EXPECT_EQ(m.step({}, armed())[10], 0.1f);
  Mixer::Config config = m.config();
  config.idle_throttle = 0.2f;
  m.configure(config);
  EXPECT_EQ(m.step({}, armed())[10], 0.2f);
}

TEST(MixerAux, ReleasedChannelsReturnToADefinedIdle) {
  // Weak point 48: in the reference they keep their last value for ever.
  Mixer m = make_mixer(MixerId::kQuadX);
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

// ---- nothing to mix, nonsense to mix

TEST(MixerSafety, WithoutAMixerNothingMoves) {
  Mixer m = make_mixer(MixerId::kQuadX);
  m.set_valid(false);
  ASSERT_TRUE(m.set_auxiliary(aux(10, link::AuxType::kServo, 1.0f)));
  for (const float value : m.step(wrench(-0.5f), armed())) EXPECT_EQ(value, 0.0f);
}

TEST(MixerSafety, NotANumberAnywhereStopsAllMotorsAndHoldsTheRest) {
  for (const bool motor_model : {false, true}) {
    for (std::size_t entry = 0; entry < kEntries; ++entry) {
      for (const float bad : {kNan, kInf, -kInf}) {
        Mixer::Config config;
        config.use_motor_model = motor_model;
        Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo, OutputType::kGpio,
                                OutputType::kMotor, OutputType::kAux},
                               config);
        m.primary().topRows(4).setConstant(motor_model ? 1e5f : 0.05f);
        link::AuxCommand command = aux(10, link::AuxType::kMotor, 0.5f);
        command.type[11] = static_cast<std::uint8_t>(link::AuxType::kServo);
        command.value[11] = 0.5f;
        ASSERT_TRUE(m.set_auxiliary(command));
        Inputs u;
        u.fill(1.0f);
        static_cast<void>(m.step(u, armed()));
        const hal::OutputValues before = m.outputs();
        ASSERT_GT(before[0], 0.0f);
        u[entry] = bad;
        const auto& out = m.step(u, armed());
        SCOPED_TRACE(entry);
        EXPECT_EQ(out[0], 0.0f);
        EXPECT_EQ(out[3], 0.0f);
        EXPECT_EQ(out[10], 0.0f);
        EXPECT_EQ(out[1], before[1]);
        EXPECT_EQ(out[2], before[2]);
        EXPECT_EQ(out[11], before[11]);
        for (const float value : m.mixed()) EXPECT_EQ(value, 0.0f);
        u[entry] = 1.0f;
        EXPECT_EQ(m.step(u, armed()), before);  // and the next good pass is as if nothing had been
      }
    }
  }
}

TEST(MixerSafety, GainsThatOverflowAreNonsenseToo) {
  Mixer m = custom_mixer({OutputType::kMotor, OutputType::kMotor});
  m.primary()(0, 2) = 3e38f;
  m.primary()(1, 2) = 0.5f;
  const auto& out = m.step(wrench(10.0f), armed());
  EXPECT_EQ(out[0], 0.0f);
  EXPECT_EQ(out[1], 0.0f);
}

TEST(MixerSafety, OutputsAreAlwaysWithinZeroAndOne) {
  std::uint32_t state = 1;
  const auto random = [&](float span) {
    state = state * 1664525u + 1013904223u;
    return (static_cast<float>(state >> 8) / 8388608.0f - 1.0f) * span;
  };
  for (const bool motor_model : {false, true}) {
    Mixer::Config config;
    config.use_motor_model = motor_model;
    Mixer m = custom_mixer(
        {OutputType::kMotor, OutputType::kServo, OutputType::kGpio, OutputType::kMotor}, config);
    for (int trial = 0; trial < 2000; ++trial) {
      for (Eigen::Index c = 0; c < 4; ++c) {
        for (Eigen::Index i = 0; i < 10; ++i) m.primary()(c, i) = random(motor_model ? 1e5f : 3.0f);
      }
      Inputs u;
      for (float& v : u) v = random(5.0f);
      for (const float value : m.step(u, armed())) {
        ASSERT_GE(value, 0.0f);
        ASSERT_LE(value, 1.0f);
      }
    }
  }
}

TEST(MixerSafety, StopMotorsHoldsServos) {
  Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo});
  m.primary()(0, 2) = -1.0f;
  m.primary()(1, 2) = -1.0f;
  static_cast<void>(m.step(wrench(-0.6f), armed()));
  m.stop_motors();
  EXPECT_EQ(m.outputs()[0], 0.0f);
  EXPECT_FLOAT_EQ(m.outputs()[1], 0.8f);
}

}  // namespace
}  // namespace rosflight::core
