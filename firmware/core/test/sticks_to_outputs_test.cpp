// SPDX-License-Identifier: BSD-3-Clause
// The whole way from the pilot's sticks and the companion's commands to the outputs, with the
// numbers of ROSflight 2.x: settings, command manager, controller and mixer in the order of the
// main loop.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "firmware/core/mixer_setup.hpp"
#include "firmware/core/settings.hpp"

namespace rosflight::core {
namespace {

class Chain {
 public:
  explicit Chain(const std::vector<std::pair<Param, float>>& changes = {
                     {Param::kPrimaryMixer, 2.0f}}) {
    for (const auto& [id, value] : changes) {
      const SetResult result = Parameters::row(id).type == ParamType::kInt32
                                   ? parameters.set_int(id, static_cast<std::int32_t>(value))
                                   : parameters.set_float(id, value);
      EXPECT_NE(result, SetResult::kOutOfRange);
    }
    Log log;
    EXPECT_TRUE(choose_mixers(parameters, mixer, log));
    configure();
  }
  void configure() {
    const float max_thrust_N =
        uses_motor_model(parameters) ? motor_settings(parameters).max_thrust_N(1.225f) : 1.0f;
    Rc rc;
    rc.configure(rc_settings(parameters));
    command.configure(command_settings(parameters, rc, !mixer.mixers_agree()));
    controller.configure(controller_settings(parameters, max_thrust_N));
    mixer.configure(mixer_settings(parameters, max_thrust_N));
    command.set_axis_limits(mixer.axis_limits(1.225f));
  }
  /// One pass, level and at rest, 1 kHz, armed.
  const hal::OutputValues& sticks(const PilotInput& pilot, bool failsafe = false) {
    now_ += hal::milliseconds(1);
    command.update(now_, pilot, true, failsafe);
    forces = controller.step(command.combined(), AttitudeEstimate{}, 0.001f, true, false);
    return mixer.step(forces, {1.225f, 24.0f, true, command.primary_axes()});
  }
  void offboard(link::OffboardMode mode, const std::array<float, kAxes>& u,
                std::uint16_t ignore = 0) {
    link::OffboardControl message{static_cast<std::uint8_t>(mode), ignore, u};
    EXPECT_TRUE(command.admit(message));
    const float fraction =
        mode == link::OffboardMode::kPassThrough ? mixer.thrust_fraction(message.u, 1.225f) : 0.0f;
    command.take_offboard(now_, message, fraction);
  }

  Parameters parameters;
  CommandManager command;
  Controller controller;
  Mixer mixer;
  Controller::Output forces{};

 private:
  Time now_{};
};

PilotInput pilot(float throttle, float roll = 0, float pitch = 0, float yaw = 0) {
  PilotInput p;
  p.throttle = throttle;
  p.roll = roll;
  p.pitch = pitch;
  p.yaw = yaw;
  return p;
}

TEST(SticksToOutputs, QuadXWithDefaultsIsTheReference) {
  struct Row {
    PilotInput sticks;
    std::array<float, 4> forces;  ///< F_z, Q_x, Q_y, Q_z
    std::array<float, 4> outputs;
  };
  const std::vector<Row> rows{
      {pilot(0.5f), {-0.35f, 0, 0, 0}, {0.35f, 0.35f, 0.35f, 0.35f}},
      {pilot(0.5f, 0.5f), {-0.35f, 0.05895f, 0, 0}, {0.329158f, 0.329158f, 0.370842f, 0.370842f}},
      {pilot(0.5f, 0, 0.5f),
       {-0.35f, 0, 0.05895f, 0},
       {0.370842f, 0.329158f, 0.329158f, 0.370842f}},
      {pilot(0.5f, 0, 0, 0.5f),
       {-0.35f, 0, 0, 0.18837f},
       {0.397094f, 0.302906f, 0.397094f, 0.302906f}},
      {pilot(1.0f, 1.0f, 0, 1.0f),
       {-0.70f, 0.11790f, 0, 0.37675f},
       {0.752503f, 0.564128f, 0.835872f, 0.647497f}},
      {pilot(0.05f), {-0.035f, 0, 0, 0}, {0.1f, 0.1f, 0.1f, 0.1f}},
      {pilot(0.05f, 0, 0, 0.6f), {-0.035f, 0, 0, 0.22605f}, {0.1f, 0.1f, 0.1f, 0.1f}}};
  for (const Row& row : rows) {
    Chain chain;
    const auto& out = chain.sticks(row.sticks);
    for (std::size_t k = 0; k < 4; ++k) {
      SCOPED_TRACE(k);
      EXPECT_NEAR(chain.forces[2 + k], row.forces[k], 6e-6f);  // five digits are published
      EXPECT_NEAR(out[k], row.outputs[k], 3e-6f);              // noise of the pseudo-inverse
    }
    for (std::size_t k = 4; k < out.size(); ++k) EXPECT_EQ(out[k], 0.0f);
  }
}

TEST(SticksToOutputs, FailsafeThrottleIsScaledByTheMaximum) {
  // Weak point 7 is kept: FAILSAFE_THR 0.4 gives 0.28 with RC_MAX_THR 0.7.
  Chain chain({{Param::kPrimaryMixer, 2.0f}, {Param::kFailsafeThr, 0.4f}});
  const auto& out = chain.sticks(pilot(0.9f, 1.0f), true);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(out[k], 0.28f, 3e-6f);
}

TEST(SticksToOutputs, FailsafeGoesThroughThePrimaryMixer) {
  // Weak point 4: identity secondary, companion in control, radio lost. ROSflight 2.x leaves the
  // motors at idle.
  Chain chain({{Param::kPrimaryMixer, 2.0f},
               {Param::kSecondaryMixer, 11.0f},
               {Param::kSecMixer0_0, 1.0f},
               {Param::kSecMixer1_1, 1.0f},
               {Param::kSecMixer2_2, 1.0f},
               {Param::kSecMixer3_3, 1.0f},
               {Param::kFailsafeThr, 0.4f}});
  chain.offboard(link::OffboardMode::kPassThrough, {0.3f, 0.4f, 0.5f, 0.6f});
  const auto& companion = chain.sticks(pilot(0.9f));
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(companion[k], 0.3f + 0.1f * static_cast<float>(k), 1e-6f);
  }
  const auto& out = chain.sticks(pilot(0.9f), true);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(out[k], 0.28f, 3e-6f);
}

TEST(SticksToOutputs, TheCompanionsThrottleIsScaledAsThePilots) {
  Chain chain;
  chain.offboard(link::OffboardMode::kRollPitchYawrateThrottle, {0, 0, 0.5f});
  const auto& out = chain.sticks(pilot(1.0f));
  EXPECT_NEAR(chain.forces[2], -0.35f, 1e-6f);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(out[k], 0.35f, 3e-6f);
}

TEST(SticksToOutputs, LoweringTheStickCutsPassThroughThrust) {
  // Weak point 12: with F_z = -0.6 in pass-through ROSflight 2.x's motors stay at 0.6.
  Chain chain;
  chain.offboard(link::OffboardMode::kPassThrough, {0, 0, -0.6f});
  EXPECT_NEAR(chain.sticks(pilot(1.0f))[0], 0.6f, 3e-6f);
  EXPECT_NEAR(chain.sticks(pilot(0.3f))[0], 0.21f, 3e-6f);
  EXPECT_EQ(chain.sticks(pilot(0.0f))[0], 0.1f);
}

TEST(SticksToOutputs, FixedWingPassesSticksThrough) {
  Chain chain({{Param::kPrimaryMixer, 9.0f}, {Param::kFixedWing, 1.0f}, {Param::kRcFAxis, 0.0f}});
  const auto& out = chain.sticks(pilot(0.6f, 0.2f, -0.4f, 0.8f));
  EXPECT_NEAR(out[0], 0.6f, 1e-6f);
  EXPECT_NEAR(out[1], 0.3f, 1e-6f);
  EXPECT_NEAR(out[2], 0.9f, 1e-6f);
  EXPECT_NEAR(out[4], 0.6f, 1e-6f);
}

TEST(SticksToOutputs, EscCalibrationReachesBothEndsOfTheStick) {
  // Weak point 49. Full stick is full output although RC_MAX_THR is 0.7, and no stick none although
  // armed motors idle at 0.1, with motor parameters too.
  for (const float spin : {0.0f, 1.0f}) {
    for (const float motor_param : {0.0f, 1.0f}) {
      Chain chain({{Param::kPrimaryMixer, 0.0f},
                   {Param::kArmSpinMotors, spin},
                   {Param::kUseMotorParam, motor_param}});
      for (const float throttle : {0.0f, 0.5f, 1.0f}) {
        const auto& out = chain.sticks(pilot(throttle));
        for (std::size_t k = 0; k < kChannels; ++k) EXPECT_NEAR(out[k], throttle, 1e-5f);
      }
    }
  }
}

TEST(SticksToOutputs, APredefinedMixerWithMotorParametersComputesWithLoadedConstants) {
  // Weak point 47: ROSflight 2.x computes with numbers that were never loaded.
  Chain chain({{Param::kPrimaryMixer, 2.0f}, {Param::kUseMotorParam, 1.0f}});
  static_cast<void>(chain.sticks(pilot(1.0f)));
  EXPECT_NEAR(chain.forces[2], -0.7f * 292.279f, 1e-3f);
  EXPECT_FALSE(chain.mixer.motor_model_failed());
  // 204.6 rad^2/s^2: V = a tiny first term + 0.063 + 0.01706 * sqrt(204.595)
  EXPECT_NEAR(chain.mixer.mixed()[0], (0.063f + 0.01706f * 14.3037f + 0.00057f) / 24.0f, 1e-5f);
}

// ---- offboard values are limited by their type

TEST(SticksToOutputs, DegreesForRadiansGiveTheOutputsOfTheLargestAngle) {
  const auto outputs = [](float roll, float pitch) {
    Chain chain;
    PilotInput pilot;
    pilot.throttle = 0.9f;
    chain.offboard(link::OffboardMode::kRollPitchYawrateThrottle, {0, 0, 0.5f, roll, pitch});
    return chain.sticks(pilot);
  };
  const auto limited = outputs(20.0f, -20.0f);
  EXPECT_EQ(limited, outputs(0.786f, -0.786f));
  EXPECT_NE(limited, outputs(0.785f, -0.785f));
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT(limited[k], 0.6f) << "far from full output";
}

TEST(SticksToOutputs, PassThroughWithinTheMeansOfTheMixerIsUntouched) {
  // The forces that reach the mixer are the very numbers of the message.
  Chain chain({{Param::kPrimaryMixer, 2.0f}, {Param::kTakeMinThr, 0.0f}});
  const PilotInput pilot;
  for (int k = 0; k < 400; ++k) {
    const float wave = std::sin(0.1f * static_cast<float>(k));
    const std::array<float, kAxes> u{0.0f,        0.0f,         -0.35f + 0.34f * wave,
                                     2.8f * wave, -2.8f * wave, 3.9f * wave};
    chain.offboard(link::OffboardMode::kPassThrough, u);
    static_cast<void>(chain.sticks(pilot));
    ASSERT_EQ(chain.forces, u);
  }
  EXPECT_EQ(chain.command.limited().count, 0u);
  chain.offboard(link::OffboardMode::kPassThrough, {0, 0, -1.0f});
  EXPECT_EQ(chain.command.limited().count, 0u) << "full output";
  chain.offboard(link::OffboardMode::kPassThrough, {0, 0, -0.5f, 20.0f});
  EXPECT_EQ(chain.command.limited().count, 1u);
}

TEST(SticksToOutputs, ACustomMixerInNewtonsTakesNewtonsAndNewtonMetres) {
  // Four motors that share 292.279 N at 25 V and stand 0.25 m from both axes.
  Chain chain(
      {{Param::kPrimaryMixer, 11.0f}, {Param::kUseMotorParam, 1.0f}, {Param::kTakeMinThr, 0.0f}});
  const float thrust_gain = motor_settings(chain.parameters).thrust_gain(1.225f);
  constexpr float kArm_m = 0.25f;
  MixerHeader header;
  const std::array<float, 4> roll{-1, -1, 1, 1};
  for (std::size_t k = 0; k < 4; ++k) {
    header.type[k] = OutputType::kMotor;
    const auto row = static_cast<Eigen::Index>(k);
    chain.mixer.primary()(row, 2) = -0.25f / thrust_gain;
    chain.mixer.primary()(row, 3) = 0.25f * roll[k] / (kArm_m * thrust_gain);
  }
  chain.mixer.secondary() = chain.mixer.primary();
  chain.mixer.set_header(header);
  chain.configure();
  const PilotInput pilot;
  const std::array<float, kAxes> u{0, 0, -200.0f, 70.0f, 1e30f};  // nothing uses axis 4
  chain.offboard(link::OffboardMode::kPassThrough, u);
  static_cast<void>(chain.sticks(pilot));
  EXPECT_EQ(chain.forces, u);
  EXPECT_EQ(chain.command.limited().count, 0u);
  chain.offboard(link::OffboardMode::kPassThrough, {0, 0, -1000.0f, 1000.0f});
  static_cast<void>(chain.sticks(pilot));
  EXPECT_EQ(chain.command.limited().count, 1u);
  EXPECT_NEAR(chain.forces[2], -292.279f, 0.1f);
  EXPECT_NEAR(chain.forces[3], 292.279f * kArm_m, 0.1f);
}

// ---- a pass-through companion under the pilot's throttle

TEST(SticksToOutputs, WithoutThrustAPassThroughCompanionHasNoTorqueEither) {
  Chain chain;
  PilotInput pilot;
  const std::array<float, kAxes> u{0, 0, -0.6f, 0.3f, -0.2f, 0.4f};
  const auto motors = [&](float throttle) {
    pilot.throttle = throttle;
    chain.offboard(link::OffboardMode::kPassThrough, u);
    return chain.sticks(pilot);
  };
  static_cast<void>(motors(1.0f));
  EXPECT_EQ(chain.forces, u);
  for (const float throttle : {0.0f, -0.1f}) {
    const auto& out = motors(throttle);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(out[k], 0.1f) << "idle";
  }
  static_cast<void>(motors(0.3f / 0.7f));  // half of the thrust, half of the torques
  for (std::size_t k = 2; k < 6; ++k) EXPECT_NEAR(chain.forces[k], 0.5f * u[k], 1e-5f) << k;
}

}  // namespace
}  // namespace rosflight::core
