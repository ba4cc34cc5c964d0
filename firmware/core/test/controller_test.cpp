// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/controller.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kDt = 0.0025f;

CommandVector command(std::array<float, kAxes> value, CommandType attitude = CommandType::kAngle,
                      CommandType yaw = CommandType::kRate,
                      CommandType force = CommandType::kThrottle) {
  CommandVector c;
  c.value = value;
  c.type[0] = c.type[1] = c.type[2] = force;
  c.type[3] = c.type[4] = attitude;
  c.type[5] = yaw;
  return c;
}

AttitudeEstimate state(float roll = 0, float pitch = 0, const Vector3& rates = Vector3::Zero()) {
  AttitudeEstimate s;
  s.q_WB = quaternion_from_euler(roll, pitch, 0.0f);
  s.roll_rad = roll;
  s.pitch_rad = pitch;
  s.rates_rad_s = rates;
  return s;
}

Controller make(const Controller::Config& config) {
  Controller c;
  c.configure(config);
  return c;
}

TEST(Controller, ScalesThrottleAndSignsItForUp) {
  Controller c = make({});
  const auto& u = c.step(command({0.2f, 0.4f, 0.5f}), state(), kDt, true, false);
  EXPECT_FLOAT_EQ(u[0], 0.2f * 0.7f);
  EXPECT_FLOAT_EQ(u[1], 0.4f * 0.7f);
  EXPECT_FLOAT_EQ(u[2], -0.5f * 0.7f);
}

TEST(Controller, ScalesThrottleByTheMaximumThrustInNewtons) {
  Controller::Config config;
  config.max_thrust_N = 292.279f;
  Controller c = make(config);
  EXPECT_FLOAT_EQ(c.step(command({0, 0, 0.5f}), state(), kDt, true, false)[2],
                  -0.5f * 0.7f * 292.279f);
}

TEST(Controller, PassesThroughWhatIsNotThrottleAngleOrRate) {
  Controller c = make({});
  constexpr auto kPass = CommandType::kPassThrough;
  const std::array<float, kAxes> u{-1.0f, 2.0f, -3.0f, 0.4f, -0.5f, 0.6f, 7.0f, 8.0f, 9.0f, 10.0f};
  EXPECT_EQ(c.step(command(u, kPass, kPass, kPass), state(1, 1, Vector3::Ones()), kDt, true, false),
            u);
}

TEST(Controller, EntriesSixToNinePassInEveryMode) {
  Controller c = make({});
  const auto& u = c.step(command({0, 0, 0, 0, 0, 0, 1, 2, 3, 4}), state(), kDt, true, false);
  EXPECT_EQ(u[6], 1.0f);
  EXPECT_EQ(u[9], 4.0f);
}

TEST(Controller, AngleLoopsUseTheAngleAndTheBodyRate) {
  Controller c = make({});
  // roll: 0.15 (0.3 - 0.1) - 0.05 * 0.4 ; pitch: 0.15 (-0.2 - 0.1) - 0.05 * (-0.6)
  const auto& u = c.step(command({0, 0, 0, 0.3f, -0.2f}), state(0.1f, 0.1f, {0.4f, -0.6f, 0}), kDt,
                         true, false);
  EXPECT_FLOAT_EQ(u[3], 0.15f * 0.2f - 0.02f);
  EXPECT_FLOAT_EQ(u[4], 0.15f * -0.3f + 0.03f);
}

// ---- angle errors, of any attitude

/// Roll and pitch torque with gains of 1: the errors that the loops get.
std::array<float, 2> angle_errors(const Quaternion& q_WB, float roll, float pitch,
                                  CommandType pitch_type = CommandType::kAngle) {
  Controller::Config config;
  config.roll_angle = config.pitch_angle = {1.0f, 0, 0};
  config.pitch_rate = {0, 0, 0};
  Controller c = make(config);
  AttitudeEstimate s;
  s.q_WB = q_WB;
  s.roll_rad = roll_of(q_WB);
  s.pitch_rad = pitch_of(q_WB);
  CommandVector cmd = command({0, 0, 0.5f, roll, pitch});
  cmd.type[4] = pitch_type;
  const auto& u = c.step(cmd, s, kDt, true, false);
  return {u[3], u[4]};
}
constexpr float kDeg = kRadPerDeg;

/// Turned by roll about x or pitch about y alone, at a heading; any angle.
Quaternion rolled(float deg, float heading_deg = 0.0f) {
  return quaternion_from_euler(0, 0, heading_deg * kDeg) * quaternion_from_euler(deg * kDeg, 0, 0);
}
Quaternion pitched(float deg, float heading_deg = 0.0f) {
  const auto [s, c] = sin_cos(deg * kDeg / 2.0f);
  return quaternion_from_euler(0, 0, heading_deg * kDeg) * Quaternion{c, 0.0f, s, 0.0f};
}
float wrapped_deg(float deg) {
  return std::remainder(deg, 360.0f);
}

TEST(ControllerAttitude, ErrorsInRollAloneOrPitchAloneAreDifferencesAtEveryTilt) {
  for (const float heading : {0.0f, 70.0f, 180.0f, -135.0f}) {
    for (float is = -179.0f; is < 180.0f; is += 7.0f) {
      for (const float wanted : {0.0f, 30.0f, -45.0f}) {
        const float error = wrapped_deg(wanted - is);
        if (std::abs(error) > 178.0f) continue;  // either way is short
        SCOPED_TRACE(is);
        const auto roll = angle_errors(rolled(is, heading), wanted * kDeg, 0.0f);
        EXPECT_NEAR(roll[0], error * kDeg, 2e-5f);
        EXPECT_NEAR(roll[1], 0.0f, 1e-5f);
        const auto pitch = angle_errors(pitched(is, heading), 0.0f, wanted * kDeg);
        EXPECT_NEAR(pitch[1], error * kDeg, std::abs(is) < 80.0f ? 2e-5f : 3e-4f);
        EXPECT_NEAR(pitch[0], 0.0f, 1e-4f);
      }
    }
  }
}

TEST(ControllerAttitude, UpToSixtyDegreesOfTiltTheErrorsAreTheDifferencesOfRollAndPitch) {
  for (const float heading : {0.0f, 120.0f}) {
    for (float roll = -42.0f; roll <= 42.0f; roll += 6.0f) {
      for (float pitch = -42.0f; pitch <= 42.0f; pitch += 6.0f) {
        const Quaternion q = quaternion_from_euler(roll * kDeg, pitch * kDeg, heading * kDeg);
        const auto e = angle_errors(q, 0.786f, -0.5f);
        ASSERT_EQ(e[0], 0.786f - roll_of(q));
        ASSERT_EQ(e[1], -0.5f - pitch_of(q));
      }
    }
  }
}

TEST(ControllerAttitude, NothingFlipsBeyond90DegreesOfPitch) {
  for (const float sign : {1.0f, -1.0f}) {
    for (const float pitch : {89.0f, 89.9f, 90.0f, 90.1f, 91.0f, 120.0f, 179.0f}) {
      const auto e = angle_errors(pitched(sign * pitch), 0.0f, 0.0f);
      EXPECT_NEAR(e[0], 0.0f, 1e-3f) << pitch;
      EXPECT_NEAR(e[1], -sign * pitch * kDeg, 1e-3f) << pitch;
      // Roll is held at zero while a loop is flown with the pitch rate.
      const auto loop = angle_errors(pitched(sign * pitch), 0.0f, 0.0f, CommandType::kRate);
      EXPECT_NEAR(loop[0], 0.0f, 1e-3f) << pitch;
    }
  }
  // A little roll or yaw near the vertical changes the errors a little.
  for (const float pitch : {88.0f, 90.0f, 92.0f}) {
    for (const float small : {-1.0f, 1.0f}) {
      const auto e = angle_errors(pitched(pitch) * rolled(small), 0.0f, 0.0f);
      EXPECT_NEAR(e[0], 0.0f, 3.0f * kDeg) << pitch;
      EXPECT_NEAR(e[1], -pitch * kDeg, 3.0f * kDeg) << pitch;
      const auto yawed =
          angle_errors(pitched(pitch) * quaternion_from_euler(0, 0, small * kDeg), 0.0f, 0.0f);
      EXPECT_NEAR(yawed[0], 0.0f, 3.0f * kDeg) << pitch;
      EXPECT_NEAR(yawed[1], -pitch * kDeg, 3.0f * kDeg) << pitch;
    }
  }
}

TEST(ControllerAttitude, InEveryQuadrantTheErrorsLeadToTheWantedAttitude) {
  // Follows the errors as body rates in small steps from every attitude, inverted ones included.
  for (int roll = -180; roll < 180; roll += 20) {
    for (int pitch = -80; pitch <= 80; pitch += 20) {
      for (const auto& [wanted_roll, wanted_pitch] :
           {std::pair{0.0f, 0.0f}, {0.5f, 0.3f}, {-0.786f, 0.786f}}) {
        Quaternion q = quaternion_from_euler(static_cast<float>(roll) * kDeg,
                                             static_cast<float>(pitch) * kDeg, 1.0f);
        float travelled = 0.0f;
        for (int k = 0; k < 2000; ++k) {
          const auto e = angle_errors(q, wanted_roll, wanted_pitch);
          ASSERT_TRUE(std::isfinite(e[0]) && std::isfinite(e[1]));
          ASSERT_LT(std::hypot(e[0], e[1]), 1.5f * kPi);
          travelled += 0.01f * std::hypot(e[0], e[1]);
          q = normalized(q * Quaternion{1.0f, 0.005f * e[0], 0.005f * e[1], 0.0f});
        }
        EXPECT_NEAR(roll_of(q), wanted_roll, 1e-2f) << roll << " " << pitch;
        EXPECT_NEAR(pitch_of(q), wanted_pitch, 1e-2f) << roll << " " << pitch;
        EXPECT_LT(travelled, 1.6f * kPi) << "no detours";
      }
    }
  }
}

TEST(ControllerAttitude, ErrorsAreContinuousInTheTilt) {
  for (const float direction : {0.0f, 0.4f, 1.2f, 2.5f, -2.0f}) {
    std::array<float, 2> last{};
    for (int k = 0; k <= 1500; ++k) {  // to 150 degrees, short of the opposite of what is wanted
      const auto [s, c] = sin_cos(0.1f * static_cast<float>(k) * kDeg / 2.0f);
      const auto [sd, cd] = sin_cos(direction);
      const auto e = angle_errors({c, cd * s, sd * s, 0.0f}, 0.1f, -0.2f);
      if (k > 0) {
        ASSERT_NEAR(e[0], last[0], 0.03f) << 0.1f * static_cast<float>(k);
        ASSERT_NEAR(e[1], last[1], 0.03f) << 0.1f * static_cast<float>(k);
      }
      last = e;
    }
  }
}

TEST(ControllerAttitude, InvertedAndNotANumber) {
  for (const Quaternion& inverted :
       {rolled(180.0f), pitched(180.0f), Quaternion{0, 0.6f, 0.8f, 0}}) {
    const auto e = angle_errors(inverted, 0.0f, 0.0f);
    EXPECT_NEAR(std::hypot(e[0], e[1]), kPi, 1e-3f) << "half a turn about some axis";
  }
  const float nan = std::nanf("");
  for (const Quaternion& q :
       {Quaternion{nan, 0, 0, 0}, Quaternion{1, nan, 0, 0}, Quaternion{nan, nan, nan, nan}}) {
    const auto e = angle_errors(q, 0.1f, 0.1f);
    EXPECT_TRUE(std::isnan(e[0]) || std::isnan(e[1])) << "the mixer stops the motors";
  }
  const auto e = angle_errors(rolled(120.0f), nan, 0.0f);
  EXPECT_TRUE(std::isnan(e[0]));
}

TEST(Controller, RateLoopsUseTheRates) {
  Controller c = make({});
  const auto& u = c.step(command({0, 0, 0, 1.0f, -2.0f, 0.5f}, CommandType::kRate),
                         state(1, 1, {0.25f, 0.5f, -0.5f}), kDt, true, false);
  EXPECT_FLOAT_EQ(u[3], 0.07f * 0.75f);
  EXPECT_FLOAT_EQ(u[4], 0.07f * -2.5f);
  EXPECT_FLOAT_EQ(u[5], 0.25f * 1.0f);
}

TEST(Controller, RateDerivativeIsThatOfTheMeasurement) {
  Controller::Config config;
  config.roll_rate = {0.0f, 0.0f, 1.0f};
  Controller c = make(config);
  const auto at = [&](float rate, float wanted) {
    return c.step(command({0, 0, 0, wanted}, CommandType::kRate), state(0, 0, {rate, 0, 0}), kDt,
                  true, false)[3];
  };
  EXPECT_EQ(at(1.0f, 0.0f), 0.0f);
  EXPECT_FLOAT_EQ(at(1.5f, 0.0f), -1.0f / 0.1025f);  // tau 0.05, dt 0.0025
  // A jump of the command is no derivative: only the old one fades.
  EXPECT_FLOAT_EQ(at(1.5f, 9.0f), -1.0f / 0.1025f * 0.0975f / 0.1025f);
}

TEST(Controller, YawAsAnAngleIsPassedThrough) {
  Controller c = make({});
  EXPECT_EQ(c.step(command({0, 0, 0, 0, 0, 0.3f}, CommandType::kAngle, CommandType::kAngle),
                   state(), kDt, true, false)[5],
            0.3f);
}

TEST(Controller, AddsTheEquilibriumTorqueInEveryMode) {
  Controller::Config config;
  config.equilibrium_torque = {0.01f, -0.02f, 0.03f};
  for (const CommandType type : {CommandType::kAngle, CommandType::kRate, CommandType::kPassThrough,
                                 CommandType::kThrottle}) {
    Controller c = make(config);
    const auto& u = c.step(command({}, type, type), state(), kDt, true, false);
    EXPECT_FLOAT_EQ(u[3], 0.01f);
    EXPECT_FLOAT_EQ(u[4], -0.02f);
    EXPECT_FLOAT_EQ(u[5], 0.03f);
  }
}

// ---- integration

Controller::Config integrating() {
  Controller::Config config;
  config.roll_angle = {0.0f, 1.0f, 0.0f};
  return config;
}

float roll_torque(Controller& c, float throttle, bool armed = true, float dt = 0.005f,
                  bool saturated = false, float roll = 0.2f) {
  return c.step(command({0, 0, throttle, roll}), state(), dt, armed, saturated)[3];
}

TEST(ControllerIntegral, GrowsOnlyArmedWithThrottleAndShortSteps) {
  const auto grows = [](float throttle, bool armed, float dt, bool saturated) {
    Controller c = make(integrating());
    return roll_torque(c, throttle, armed, dt, saturated) != 0.0f;
  };
  EXPECT_TRUE(grows(0.5f, true, 0.005f, false));
  EXPECT_FALSE(grows(0.5f, false, 0.005f, false));
  EXPECT_FALSE(grows(0.1f, true, 0.005f, false));  // must be above 0.1
  EXPECT_TRUE(grows(0.101f, true, 0.005f, false));
  EXPECT_FALSE(grows(0.5f, true, 0.01f, false));  // must be below 10 ms
  EXPECT_FALSE(grows(0.5f, true, 0.005f, true));  // saturated
}

TEST(ControllerIntegral, AnyForceEntryCounts) {
  for (std::size_t entry = 0; entry < 3; ++entry) {
    Controller c = make(integrating());
    std::array<float, kAxes> u{};
    u[entry] = 0.5f;
    u[3] = 0.2f;
    EXPECT_GT(c.step(command(u), state(), 0.005f, true, false)[3], 0.0f) << entry;
  }
}

TEST(ControllerIntegral, IsHeldWhenTheThrottleIsLowered) {
  // Weak point 40: ROSflight 2.x drops the whole I share at once.
  Controller c = make(integrating());
  for (int k = 0; k < 200; ++k) roll_torque(c, 0.5f);
  const float with_throttle = roll_torque(c, 0.5f);
  EXPECT_NEAR(with_throttle, 0.2f, 2e-3f);  // 0.2 rad for 1 s
  EXPECT_FLOAT_EQ(roll_torque(c, 0.05f), with_throttle);
  EXPECT_FLOAT_EQ(roll_torque(c, 0.05f), with_throttle);
}

TEST(ControllerIntegral, IsClampedAtFullTorque) {
  Controller c = make(integrating());
  for (int k = 0; k < 5000; ++k) ASSERT_LE(roll_torque(c, 0.5f), 1.0f);
  EXPECT_FLOAT_EQ(roll_torque(c, 0.5f), 1.0f);
  Controller::Config newtons = integrating();
  newtons.max_thrust_N = 20.0f;
  Controller n = make(newtons);
  for (int k = 0; k < 50'000; ++k) roll_torque(n, 0.5f);
  EXPECT_FLOAT_EQ(roll_torque(n, 0.5f), 20.0f);
}

TEST(ControllerIntegral, UnwindsWhileTheMotorsAreSaturated) {
  Controller c = make(integrating());
  for (int k = 0; k < 200; ++k) roll_torque(c, 0.5f);
  const float wound = roll_torque(c, 0.0f);
  ASSERT_NEAR(wound, 0.2f, 2e-3f);
  for (int k = 0; k < 100; ++k) roll_torque(c, 0.5f, true, 0.005f, true);
  EXPECT_EQ(roll_torque(c, 0.0f), wound) << "no further";
  for (int k = 0; k < 100; ++k) roll_torque(c, 0.5f, true, 0.005f, true, -0.2f);
  EXPECT_NEAR(roll_torque(c, 0.0f), wound - 0.1f, 2e-3f) << "but back";
}

TEST(ControllerIntegral, AnotherGainMakesNoStep) {
  for (const float gain : {0.25f, 4.0f, 0.0f}) {
    Controller::Config config = integrating();
    Controller c = make(config);
    for (int k = 0; k < 200; ++k) roll_torque(c, 0.5f);
    const float before = roll_torque(c, 0.0f);
    config.roll_angle.i = gain;
    c.configure(config);
    EXPECT_EQ(roll_torque(c, 0.0f), before) << gain;
  }
}

TEST(ControllerIntegral, IsForgottenOnResetAndOnAChangeOfMode) {
  // Weak points 40 and 41.
  Controller c = make(integrating());
  for (int k = 0; k < 200; ++k) roll_torque(c, 0.5f);
  c.reset();
  EXPECT_EQ(roll_torque(c, 0.0f), 0.0f);
  for (int k = 0; k < 200; ++k) roll_torque(c, 0.5f);
  ASSERT_GT(roll_torque(c, 0.0f), 0.1f);
  static_cast<void>(
      c.step(command({0, 0, 0, 0.2f}, CommandType::kPassThrough), state(), kDt, true, false));
  EXPECT_EQ(roll_torque(c, 0.0f), 0.0f);
}

TEST(ControllerModes, ALoopThatStartsHasNoKick) {
  // Weak point 41: the differentiator of ROSflight 2.x compares with the value of the last time the
  // loop ran.
  Controller::Config config;
  config.roll_rate = {0.0f, 0.0f, 1.0f};
  config.roll_angle = {0.0f, 0.0f, 0.0f};
  Controller c = make(config);
  const auto at = [&](CommandType type, float rate) {
    return c.step(command({}, type), state(0, 0, {rate, 0, 0}), kDt, true, false)[3];
  };
  static_cast<void>(at(CommandType::kRate, 0.0f));
  static_cast<void>(at(CommandType::kAngle, 2.0f));
  EXPECT_EQ(at(CommandType::kRate, 4.0f), 0.0f);
  EXPECT_NE(at(CommandType::kRate, 5.0f), 0.0f);
}

TEST(ControllerModes, OneAxisChangingModeLeavesTheOthersAlone) {
  Controller::Config config;
  config.roll_angle = config.pitch_angle = {0.0f, 1.0f, 0.0f};
  Controller c = make(config);
  CommandVector cmd = command({0, 0, 0.5f, 0.2f, 0.2f});
  for (int k = 0; k < 200; ++k) static_cast<void>(c.step(cmd, state(), 0.005f, true, false));
  cmd.type[3] = CommandType::kRate;
  cmd.value[2] = 0.0f;
  static_cast<void>(c.step(cmd, state(), 0.005f, true, false));
  cmd.type[3] = CommandType::kAngle;
  const auto& u = c.step(cmd, state(), 0.005f, true, false);
  EXPECT_EQ(u[3], 0.0f);
  EXPECT_NEAR(u[4], 0.2f, 2e-3f);
}

TEST(ControllerModes, NoTimeIsHarmless) {
  Controller::Config config;
  config.roll_rate = config.pitch_rate = config.yaw_rate = {0.1f, 0.1f, 0.1f};
  config.tau_s = 0.0f;
  Controller c = make(config);
  for (int k = 0; k < 5; ++k) {
    for (const float v : c.step(command({0, 0, 0.5f, 1, 1, 1}, CommandType::kRate),
                                state(0, 0, {static_cast<float>(k), 1, 1}), 0.0f, true, false)) {
      EXPECT_TRUE(std::isfinite(v));
    }
  }
}

TEST(ControllerTrim, IsTheTorqueOfTheSticksAtRest) {
  // K_P times the command in multirotor modes ...
  const Controller c = make({});
  const auto angle = c.trim(command({0, 0, 0.5f, 0.0786f, -0.0393f, 0.1507f}));
  EXPECT_FLOAT_EQ(angle[0], 0.15f * 0.0786f);
  EXPECT_FLOAT_EQ(angle[1], 0.15f * -0.0393f);
  EXPECT_FLOAT_EQ(angle[2], 0.25f * 0.1507f);
  const auto rate = c.trim(command({0, 0, 0.5f, 0.3f, -0.2f, 0.1f}, CommandType::kRate));
  EXPECT_FLOAT_EQ(rate[0], 0.07f * 0.3f);
  EXPECT_FLOAT_EQ(rate[1], 0.07f * -0.2f);
  // ... and the bare stick in fixed wings.
  const auto fixed = c.trim(
      command({0, 0, 0, 0.1f, -0.2f, 0.3f}, CommandType::kPassThrough, CommandType::kPassThrough));
  EXPECT_EQ(fixed, (std::array<float, 3>{0.1f, -0.2f, 0.3f}));
}

TEST(ControllerTrim, DoesNotContainTheTrimInForceAndTouchesNoLoop) {
  Controller::Config config = integrating();
  config.equilibrium_torque = {0.5f, 0.5f, 0.5f};
  Controller c = make(config);
  for (int k = 0; k < 100; ++k) roll_torque(c, 0.5f);
  const float before = roll_torque(c, 0.0f);
  EXPECT_EQ(c.trim(command({}))[0], 0.0f);
  EXPECT_EQ(roll_torque(c, 0.0f), before);
}

}  // namespace
}  // namespace rosflight::core
