// SPDX-License-Identifier: BSD-3-Clause
// How forces and torques become actuator commands.
#include "firmware/core/test/mixer_rig.hpp"

namespace rosflight::core {
namespace {

using namespace mixer_rig;  // NOLINT(google-build-using-namespace): the vocabulary of these tests

// ---- multirotor

TEST(Mixer, QuadXSharesTorquesAsTheReference) {
  // Reference run: forces and torques of the controller, and what the motors got. 1e-5: noise of
  // the pseudo-inverse.
  Mixer m = make_mixer(MixerId::kQuadX);
  expect_near(m.step(wrench(-0.35f), armed()), {0.35f, 0.35f, 0.35f, 0.35f});
  expect_near(m.step(wrench(-0.35f, 0.05895f), armed()),
              {0.329158f, 0.329158f, 0.370842f, 0.370842f});
  expect_near(m.step(wrench(-0.35f, 0, 0.05895f), armed()),
              {0.370842f, 0.329158f, 0.329158f, 0.370842f});
  expect_near(m.step(wrench(-0.35f, 0, 0, 0.188375f), armed()),
              {0.397094f, 0.302906f, 0.397094f, 0.302906f});
  expect_near(m.step(wrench(-0.70f, 0.1179f, 0, 0.37675f), armed()),
              {0.752503f, 0.564128f, 0.835872f, 0.647497f});
  expect_near(m.step(wrench(-0.035f), armed()), {0.1f, 0.1f, 0.1f, 0.1f});
  expect_near(m.step(wrench(-0.035f, 0, 0, 0.22605f), armed()), {0.1f, 0.1f, 0.1f, 0.1f});
}

TEST(Mixer, DropsYawBelowTheIdleThrottleWhateverItsSign) {
  Mixer::Config config;
  config.spin_when_armed = false;
  Mixer m = make_mixer(MixerId::kQuadX, config);
  expect_near(m.step(wrench(-0.0999f, 0, 0, 1.0f), armed()), {0.0999f, 0.0999f, 0.0999f, 0.0999f});
  expect_near(m.step(wrench(0.0999f, 0, 0, 1.0f), armed()), {0, 0, 0, 0});
  expect_near(m.step(wrench(-0.1001f, 0, 0, 1.0f), armed()), {0.3501f, 0, 0.3501f, 0});
}

TEST(Mixer, LooksAtTheThrottleEntryForIdle) {
  Mixer::Config config;
  config.throttle_axis = 0;
  Mixer m = make_mixer(MixerId::kQuadX, config);
  Inputs u = wrench(-0.5f, 0, 0, 0.2f);
  expect_near(m.step(u, armed()), {0.5f, 0.5f, 0.5f, 0.5f});  // F_x is 0: yaw dropped
  u[0] = 0.2f;
  expect_near(m.step(u, armed()), {0.55f, 0.45f, 0.55f, 0.45f});
}

TEST(Mixer, ComparesIdleInNewtonsWithMotorParameters) {
  // Weak point 52: ROSflight 2.x compares newtons with a fraction.
  Mixer::Config config;
  config.use_motor_model = true;
  config.max_thrust_N = 100.0f;
  Mixer m = custom_mixer({OutputType::kMotor}, config);
  m.primary()(0, 5) = 1e5f;  // yaw alone turns the motor
  static_cast<void>(m.step(wrench(-9.9f, 0, 0, 1.0f), armed()));
  EXPECT_NEAR(m.mixed()[0], 0.063f / 24.0f, 1e-6f);
  static_cast<void>(m.step(wrench(-10.1f, 0, 0, 1.0f), armed()));
  EXPECT_GT(m.mixed()[0], 0.1f);
}

TEST(Mixer, ScalesAllMotorsByTheLargest) {
  Mixer m = make_mixer(MixerId::kQuadX);
  // Before: 0.9 -+ 0.353557 * 0.5 = 0.723222, 1.076779
  const auto& out = m.step(wrench(-0.9f, 0.5f), armed());
  EXPECT_NEAR(m.saturation(), 1.076779f, 1e-5f);
  expect_near(out, {0.723222f / 1.076779f, 0.723222f / 1.076779f, 1.0f, 1.0f});
}

TEST(Mixer, CountsNegativeValuesWhenScaling) {
  Mixer m = make_mixer(MixerId::kQuadX);
  // -0.1 + 0.353557 * 3 = 0.960671, -1.160671: the negative one is the largest
  static_cast<void>(m.step(wrench(0.1f, 3.0f), armed()));
  EXPECT_NEAR(m.saturation(), 1.160671f, 1e-5f);
  EXPECT_NEAR(m.mixed()[2], 0.960671f / 1.160671f, 1e-5f);
  EXPECT_NEAR(m.mixed()[0], -1.0f, 1e-6f);
  EXPECT_EQ(m.outputs()[0], 0.1f);
}

TEST(Mixer, NeitherScalesNorCountsServos) {
  Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo});
  m.primary()(0, 2) = -1.0f;
  m.primary()(1, 2) = -3.0f;
  static_cast<void>(m.step(wrench(-0.5f), armed()));
  EXPECT_EQ(m.saturation(), 0.5f);
  EXPECT_EQ(m.mixed()[1], 1.5f);
  static_cast<void>(m.step(wrench(-2.0f), armed()));
  EXPECT_EQ(m.mixed()[0], 1.0f);
  EXPECT_EQ(m.mixed()[1], 6.0f);
  EXPECT_EQ(m.outputs()[1], 1.0f);
}

// ---- fixed wing

TEST(MixerFixedWing, SurfacesAndThrottleAreOnTheirChannels) {
  Mixer::Config config;
  config.fixed_wing = true;
  config.throttle_axis = 0;
  Mixer m = make_mixer(MixerId::kFixedWing, config);
  const auto& out = m.step({0.6f, 0, 0, 0.2f, -0.4f, 0.8f}, armed());
  expect_near(out, {0.6f, 0.3f, 0.9f, 0.0f, 0.6f, 0.0f});
}

TEST(MixerFixedWing, ReversesEachSurfaceByItself) {
  for (int reversed = 0; reversed < 8; ++reversed) {
    Mixer::Config config;
    config.fixed_wing = true;
    config.reverse_aileron = (reversed & 1) != 0;
    config.reverse_elevator = (reversed & 2) != 0;
    config.reverse_rudder = (reversed & 4) != 0;
    Mixer m = make_mixer(MixerId::kFixedWing, config);
    const auto& out = m.step({0, 0, 0, 0.2f, 0.4f, 0.6f}, armed());
    EXPECT_NEAR(out[0], config.reverse_aileron ? 0.4f : 0.6f, 1e-6f);
    EXPECT_NEAR(out[1], config.reverse_elevator ? 0.3f : 0.7f, 1e-6f);
    EXPECT_NEAR(out[2], config.reverse_rudder ? 0.2f : 0.8f, 1e-6f);
  }
}

TEST(MixerFixedWing, InvertedVTailMixesElevatorAndRudder) {
  Mixer::Config config;
  config.fixed_wing = true;
  Mixer m = make_mixer(MixerId::kInvertedVTail, config);
  // left = -e/2 + r/2, right = e/2 + r/2
  expect_near(m.step({0, 0, 0, 0, 0.4f, 0.2f}, armed()), {0.5f, 0.45f, 0.65f});
}

TEST(MixerFixedWing, HasNoIdleYawRuleNoScalingNoMotorModel) {
  Mixer::Config config;
  config.fixed_wing = true;
  config.throttle_axis = 0;
  config.use_motor_model = true;
  Mixer m = make_mixer(MixerId::kFixedWing, config);
  const auto& out = m.step({1.6f, 0, 0, 0, 0, 0.5f}, armed());
  EXPECT_EQ(out[4], 1.0f);
  EXPECT_EQ(m.mixed()[4], 1.6f);
  EXPECT_FLOAT_EQ(m.step({0, 0, 0, 0, 0, 0.5f}, armed())[2], 0.75f);
  EXPECT_FALSE(m.motor_model_failed());
}

// ---- motor model

Mixer motor_mixer() {
  Mixer::Config config;
  config.use_motor_model = true;
  config.spin_when_armed = false;
  config.max_thrust_N = 0.0f;
  Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo, OutputType::kMotor}, config);
  m.primary()(0, 2) = 1.0f;
  m.primary()(1, 4) = 1.0f;
  m.primary()(2, 2) = -1.0f;
  return m;
}

TEST(MixerMotorModel, TurnsSquaredSpeedsIntoTheReferencesThrottles) {
  Mixer m = motor_mixer();
  for (const auto& [speed_sq, throttle] : {std::pair{0.0f, 0.0026250f},
                                           {1e4f, 0.0748583f},
                                           {1.6e5f, 0.3053573f},
                                           {4.9e5f, 0.5565551f}}) {
    const auto& out = m.step(wrench(speed_sq), armed());
    EXPECT_NEAR(out[0], throttle, 2e-7f);
    EXPECT_NEAR(out[2], 0.0026250f, 1e-7f);  // negative squared speed: none
  }
}

TEST(MixerMotorModel, LeavesServosAlone) {
  Mixer m = motor_mixer();
  EXPECT_FLOAT_EQ(m.step({0, 0, 0, 0, 0.5f}, armed())[1], 0.75f);
}

TEST(MixerMotorModel, FollowsBatteryAndAir) {
  Mixer m = motor_mixer();
  Mixer::Conditions c = armed();
  const float full = m.step(wrench(1.6e5f), c)[0];
  c.battery_V = 16.0f;
  EXPECT_NEAR(m.step(wrench(1.6e5f), c)[0], 1.5f * full, 1e-6f);
  c.density_kg_m3 = 1.0f;
  // Only the first term, 7.3286... - (0.063 + 0.01706 * 400) V, goes with the density.
  const float loss =
      (0.3053573f * 24.0f - 0.063f - 0.01706f * 400.0f) * (1.0f - 1.0f / 1.225f) / 16.0f;
  EXPECT_NEAR(m.step(wrench(1.6e5f), c)[0], 1.5f * full - loss, 1e-6f);
}

TEST(MixerMotorModel, ScalesWhenTheVoltageIsNotThere) {
  Mixer m = motor_mixer();
  Mixer::Conditions c = armed();
  c.battery_V = 16.0f;
  const auto& out = m.step(wrench(3.0f * 4.9e5f), c);
  EXPECT_GT(m.saturation(), 1.0f);
  EXPECT_FLOAT_EQ(out[0], 1.0f);
}

TEST(MixerMotorModel, TheVoltageIsNeverBelowSixTenthsOfTheFullBattery) {
  Mixer m = motor_mixer();  // 25 V when full
  Mixer::Conditions c = armed();
  c.battery_V = 15.01f;
  EXPECT_NEAR(m.step(wrench(1.6e5f), c)[0], 0.3053573f * 24.0f / 15.01f, 1e-6f);
  EXPECT_FALSE(m.voltage_replaced());
  const Mixer::Config config = m.config();
  for (const float volts : {14.99f, 6.0f, 0.0f, 0.9e-4f, -12.0f, kNan, kInf, -kInf}) {
    c.battery_V = volts;
    const auto& out = m.step({0, 0, 1e5f, 0, 0.5f}, c);
    EXPECT_TRUE(m.voltage_replaced()) << volts;
    EXPECT_FALSE(m.motor_model_failed()) << volts;
    EXPECT_NEAR(out[0], config.motor.voltage_V(1e5f, 1.225f) / 15.0f, 1e-6f) << volts;
    EXPECT_FLOAT_EQ(out[1], 0.75f);
  }
}

TEST(MixerMotorModel, TheVoltageIsNeverAboveElevenTenthsOfTheFullBattery) {
  Mixer m = motor_mixer();  // 25 V when full
  Mixer::Conditions c = armed();
  const Mixer::Config config = m.config();
  for (const float volts : {27.4f, 27.6f, 40.0f, 99.0f}) {
    c.battery_V = volts;
    const float used_V = std::min(volts, 27.5f);
    EXPECT_NEAR(m.step(wrench(1e5f), c)[0], config.motor.voltage_V(1e5f, 1.225f) / used_V, 1e-6f);
    EXPECT_EQ(m.voltage_replaced(), volts > 27.5f) << volts;
  }
}

TEST(MixerMotorModel, StopsMotorsWithoutAMotorConstantOrAnyVoltage) {
  Mixer m = motor_mixer();
  Mixer::Config config = m.config();
  config.motor.kv_V_s_rad = 0.9e-7f;
  m.configure(config);
  EXPECT_EQ(m.step({0, 0, 1e5f, 0, 0.5f}, armed())[0], 0.0f);
  EXPECT_TRUE(m.motor_model_failed());
  EXPECT_FLOAT_EQ(m.outputs()[1], 0.75f);  // the servo goes on
  config = motor_mixer().config();
  config.motor.full_voltage_V = 0.0f;  // then the measurement is all there is
  m.configure(config);
  EXPECT_GT(m.step(wrench(1e5f), armed())[0], 0.0f);
  EXPECT_FALSE(m.motor_model_failed());
  Mixer::Conditions c = armed();
  for (const float volts : {0.0f, 0.9e-4f, -12.0f, kNan, kInf}) {
    c.battery_V = volts;
    EXPECT_EQ(m.step(wrench(1e5f), c)[0], 0.0f) << volts;
    EXPECT_TRUE(m.motor_model_failed()) << volts;
  }
}

TEST(MixerMotorModel, CustomQuadrotorInNewtonsHoversAsItsFrameSays) {
  // Shipped frame: 3.9 kg at 23.5 V wants a throttle of 0.611 (multirotor-mixing figures, g
  // = 9.81).
  Mixer::Config config;
  config.use_motor_model = true;
  config.max_thrust_N = 98.0f;
  config.motor.resistance_ohm = 0.085f;
  config.motor.kv_V_s_rad = 0.02894f;
  config.motor.no_load_current_A = 1.01f;
  config.motor.prop_cq = 0.004286f;
  Mixer m = custom_mixer(
      {OutputType::kMotor, OutputType::kMotor, OutputType::kMotor, OutputType::kMotor}, config);
  const std::array<float, 4> roll{-1, -1, 1, 1};
  const std::array<float, 4> pitch{1, -1, -1, 1};
  const std::array<float, 4> yaw{1, -1, 1, -1};
  for (Eigen::Index k = 0; k < 4; ++k) {
    const auto i = static_cast<std::size_t>(k);
    m.primary()(k, 2) = -5814.7935f;
    m.primary()(k, 3) = 25303.7142f * roll[i];
    m.primary()(k, 4) = 25303.7142f * pitch[i];
    m.primary()(k, 5) = 267065.8876f * yaw[i];
  }
  Mixer::Conditions c = armed();
  c.battery_V = 23.5f;
  c.density_kg_m3 = 1.074f;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(m.step(wrench(-3.9f * 9.81f), c)[k], 0.611f, 5e-4f);
  }
  // A roll torque of 1 N m changes the squared speeds by 25303.7, right motors down.
  const float hover_sq = 3.9f * 9.81f * 5814.7935f;
  const auto& out = m.step(wrench(-3.9f * 9.81f, 1.0f), c);
  EXPECT_NEAR(out[0], config.motor.voltage_V(hover_sq - 25303.7142f, 1.074f) / 23.5f, 1e-5f);
  EXPECT_NEAR(out[2], config.motor.voltage_V(hover_sq + 25303.7142f, 1.074f) / 23.5f, 1e-5f);
}

// ---- primary and secondary

TEST(MixerSelection, EachInputHasItsOwnChoice) {
  // Weak points 10 and 11: per entry, the free ones included.
  Mixer m = custom_mixer({OutputType::kServo, OutputType::kServo});
  m.primary().row(0).setConstant(0.001f);
  m.secondary().row(1).setConstant(0.001f);
  Mixer::Config config;
  config.idle_throttle = 0.0f;  // keeps the yaw entry
  m.configure(config);
  Inputs u{};
  for (std::size_t i = 0; i < kAxes; ++i) u[i] = static_cast<float>(1 << i);
  for (const int primary : {0x000, 0x3FF, 0x007, 0x038, 0x2AA, 0x155, 0x200, 0x001}) {
    static_cast<void>(m.step(u, armed(static_cast<std::uint16_t>(primary))));
    EXPECT_NEAR(m.mixed()[0], 0.001f * static_cast<float>(primary), 1e-6f) << primary;
    EXPECT_NEAR(m.mixed()[1], 0.001f * static_cast<float>(0x3FF - primary), 1e-6f) << primary;
  }
}

TEST(MixerSelection, KnowsWhetherBothAgree) {
  Mixer m = make_mixer(MixerId::kQuadX);
  EXPECT_TRUE(m.mixers_agree());
  m.secondary()(0, 0) = 0.1f;
  EXPECT_FALSE(m.mixers_agree());
}

// ---- ESC calibration, thrust fraction

TEST(MixerEscCalibration, TakesTheWholeRangeOfAMultirotorCommand) {
  // Weak point 49: in ROSflight 2.x the motors stay at idle, up being negative.
  Mixer::Config config;
  config.unsigned_throttle = true;
  config.spin_when_armed = false;
  Mixer m = make_mixer(MixerId::kEscCalibration, config);
  for (const float throttle : {0.0f, 0.25f, 1.0f}) {
    for (const float value : {-throttle, throttle}) {
      const auto& out = m.step(wrench(value), armed());
      for (std::size_t k = 0; k < kChannels; ++k) EXPECT_NEAR(out[k], throttle, 1e-5f);
    }
  }
}

TEST(MixerAxisLimits, AreWhereTheFirstActuatorReachesItsEnd) {
  Mixer m = make_mixer(MixerId::kQuadX);
  const Inputs limits = m.axis_limits(1.225f);
  for (const std::size_t i : {2u, 3u, 4u, 5u}) {
    SCOPED_TRACE(i);
    Inputs u{};
    u[i] = limits[i];
    u[2] = i == 2 ? -limits[2] : 0.0f;
    Mixer::Config config;
    config.idle_throttle = 0.0f;  // keeps the yaw entry
    m.configure(config);
    static_cast<void>(m.step(u, armed()));
    EXPECT_NEAR(m.saturation(), 1.0f, 2e-4f);
    EXPECT_GE(m.saturation(), 1.0f) << "full output is within them";
  }
  EXPECT_NEAR(limits[3], 1.0f / 0.353557f, 1e-3f);
  for (const std::size_t i : {0u, 1u, 6u, 9u}) {
    EXPECT_EQ(limits[i], std::numeric_limits<float>::max()) << i;
  }
  const Inputs fixed_wing = make_mixer(MixerId::kInvertedVTail).axis_limits(1.225f);
  EXPECT_NEAR(fixed_wing[0], 1.0f, 2e-4f);
  EXPECT_NEAR(fixed_wing[4], 2.0f, 3e-4f);
}

TEST(MixerAxisLimits, AreThoseOfTheSecondaryAndOfItsUsedChannels) {
  Mixer m = custom_mixer({OutputType::kMotor, OutputType::kServo});
  m.primary()(0, 2) = 100.0f;
  m.secondary()(0, 2) = -0.5f;
  m.secondary()(1, 4) = 4.0f;
  m.secondary()(1, 5) = kNan;
  m.secondary()(7, 6) = 50.0f;  // a free channel
  const Inputs limits = m.axis_limits(1.225f);
  EXPECT_NEAR(limits[2], 2.0f, 3e-4f);
  EXPECT_NEAR(limits[4], 0.25f, 3e-5f);
  for (const std::size_t i : {5u, 6u}) EXPECT_EQ(limits[i], std::numeric_limits<float>::max());
}

TEST(MixerAxisLimits, WithMotorParametersTheFullBatteryIsTheEnd) {
  Mixer m = motor_mixer();  // input 2: gains 1 and -1; a servo on input 4
  m.secondary() = m.primary();
  const float full = m.config().motor.speed_sq_rad2_s2(25.0f, 1.225f);
  EXPECT_NEAR(m.axis_limits(1.225f)[2] / full, 1.0f, 2e-4f);
  EXPECT_NEAR(m.axis_limits(1.225f)[4], 1.0f, 2e-4f);
  EXPECT_GT(m.axis_limits(0.8f)[2], 1.01f * full) << "thin air brakes less";
  Mixer::Config config = m.config();
  config.fixed_wing = true;  // has no such law
  m.configure(config);
  EXPECT_NEAR(m.axis_limits(1.225f)[2], 1.0f, 2e-4f);
  config = motor_mixer().config();
  config.motor.kv_V_s_rad = 0.0f;
  m.configure(config);
  EXPECT_EQ(m.axis_limits(1.225f)[2], 0.0f) << "motors that cannot be driven";
}

TEST(MixerThrustFraction, IsTheMeanThrottleOfTheSecondary) {
  Mixer m = make_mixer(MixerId::kQuadX);
  EXPECT_NEAR(m.thrust_fraction(wrench(-0.6f), 1.225f), 0.6f, 1e-5f);
  EXPECT_NEAR(m.thrust_fraction(wrench(-0.6f, 0.1f, 0.1f, 0.1f), 1.225f), 0.6f, 1e-5f);
  EXPECT_EQ(m.thrust_fraction(wrench(0.5f), 1.225f), 0.0f);
  // Identity secondary: the companion drives the motors themselves, each with its own entry.
  m.secondary().setZero();
  for (Eigen::Index k = 0; k < 4; ++k) m.secondary()(k, k) = 1.0f;
  EXPECT_NEAR(m.thrust_fraction({0.2f, 0.4f, 0.6f, 0.8f}, 1.225f), 0.5f, 1e-6f);
}

TEST(MixerThrustFraction, IsAPartOfTheMaximumThrustWithMotorParameters) {
  Mixer::Config config;
  config.use_motor_model = true;
  config.max_thrust_N = 292.279f;
  Mixer m = custom_mixer(
      {OutputType::kMotor, OutputType::kMotor, OutputType::kMotor, OutputType::kMotor}, config);
  for (Eigen::Index k = 0; k < 4; ++k)
    m.secondary()(k, 2) = -5098.0312f;  // 1/(4 k_T) at 1.225 kg/m^3
  EXPECT_NEAR(m.thrust_fraction(wrench(-146.14f), 1.225f), 0.5f, 1e-4f);
}

TEST(MixerThrustFraction, WithoutMotorsThereIsNone) {
  Mixer m = custom_mixer({OutputType::kServo});
  m.secondary().setConstant(1.0f);
  EXPECT_EQ(m.thrust_fraction(wrench(-0.5f), 1.225f), 0.0f);
}

}  // namespace
}  // namespace rosflight::core
