// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/controller.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "autonomy/multirotor/test/plant.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kWeight = 3.5 * 9.81;
constexpr double kFloat = 1e-6;  // the command travels in single precision

Quaternion attitude(double roll, double pitch, double yaw) {
  return Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ()) *
                    Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                    Eigen::AngleAxisd(roll, Vector3::UnitX()));
}

ThrustModel thrust_model() {
  return ThrustModel(ThrustModel::curve_of(test::default_rotors()), {0.7, 0.0});
}

/// Gains without integrals, so that one step can be worked out by hand.
ControllerConfig plain() {
  ControllerConfig c;
  for (PidGains* gains : {&c.velocity_horizontal, &c.velocity_vertical, &c.yaw_to_torque})
    gains->ki = 0.0;
  return c;
}

struct Bench {
  explicit Bench(const ControllerConfig& c = plain()) : controller(c, thrust_model()) {}
  Controller::Output step(ControlMode mode, const std::array<double, 4>& cmd, double dt_s = 0.01) {
    const AttitudeView view(state.q_WB);
    const ControllerCommand command{mode, cmd, true};
    return controller.step({state, view, command, dt_s, pilot, on_ground, 0.0});
  }

  Controller controller;
  State state{};
  PilotOverride pilot{};
  bool on_ground{false};
};

double u(const Controller::Output& out, std::size_t k) {
  return static_cast<double>(out.command.u[k]);
}

TEST(Controller, EveryModeReachesTheFirmwareModeOfItsChain) {
  // ROSflight 2.x: firmware mode of each of the twelve entry modes.
  const int with_own_loops[] = {2, 2, 2, 2, 2, 2, 2, 1, 0, 0, 0, 0};
  const int with_firmware_loops[] = {2, 2, 2, 2, 2, 2, 2, 1, 0, 2, 2, 1};
  for (std::size_t mode = 0; mode < kControlModes; ++mode) {
    for (const auto loops : {AttitudeLoops::kAutonomy, AttitudeLoops::kFirmware}) {
      ControllerConfig c = plain();
      c.attitude_loops = loops;
      Bench bench(c);
      const auto out = bench.step(static_cast<ControlMode>(mode), {0.0, 0.0, 0.0, 0.5});
      const int* expected =
          loops == AttitudeLoops::kAutonomy ? with_own_loops : with_firmware_loops;
      EXPECT_EQ(static_cast<int>(out.command.mode), expected[mode]) << mode;
      EXPECT_EQ(out.command.ignore, 0);
      for (const std::size_t unused : {0U, 1U, 6U, 7U, 8U, 9U})
        EXPECT_EQ(out.command.u[unused], 0.0F);
    }
  }
}

TEST(Controller, HoverThrottleIsThatOfTheVehicle) {
  Bench bench;
  const auto out = bench.step(ControlMode::kNposEposDposYaw, {0, 0, 0, 0});
  EXPECT_NEAR(out.thrust_N, kWeight, 1e-9);
  EXPECT_NEAR(u(out, 2), 0.479918 / 0.7, 2e-6);  // motor output of hover over RC_MAX_THR
}

TEST(Controller, PositionChainByHand) {
  Bench bench;
  bench.state.v_W = {0.2, 0.0, 0.1};
  bench.state.q_WB = attitude(0, 0, kPi / 2.0);
  const auto out = bench.step(ControlMode::kNposEposDposYaw, {0.5, 1.0, 0.4, kPi / 2.0 + 0.1});
  // velocities 0.5, 1.0, 0.48; accelerations 2.2*0.3, 2.2*1.0, 3*(0.38); nose east: forward is
  // east, right south
  const double forward = 2.2;
  const double right = -2.2 * 0.3;
  const double lift = 9.81 - 3.0 * 0.38;
  const double s = std::sqrt(forward * forward + right * right + lift * lift);
  EXPECT_NEAR(u(out, 3), std::asin(right / s), kFloat);
  EXPECT_NEAR(u(out, 4), -std::asin(forward / (s * std::cos(std::asin(right / s)))), kFloat);
  EXPECT_NEAR(u(out, 5), 2.0 * 0.1, kFloat);
  EXPECT_NEAR(out.thrust_N, 3.5 * lift, 1e-9);
}

TEST(Controller, VelocityModesPassTheYawRate) {
  Bench bench;
  EXPECT_NEAR(u(bench.step(ControlMode::kNvelEvelDposYawrate, {0, 0, 0, 0.3}), 5), 0.3, kFloat);
  EXPECT_NEAR(u(bench.step(ControlMode::kNvelEvelDvelYawrate, {0, 0, 0, -0.3}), 5), -0.3, kFloat);
  const auto climb = bench.step(ControlMode::kNposEposDvelYaw, {0, 0, -0.5, 0});
  EXPECT_NEAR(climb.thrust_N, 3.5 * (9.81 + 3.0 * 0.5), 1e-9);
  EXPECT_NEAR(bench.step(ControlMode::kNvelEvelDposYawrate, {0, 0, -0.5, 0}).thrust_N,
              3.5 * (9.81 + 3.0 * 1.2 * 0.5), 1e-9);
}

// Weak point 41: pitch lacked the 1/cos(roll), so a diagonal acceleration came out too small.
TEST(Controller, AccelerationModeIsInvertedExactly) {
  Bench bench;
  const double g = 9.81;
  const std::array<double, 4> cmd{0.3, -0.35, 0.1, 0.0};  // forward, right, down in g
  const auto out = bench.step(ControlMode::kFaccRaccDaccYawrate, cmd);
  const double roll = u(out, 3);
  const double pitch = u(out, 4);
  const Vector3 up = attitude(roll, pitch, 0.0) * Vector3(0, 0, -1);
  const Vector3 a = up * ((g - g * cmd[2]) / -up.z()) + Vector3(0, 0, g);
  EXPECT_LT((a - g * Vector3(cmd[0], cmd[1], cmd[2])).norm(), 1e-5);
}

// Weak point 41: thrust was divided by cos(roll) cos(pitch) without a guard.
TEST(Controller, TiltCompensationIsBounded) {
  Bench bench;
  bench.state.q_WB = attitude(0.3, 0.2, 0.0);
  EXPECT_NEAR(bench.step(ControlMode::kFaccRaccDaccYawrate, {0, 0, 0, 0}).thrust_N,
              kWeight / (std::cos(0.3) * std::cos(0.2)), 1e-9);
  for (const double roll : {1.5, kPi / 2.0, 2.5, kPi}) {
    bench.state.q_WB = attitude(roll, 0.0, 0.0);
    const auto out = bench.step(ControlMode::kFaccRaccDaccYawrate, {0, 0, 0, 0});
    EXPECT_NEAR(out.thrust_N, kWeight / std::cos(30.0 * kRadPerDeg), 1e-9) << roll;
  }
}

// Weak point 33: degrees were used as radians, so nothing was limited.
TEST(Controller, LimitsAreInRadians) {
  ControllerConfig c = plain();
  c.max_tilt_rad = 25.0 * kRadPerDeg;
  c.max_yaw_rate_rad_s = 60.0 * kRadPerDeg;
  c.max_roll_pitch_rate_rad_s = 60.0 * kRadPerDeg;
  Bench bench(c);
  for (const double sign : {1.0, -1.0}) {
    const auto angles =
        bench.step(ControlMode::kRollPitchYawrateThrottle, {sign * 5, sign * 5, sign * 9, 0.5});
    EXPECT_NEAR(u(angles, 3), sign * 0.436332, kFloat);
    EXPECT_NEAR(u(angles, 4), sign * 0.436332, kFloat);
    EXPECT_NEAR(u(angles, 5), sign * 1.047198, kFloat);
    const auto rates = bench.step(ControlMode::kRollratePitchrateYawrateThrottle,
                                  {sign * 5, sign * 5, sign * 9, 0.5});
    for (const std::size_t k : {3U, 4U, 5U}) EXPECT_NEAR(u(rates, k), sign * 1.047198, kFloat);
    const auto yaw = bench.step(ControlMode::kRollPitchYawThrottle, {0, 0, sign * 3.0, 0.5});
    EXPECT_NEAR(u(yaw, 5), sign * 1.047198, kFloat);
  }
  const auto lean = bench.step(ControlMode::kFaccRaccDaccYawrate, {5.0, 5.0, 0.0, 0.0});
  EXPECT_NEAR(std::cos(u(lean, 3)) * std::cos(u(lean, 4)), std::cos(c.max_tilt_rad), kFloat);
}

// Weak point 42: thrust limits hung on the equilibrium throttle and forbade less than 21 N.
TEST(Controller, WrenchGoesThroughUpToTheVehiclesLimits) {
  Bench bench;
  const auto light = bench.step(ControlMode::kPassThroughToMixer, {0.1, -0.2, 0.05, 8.0});
  EXPECT_NEAR(u(light, 2), -8.0, kFloat);
  EXPECT_NEAR(u(light, 3), 0.1, kFloat);
  EXPECT_NEAR(u(light, 4), -0.2, kFloat);
  EXPECT_NEAR(u(light, 5), 0.05, kFloat);
  const auto heavy = bench.step(ControlMode::kPassThroughToMixer, {99, -99, 99, 999});
  EXPECT_NEAR(u(heavy, 2), -65.0, kFloat);
  EXPECT_NEAR(u(heavy, 3), 10.0, kFloat);
  EXPECT_NEAR(u(heavy, 4), -10.0, kFloat);
  EXPECT_NEAR(u(heavy, 5), 2.0, kFloat);
  EXPECT_EQ(u(bench.step(ControlMode::kPassThroughToMixer, {0, 0, 0, -5}), 2), 0.0);
}

TEST(Controller, ThrottleModesClipToTheirOwnLimits) {
  ControllerConfig c = plain();
  c.min_throttle = 0.1;
  c.max_throttle = 0.8;
  Bench bench(c);
  EXPECT_NEAR(u(bench.step(ControlMode::kRollPitchYawrateThrottle, {0, 0, 0, 0.0}), 2), 0.1,
              kFloat);
  EXPECT_NEAR(u(bench.step(ControlMode::kRollPitchYawrateThrottle, {0, 0, 0, 0.95}), 2), 0.8,
              kFloat);
  EXPECT_NEAR(u(bench.step(ControlMode::kRollratePitchrateYawrateThrottle, {0, 0, 0, 0.4}), 2), 0.4,
              kFloat);
}

// Weak point 43: yaw was not wrapped in modes 5 and 9.
TEST(Controller, YawErrorsAreWrapped) {
  ControllerConfig c = plain();
  c.attitude_loops = AttitudeLoops::kAutonomy;
  Bench bench(c);
  bench.state.q_WB = attitude(0, 0, 3.1);
  const double error = 2.0 * kPi - 6.2;
  EXPECT_NEAR(u(bench.step(ControlMode::kRollPitchYawThrottle, {0, 0, -3.1, 0.5}), 5), 2.0 * error,
              kFloat);
  EXPECT_NEAR(u(bench.step(ControlMode::kRollPitchYawThrust, {0, 0, -3.1, kWeight}), 5),
              2.0 * error, kFloat);
  EXPECT_NEAR(u(bench.step(ControlMode::kNposEposDposYaw, {0, 0, 0, -3.1}), 5), 2.0 * error,
              kFloat);
}

TEST(Controller, TorqueLoopsByHand) {
  ControllerConfig c = plain();
  c.attitude_loops = AttitudeLoops::kAutonomy;
  Bench bench(c);
  bench.state.q_WB = attitude(0.1, -0.05, 0.0);
  bench.state.w_B = {0.2, -0.1, 0.3};
  const auto angles = bench.step(ControlMode::kRollPitchYawThrust, {0.2, 0.1, 0.05, 30.0});
  EXPECT_NEAR(u(angles, 2), -30.0, kFloat);
  EXPECT_NEAR(u(angles, 3), 5.0 * 0.1 - 0.8 * 0.2, kFloat);
  EXPECT_NEAR(u(angles, 4), 5.0 * 0.15 + 0.8 * 0.1, kFloat);
  EXPECT_NEAR(u(angles, 5), 2.0 * 0.05 - 1.0 * 0.3, kFloat);
  const auto yaw_rate = bench.step(ControlMode::kRollPitchYawrateThrust, {0.1, -0.05, 0.5, 30.0});
  EXPECT_NEAR(u(yaw_rate, 5), 0.5 * 0.2, kFloat);
  const auto rates =
      bench.step(ControlMode::kRollratePitchrateYawrateThrust, {0.4, 0.1, -0.1, 30.0});
  EXPECT_NEAR(u(rates, 3), 0.5 * 0.2, kFloat);
  EXPECT_NEAR(u(rates, 4), 0.5 * 0.2, kFloat);
  EXPECT_NEAR(u(rates, 5), -0.5 * 0.4, kFloat);
}

TEST(Controller, FirmwareLoopsTakeThrustAsThrottle) {
  Bench bench;
  const auto out = bench.step(ControlMode::kRollPitchYawrateThrust, {0.2, -0.1, 0.3, kWeight});
  EXPECT_EQ(out.command.mode, FirmwareMode::kRollPitchYawrateThrottle);
  EXPECT_NEAR(u(out, 2), 0.479918 / 0.7, 2e-6);
  EXPECT_NEAR(u(out, 3), 0.2, kFloat);
  EXPECT_NEAR(u(out, 4), -0.1, kFloat);
  EXPECT_NEAR(u(out, 5), 0.3, kFloat);
}

// Weak point 36: near the height of the origin all attitude control was cut, in modes 9 to 11 to
// zero torque.
TEST(Controller, HeightAloneCutsNothing) {
  Bench bench;
  bench.state.p_W.z() = 0.0;
  EXPECT_NEAR(u(bench.step(ControlMode::kRollPitchYawrateThrottle, {0.2, 0.1, 0.3, 0.5}), 3), 0.2,
              kFloat);
}

TEST(Controller, OnTheGroundItKeepsLevelWithLiveTorqueLoops) {
  ControllerConfig c = plain();
  c.attitude_loops = AttitudeLoops::kAutonomy;
  Bench bench(c);
  bench.on_ground = true;
  const auto angles = bench.step(ControlMode::kNposEposDvelYaw, {3, 3, -1, 2});
  for (const std::size_t k : {3U, 4U, 5U}) EXPECT_EQ(u(angles, k), 0.0);
  EXPECT_GT(angles.thrust_N, kWeight);
  bench.state.w_B = {0.5, 0, 0};
  const auto torque = bench.step(ControlMode::kRollPitchYawrateThrust, {0.4, 0.4, 0.4, 20.0});
  EXPECT_NEAR(u(torque, 3), -0.8 * 0.5, kFloat);
  EXPECT_NEAR(u(torque, 4), 0.0, kFloat);
}

// Weak point 39: integrals ran under the pilot's override.
TEST(Controller, PilotClearsAndStopsTheIntegralsOfHisAxes) {
  ControllerConfig c;
  c.heading_to_rate.ki = 0.5;
  Bench bench(c);
  const std::array<double, 4> away{0.3, 0.3, 0.3, 0.3};
  for (int k = 0; k < 100; ++k) bench.step(ControlMode::kNposEposDposYaw, away);
  ASSERT_GT(bench.controller.trim_W().x(), 0.01);
  ASSERT_GT(bench.controller.trim_W().z(), 0.01);
  bench.pilot = PilotOverride::from_word(0x22);  // throttle
  for (int k = 0; k < 10; ++k) bench.step(ControlMode::kNposEposDposYaw, away);
  EXPECT_EQ(bench.controller.trim_W().z(), 0.0);
  EXPECT_GT(bench.controller.trim_W().x(), 0.01);
  bench.pilot = PilotOverride::from_word(0x1DD);  // everything of the attitude
  const auto under = bench.step(ControlMode::kNposEposDposYaw, away);
  EXPECT_EQ(bench.controller.trim_W().x(), 0.0);
  EXPECT_EQ(bench.controller.trim_W().y(), 0.0);
  EXPECT_NEAR(u(under, 5), 2.0 * 0.3, kFloat);  // the heading integral is gone as well
}

// Weak point 39: a change of mode did not reset the loops it started.
TEST(Controller, ModeChangeRestartsNewLoopsAndKeepsTheCommonOnes) {
  ControllerConfig c;
  c.position_horizontal.kd = 0.5;
  c.heading_to_rate.ki = 0.5;
  Bench bench(c);
  for (int k = 0; k < 100; ++k) bench.step(ControlMode::kNposEposDposYaw, {0.1, 0, 0.1, 0.2});
  const Vector3 trim = bench.controller.trim_W();
  ASSERT_GT(trim.z(), 0.0);
  bench.step(ControlMode::kNposEposDvelYaw, {0.1, 0, 0.0, 0.2});
  EXPECT_NEAR(bench.controller.trim_W().z(), trim.z(), 0.02);  // velocity loops are common
  bench.step(ControlMode::kRollPitchYawrateThrottle, {0, 0, 0, 0.5});
  bench.state.p_W = {50, 0, 0};  // far away meanwhile: the old x_prev would kick
  const auto back = bench.step(ControlMode::kNposEposDposYaw, {50, 0, 0, 0.0});
  EXPECT_NEAR(u(back, 5), 0.0, kFloat);                        // heading integral forgotten
  EXPECT_NEAR(u(back, 4), std::atan2(-trim.x(), 9.81), 0.02);  // wind trim kept, no derivative kick
}

TEST(Controller, HandOverSetsTheTrimOfNewLoops) {
  Bench bench{ControllerConfig{}};
  bench.step(ControlMode::kRollPitchYawrateThrust, {0, 0, 0, 30});
  bench.controller.enter(ControlMode::kNposEposDposYaw, {0.4, -0.2, 0.1});
  const auto out = bench.step(ControlMode::kNposEposDposYaw, {0, 0, 0, 0});
  EXPECT_NEAR(out.thrust_N, 3.5 * (9.81 - 0.1), 1e-9);
  EXPECT_TRUE(bench.controller.trim_W().isApprox(Vector3(0.4, -0.2, 0.1)));
}

TEST(Controller, LimitedLoopsDoNotWindUp) {
  Bench bench{ControllerConfig{}};
  for (int k = 0; k < 2000; ++k) bench.step(ControlMode::kNvelEvelDvelYawrate, {50, 50, 0, 0});
  // one step passes before the limit is known: 0.8 * 50 m/s * 0.01 s on both axes
  EXPECT_LT(bench.controller.trim_W().norm(), 0.4 * std::sqrt(2.0) + 1e-9);
}

TEST(Controller, GainChangeKeepsTheTrim) {
  ControllerConfig c;
  Bench bench(c);
  for (int k = 0; k < 100; ++k) bench.step(ControlMode::kNposEposDposYaw, {0, 0, 0.1, 0});
  const double trim = bench.controller.trim_W().z();
  c.velocity_vertical = {4.0, 2.0, 0.0};
  bench.controller.configure(c, thrust_model());
  EXPECT_EQ(bench.controller.trim_W().z(), trim);
}

TEST(Controller, SpeedsAreLimited) {
  Bench bench;
  const auto far = bench.step(ControlMode::kNposEposDposYaw, {300, 400, -1000, 0});
  // 5 m/s towards 3-4, times 2.2 1/s, then tilt; climb 2 m/s times 3 1/s
  EXPECT_NEAR(far.thrust_N, 3.5 * (9.81 + 6.0), 1e-9);
  // v1 force: f_x/f_y = -sin(pitch)/tan(roll): north 3, east 4
  EXPECT_NEAR(-std::sin(far.pitch_rad) / std::tan(far.roll_rad), 3.0 / 4.0, 1e-9);
  const auto down = bench.step(ControlMode::kNvelEvelDvelYawrate, {0, 0, 50, 0});
  EXPECT_NEAR(down.thrust_N, 3.5 * (9.81 - 3.0 * 1.5), 1e-9);
}

// Weak point 31: a repeated stamp must not change the output.
TEST(Controller, RepeatedTimeRepeatsTheOutput) {
  Bench bench;
  const auto first = bench.step(ControlMode::kNposEposDposYaw, {1, 1, 0, 1});
  const auto again = bench.step(ControlMode::kNposEposDposYaw, {9, 9, 9, 9}, 0.0);
  EXPECT_EQ(first.command.u, again.command.u);
}

TEST(PilotOverride, ReadsTheWordAsTheFirmwareCombinesEntries) {
  // ROSflight 2.x: entries 0-2 pilot if 0x222, 3 if 0x045, 4 if 0x089, 5 if 0x111.
  for (unsigned word = 0; word < 0x400; ++word) {
    const PilotOverride p = PilotOverride::from_word(static_cast<std::uint16_t>(word));
    EXPECT_EQ(p.throttle, (word & 0x222U) != 0);
    EXPECT_EQ(p.roll_pitch, (word & 0x045U) != 0 || (word & 0x089U) != 0);
    EXPECT_EQ(p.yaw, (word & 0x111U) != 0);
  }
}

TEST(Controller, EastHasGainsOfItsOwnWhereTheyAreGiven) {
  ControllerConfig c = plain();
  c.position_horizontal = {1.0, 0.0, 0.0};
  c.velocity_horizontal = {0.5, 0.0, 0.0};
  Bench same(c);
  c.position_east = PidGains{0.5, 0.0, 0.0};
  c.velocity_east = PidGains{0.25, 0.0, 0.0};
  Bench other(c);
  const auto roll = [](Bench& bench) {
    return bench.step(ControlMode::kNposEposDposYaw, {0.0, 1.0, 0.0, 0.0}).roll_rad;
  };
  // 1 m east: a_e = kp_v kp_p m/s^2, roll = asin(a_e/|f|).
  EXPECT_NEAR(roll(same), std::asin(0.5 / std::hypot(0.5, 9.81)), 1e-9);
  EXPECT_NEAR(roll(other), std::asin(0.125 / std::hypot(0.125, 9.81)), 1e-9);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
