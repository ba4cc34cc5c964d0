// SPDX-License-Identifier: BSD-3-Clause
// What reaches the pins: limits by type, the motor test, nonsense in.
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

TEST(MixerLimits, CommandsOfMotorsHaveTheLimitsOfTheMixer) {
  Mixer::Config config;
  config.idle_throttle = 0.15f;
  Mixer m = make_mixer(MixerId::kQuadX, config);
  EXPECT_EQ(m.motor_count(), 4u);
  const Mixer::MotorCommands commands{0.0f, 0.3f, 0.999f, 1.5f};
  expect_near(m.step_motors(commands, disarmed()), {0, 0, 0, 0});
  expect_near(m.step_motors(commands, armed()), {0.15f, 0.3f, 0.999f, 1.0f});
  Mixer::Conditions held = armed();
  held.hold_idle = true;
  expect_near(m.step_motors(commands, held), {0.15f, 0.15f, 0.15f, 0.15f});
  EXPECT_TRUE(m.saturated());
  expect_near(m.step_motors(commands, armed()), {0.15f, 0.3f, 0.999f, 1.0f});
  EXPECT_FALSE(m.saturated());
  expect_near(m.step_motors({0.5f, 0.5f, std::nanf(""), 0.5f}, armed()), {0, 0, 0, 0});
  expect_near(m.step(wrench(-0.5f), armed()), {0.5f, 0.5f, 0.5f, 0.5f});
}

TEST(MixerLimits, CommandsOfMotorsFindThemAmongOtherChannels) {
  Mixer m = custom_mixer({OutputType::kServo, OutputType::kMotor, OutputType::kAux,
                          OutputType::kMotor, OutputType::kMotor, OutputType::kMotor});
  ASSERT_TRUE(m.set_auxiliary(aux(2, link::AuxType::kServo, 1.0f)));
  expect_near(m.step_motors({0.2f, 0.3f, 0.4f, 0.5f}, armed()),
              {0.5f, 0.2f, 1.0f, 0.3f, 0.4f, 0.5f, 0.0f});
  m.set_valid(false);
  m.clear_outputs();
  EXPECT_EQ(m.step_motors({0.2f, 0.3f, 0.4f, 0.5f}, armed())[1], 0.0f);
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
  // Weak point 48: in ROSflight 2.x the type has no effect.
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

TEST(MixerLimits, AnAuxiliaryServoCommandSwitchesAGpioPinInPlaceOfTheMixer) {
  Mixer m = custom_mixer({OutputType::kGpio, OutputType::kServo});
  m.primary()(0, 6) = 1.0f;
  Inputs u{};
  u[6] = 1.0f;
  EXPECT_EQ(m.step(u, armed())[0], 1.0f) << "no command";
  for (const auto& [value, level] :
       {std::pair{0.0f, 0.0f}, {0.49f, 0.0f}, {0.5f, 1.0f}, {1.0f, 1.0f}, {-1.0f, 0.0f}}) {
    ASSERT_TRUE(m.set_auxiliary(aux(0, link::AuxType::kServo, value)));
    EXPECT_EQ(m.step(u, armed())[0], level) << value;
    EXPECT_EQ(m.step(u, Mixer::Conditions{})[0], level) << value;
  }
  ASSERT_TRUE(m.set_auxiliary(aux(0, link::AuxType::kMotor, 0.0f)));
  EXPECT_EQ(m.step(u, armed())[0], 1.0f) << "the pin drives no motor: the mixer has it";
  ASSERT_TRUE(m.set_auxiliary(aux(1, link::AuxType::kServo, 1.0f)));
  EXPECT_EQ(m.step(u, armed())[0], 1.0f);
  EXPECT_EQ(m.outputs()[1], 0.5f) << "a servo of the mixer takes no command";
}

TEST(MixerLimits, JustAfterArmingNoMotorIsAboveIdle) {
  for (const bool spin : {true, false}) {
    Mixer::Config config;
    config.spin_when_armed = spin;
    Mixer m = make_mixer(MixerId::kQuadX, config);
    static_cast<void>(m.step({}, armed()));
    link::AuxCommand command;
    command.type[10] = static_cast<std::uint8_t>(link::AuxType::kMotor);
    command.value[10] = 0.9f;
    command.type[11] = static_cast<std::uint8_t>(link::AuxType::kServo);
    command.value[11] = 0.5f;
    ASSERT_TRUE(m.set_auxiliary(command));
    Mixer::Conditions held = armed();
    held.hold_idle = true;
    for (const float throttle : {0.0f, 0.05f, 0.63f, 9.0f}) {
      const auto& out = m.step(wrench(-throttle, 0.3f, 0.3f, 0.3f), held);
      for (const std::size_t k : {0u, 1u, 2u, 3u, 10u}) {
        EXPECT_LE(out[k], 0.1f) << k;
        EXPECT_GE(out[k], spin ? 0.1f : 0.0f) << k;
      }
      EXPECT_FLOAT_EQ(out[11], 0.75f) << "servos move";
      EXPECT_TRUE(m.saturated()) << "integrals know that the motors do not follow";
    }
    EXPECT_NEAR(m.step(wrench(-0.63f), armed())[0], 0.63f, 1e-6f) << "and then at once";
    EXPECT_EQ(m.outputs()[10], 0.9f);
    EXPECT_FALSE(m.saturated());
    held.armed = false;
    EXPECT_EQ(m.step(wrench(-0.63f), held)[0], 0.0f) << "disarmed is zero";
  }
}

// ---- motor test

Mixer::Conditions testing(int motor, float value) {
  Mixer::Conditions c = disarmed();
  c.test_motor = static_cast<std::int8_t>(motor);
  c.test_value = value;
  return c;
}

TEST(MixerMotorTest, TurnsOneMotorOfTheMixerAndNothingElse) {
  Mixer m = make_mixer(MixerId::kHexX);
  static_cast<void>(m.step({}, armed()));
  ASSERT_TRUE(m.set_auxiliary(aux(9, link::AuxType::kMotor, 0.6f)));
  for (int motor = 0; motor < 6; ++motor) {
    const auto& out = m.step(wrench(-0.8f, 0.1f), testing(motor, 0.2f));
    for (int k = 0; k < static_cast<int>(hal::kOutputs); ++k) {
      EXPECT_EQ(out[static_cast<std::size_t>(k)], k == motor ? 0.2f : 0.0f) << motor << " " << k;
    }
  }
  for (const float value : m.step(wrench(-0.8f), disarmed())) EXPECT_EQ(value, 0.0f);
}

TEST(MixerMotorTest, IsLimitedAndIgnoresWhatIsNoMotor) {
  Mixer m = make_mixer(MixerId::kFixedWing);  // servos 0, 1, 2, motor 4
  EXPECT_TRUE(m.is_motor(4));
  EXPECT_EQ(m.step({}, testing(4, 0.9f))[4], Mixer::kTestLimit);
  EXPECT_EQ(m.step({}, testing(4, kInf))[4], Mixer::kTestLimit);
  for (const float value : {0.0f, -0.2f, -kInf, kNan}) {
    EXPECT_EQ(m.step({}, testing(4, value))[4], 0.0f) << value;
  }
  const hal::OutputValues rest = m.step({}, disarmed());
  for (const int motor : {-128, -1, 0, 3, 5, 9, 10, 13, 14, 127}) {
    EXPECT_FALSE(motor >= 0 && m.is_motor(static_cast<std::size_t>(motor))) << motor;
    EXPECT_EQ(m.step({}, testing(motor, 0.2f)), rest) << motor;
  }
}

TEST(MixerMotorTest, HasNoEffectWhileArmedNorWithoutAMixer) {
  Mixer m = make_mixer(MixerId::kQuadX);
  Mixer::Conditions c = testing(1, 0.3f);
  c.armed = true;
  EXPECT_EQ(m.step({}, c)[1], 0.1f);
  m.set_valid(false);
  m.clear_outputs();
  for (const float value : m.step({}, testing(1, 0.3f))) EXPECT_EQ(value, 0.0f);
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
    for (std::size_t entry = 0; entry < kAxes; ++entry) {
      for (const float bad : {kNan, kInf, -kInf}) {
        Mixer::Config config;
        config.use_motor_model = motor_model;
        Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo, OutputType::kGpio,
                                OutputType::kMotor, OutputType::kAux},
                               config);
        m.primary().topRows(4).setConstant(motor_model ? 1e5f : 0.05f);
        static_cast<void>(m.step({}, armed()));
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

TEST(MixerSafety, AServoWithoutACommandIsAtItsCentre) {
  Mixer m = make_mixer(MixerId::kFixedWing);
  const auto expect_rest = [&m](const char* when) {
    for (const std::size_t k : {0u, 1u, 2u}) EXPECT_EQ(m.outputs()[k], 0.5f) << when << " " << k;
    EXPECT_EQ(m.outputs()[4], 0.0f) << when;
  };
  expect_rest("before the first pass");
  static_cast<void>(m.step({kNan, kNan, kNan, kNan, kNan, kNan}, armed()));
  expect_rest("nonsense in the first pass");
  static_cast<void>(m.step({1, 0, 0, 1, 1, 1}, armed()));
  ASSERT_EQ(m.outputs()[0], 1.0f);
  m.clear_outputs();
  expect_rest("cleared");
  static_cast<void>(m.step({1, 0, 0, 1, 1, 1}, armed()));
  m.set_header(frame_header(MixerId::kQuadX));
  m.set_valid(false);
  m.clear_outputs();
  EXPECT_EQ(m.outputs(), hal::OutputValues{}) << "motors now";
  m.set_header(frame_header(MixerId::kFixedWing));
  expect_rest("chosen again");
  static_cast<void>(m.step({1, 0, 0, 1, 1, 1}, armed()));
  EXPECT_EQ(m.outputs(), (hal::OutputValues{0.5f, 0.5f, 0.5f})) << "no mixer";
  MixerHeader none;
  m.set_header(none);
  m.clear_outputs();
  EXPECT_EQ(m.outputs(), (hal::OutputValues{0.5f, 0.5f, 0.5f})) << "released: servos hang there";
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
