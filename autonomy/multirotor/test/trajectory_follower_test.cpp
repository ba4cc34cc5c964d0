// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/trajectory_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kMass = 3.5;
constexpr double kGravity = 9.81;

Quaternion attitude(double roll, double pitch, double yaw) {
  return Quaternion(Eigen::AngleAxisd(yaw, Vector3::UnitZ()) *
                    Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                    Eigen::AngleAxisd(roll, Vector3::UnitX()));
}

FollowerConfig config() {
  FollowerConfig c;
  c.max_tilt_rad = 60.0 * kRadPerDeg;
  c.max_thrust_N = 140.0;
  c.min_lift_ratio = 0.05;
  return c;
}

struct Bench {
  explicit Bench(const FollowerConfig& c = config()) : follower(c) {}
  ControllerCommand step(double dt_s = 0.01, double age_s = 0.0) {
    const AttitudeView view(state.q_WB);
    return follower.step({state, view, setpoint, age_s, dt_s, pilot});
  }
  /// Acceleration that attitude and thrust of a command produce.
  static Vector3 acceleration(const ControllerCommand& c, double psi) {
    const Vector3 up = attitude(c.cmd[0], c.cmd[1], psi) * Vector3(0, 0, -1);
    return up * (c.cmd[3] / kMass) + Vector3(0, 0, kGravity);
  }

  TrajectoryFollower follower;
  State state{};
  Trajectory setpoint{};
  PilotOverride pilot{};
};

TEST(TrajectoryFollower, HoversAtItsWeight) {
  Bench bench;
  const ControllerCommand c = bench.step();
  ASSERT_TRUE(c.valid);
  EXPECT_EQ(c.mode, ControlMode::kRollPitchYawrateThrust);
  EXPECT_NEAR(c.cmd[0], 0.0, 1e-12);
  EXPECT_NEAR(c.cmd[1], 0.0, 1e-12);
  EXPECT_NEAR(c.cmd[2], 0.0, 1e-12);
  EXPECT_NEAR(c.cmd[3], kMass * kGravity, 1e-9);
}

// Weak point 41: roll and pitch were inverted to first order only.
TEST(TrajectoryFollower, AttitudeAndThrustReproduceTheAccelerationExactly) {
  for (const double psi : {0.0, 0.7, -2.5}) {
    for (const Vector3& a :
         {Vector3(3, 0, 0), Vector3(0, -4, 1), Vector3(-5, 5, -6), Vector3(7, 2, 4)}) {
      Bench bench;
      bench.state.q_WB = attitude(0.1, -0.2, psi);
      bench.setpoint.psi_rad = psi;
      bench.setpoint.a_W = a;
      EXPECT_LT((Bench::acceleration(bench.step(), psi) - a).norm(), 1e-12);
    }
  }
}

TEST(TrajectoryFollower, LeansTowardsTheTarget) {
  Bench bench;
  bench.setpoint.p_W = {1, 0, 0};
  EXPECT_LT(bench.step().cmd[1], -0.1);  // north: nose down
  bench.setpoint.p_W = {0, 1, 0};
  EXPECT_GT(bench.step().cmd[0], 0.1);  // east: right side down
  bench.setpoint.p_W = {0, 0, -1};
  EXPECT_GT(bench.step().cmd[3], kMass * kGravity);
  bench.state.q_WB = attitude(0, 0, kPi / 2.0);  // nose east
  bench.setpoint.p_W = {0, 1, 0};
  bench.setpoint.psi_rad = kPi / 2.0;
  EXPECT_LT(bench.step().cmd[1], -0.1);
}

// Weak point 29: the commanded velocity was not used, so the vehicle trailed by kd v/kp.
TEST(TrajectoryFollower, FollowsConstantSpeedWithoutLag) {
  FollowerConfig c = config();
  c.horizontal.ki = 0.0;  // the integral must not hide it
  Bench bench(c);
  const double dt_s = 0.005;
  Vector3 p = Vector3::Zero();
  Vector3 v = Vector3::Zero();
  for (int k = 0; k < 6000; ++k) {
    bench.setpoint.p_W = Vector3(3.0 * k * dt_s, 0, 0);
    bench.setpoint.v_W = {3, 0, 0};
    bench.state.p_W = p;
    bench.state.v_W = v;
    const Vector3 a = Bench::acceleration(bench.step(dt_s), 0.0);
    p += v * dt_s;
    v += a * dt_s;
  }
  // Explicit Euler trails the sampled setpoint by the distance of one step; ROSflight 2.x trails by
  // 2.7 m.
  EXPECT_LT((bench.setpoint.p_W - p).norm(), 1.01 * 3.0 * dt_s);
}

TEST(TrajectoryFollower, FeedsTheDragForward) {
  FollowerConfig c = config();
  c.drag_1_s = 0.5;
  Bench bench(c);
  bench.setpoint.v_W = bench.state.v_W = {4, -2, 1};
  const Vector3 a = Bench::acceleration(bench.step(), 0.0);
  EXPECT_LT((a - Vector3(2, -1, 0)).norm(), 1e-12);
}

TEST(TrajectoryFollower, LeadsByTheLagOfTheLoopsBelow) {
  FollowerConfig c = config();
  c.attitude_lag_s = 0.2;
  c.thrust_lag_s = 0.1;
  c.drag_1_s = 0.5;
  Bench bench(c);
  bench.setpoint.a_W = {1, -2, 0.5};
  bench.setpoint.j_W = {3, 1, -2};
  // lateral a + 0.2 (j + 0.5 a), down a + 0.1 j
  const Vector3 a = Bench::acceleration(bench.step(), 0.0);
  EXPECT_LT((a - Vector3(1.0 + 0.6 + 0.1, -2.0 + 0.2 - 0.2, 0.5 - 0.2)).norm(), 1e-12);
}

TEST(TrajectoryFollower, LeadHalvesTheErrorBehindASlowAttitude) {
  // A quintic of 20 m in 5 s, flown through a first-order lag of 0.2 s between command and
  // acceleration.
  const auto worst_error = [](double lag_s) {
    FollowerConfig c = config();
    c.attitude_lag_s = lag_s;
    Bench bench(c);
    const double dt_s = 0.005;
    Vector3 p = Vector3::Zero();
    Vector3 v = Vector3::Zero();
    Vector3 a = Vector3::Zero();
    double worst = 0.0;
    for (int k = 0; k < 1000; ++k) {
      const double s = k * dt_s / 5.0;
      bench.setpoint.p_W.x() = 20.0 * s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
      bench.setpoint.v_W.x() = 20.0 / 5.0 * s * s * (30.0 + s * (-60.0 + 30.0 * s));
      bench.setpoint.a_W.x() = 20.0 / 25.0 * s * (60.0 + s * (-180.0 + 120.0 * s));
      bench.setpoint.j_W.x() = 20.0 / 125.0 * (60.0 + s * (-360.0 + 360.0 * s));
      bench.state.p_W = p;
      bench.state.v_W = v;
      worst = std::max(worst, (bench.setpoint.p_W - p).norm());
      a += (Bench::acceleration(bench.step(dt_s), 0.0) - a) * (dt_s / 0.2);
      p += v * dt_s;
      v += a * dt_s;
    }
    return worst;
  };
  EXPECT_LT(worst_error(0.2), 0.5 * worst_error(0.0));
}

TEST(TrajectoryFollower, YawRateKeepsTheHeadingRateInATurn) {
  // While the heading turns at psi_dot under a force fixed in W, the body rates of the flat
  // trajectory are those of the rotation from one commanded attitude to the next.
  const double psi = 0.4;
  const double psi_dot = 0.8;
  const double h = 1e-6;
  FollowerConfig c = config();
  c.heading.kp = 0.0;
  const auto command = [&](double at_psi) {
    Bench bench(c);
    bench.state.q_WB = attitude(0, 0, at_psi);
    bench.setpoint.psi_rad = at_psi;
    bench.setpoint.psi_dot_rad_s = psi_dot;
    bench.setpoint.a_W = {4, -3, 1};
    return bench.step();
  };
  const ControllerCommand now = command(psi);
  const ControllerCommand later = command(psi + psi_dot * h);
  const Quaternion q0 = attitude(now.cmd[0], now.cmd[1], psi);
  const Quaternion q1 = attitude(later.cmd[0], later.cmd[1], psi + psi_dot * h);
  const double yaw_rate = 2.0 * (q0.conjugate() * q1).z() / h;
  EXPECT_NEAR(now.cmd[2], yaw_rate, 1e-5);
  EXPECT_GT(std::abs(now.cmd[2] - psi_dot), 0.05);  // and it is not simply the heading rate
}

TEST(TrajectoryFollower, TurnsTheShortWay) {
  Bench bench;
  bench.state.q_WB = attitude(0, 0, 3.0);
  bench.setpoint.psi_rad = -3.0;
  EXPECT_NEAR(bench.step().cmd[2], 2.0 * (2.0 * kPi - 6.0), 1e-9);
}

// Weak point 30: the yaw rate was not limited here.
TEST(TrajectoryFollower, LimitsTheYawRate) {
  FollowerConfig c = config();
  c.heading.kp = 100.0;
  Bench bench(c);
  bench.setpoint.psi_rad = 2.0;
  bench.setpoint.psi_dot_rad_s = 50.0;
  EXPECT_NEAR(bench.step().cmd[2], c.max_yaw_rate_rad_s, 1e-12);
  bench.setpoint.psi_rad = -2.0;
  bench.setpoint.psi_dot_rad_s = -50.0;
  EXPECT_NEAR(bench.step().cmd[2], -c.max_yaw_rate_rad_s, 1e-12);
}

// Weak point 30: neither the clear service nor the pilot cleared the yaw integral.
TEST(TrajectoryFollower, ClearsAllIntegralsByCallAndByPilotAxis) {
  FollowerConfig c = config();
  c.heading.ki = 0.5;
  const auto wound_up = [&] {
    Bench bench(c);
    bench.setpoint.p_W = {0.2, -0.2, 0.2};
    bench.setpoint.psi_rad = 0.2;
    for (int k = 0; k < 100; ++k) bench.step();
    return bench;
  };
  Bench called = wound_up();
  ASSERT_GT(std::abs(called.follower.heading_integral()), 0.01);
  called.follower.clear_integrators();
  EXPECT_TRUE(called.follower.trim_W().isZero(0.0));
  EXPECT_EQ(called.follower.heading_integral(), 0.0);

  Bench lateral = wound_up();
  lateral.pilot = PilotOverride::from_word(0x01);  // attitude switch: roll, pitch and yaw
  lateral.step();
  EXPECT_EQ(lateral.follower.trim_W().x(), 0.0);
  EXPECT_EQ(lateral.follower.trim_W().y(), 0.0);
  EXPECT_GT(std::abs(lateral.follower.trim_W().z()), 0.01);
  EXPECT_EQ(lateral.follower.heading_integral(), 0.0);

  Bench stick = wound_up();
  stick.pilot = PilotOverride::from_word(0x10);  // yaw stick only
  stick.step();
  EXPECT_GT(std::abs(stick.follower.trim_W().x()), 0.01);
  EXPECT_EQ(stick.follower.heading_integral(), 0.0);

  Bench throttle = wound_up();
  throttle.pilot = PilotOverride::from_word(0x20);
  throttle.step();
  EXPECT_EQ(throttle.follower.trim_W().z(), 0.0);
  EXPECT_GT(std::abs(throttle.follower.trim_W().x()), 0.01);
}

// Weak point 31: a repeated state stamp made the command invalid.
TEST(TrajectoryFollower, RepeatedTimeRepeatsTheCommand) {
  Bench bench;
  bench.setpoint.p_W = {1, 0, 0};
  const ControllerCommand c = bench.step();
  const ControllerCommand again = bench.step(0.0);
  EXPECT_TRUE(again.valid);
  EXPECT_EQ(again.cmd, c.cmd);
}

// Weak point 32: there was no limit on lateral acceleration.
TEST(TrajectoryFollower, LimitsTheTilt) {
  FollowerConfig c = config();
  c.max_tilt_rad = 20.0 * kRadPerDeg;
  c.max_position_error_m = 100.0;
  Bench bench(c);
  bench.setpoint.p_W = {60, -80, 0};
  const ControllerCommand command = bench.step();
  EXPECT_NEAR(std::cos(command.cmd[0]) * std::cos(command.cmd[1]), std::cos(20.0 * kRadPerDeg),
              1e-9);
  const Vector3 a = Bench::acceleration(command, 0.0);
  EXPECT_NEAR(a.y() / a.x(), -80.0 / 60.0, 1e-9);  // still towards the target
  EXPECT_NEAR(a.z(), 0.0, 1e-9);                   // and lift keeps its place
}

TEST(TrajectoryFollower, LimitsThrustLiftFirst) {
  FollowerConfig c = config();
  c.max_thrust_N = 50.0;
  Bench bench(c);
  bench.setpoint.a_W = {30, 0, -3};
  const ControllerCommand command = bench.step();
  EXPECT_NEAR(command.cmd[3], 50.0, 1e-9);
  EXPECT_NEAR(Bench::acceleration(command, 0.0).z(), -3.0, 1e-9);
  bench.setpoint.a_W = {0, 0, -500};
  EXPECT_NEAR(bench.step().cmd[3], 50.0, 1e-9);
}

TEST(TrajectoryFollower, KeepsSomeLiftWhenSentDown) {
  FollowerConfig c = config();
  c.min_lift_ratio = 0.4;
  Bench bench(c);
  bench.setpoint.p_W = {0, 0, 1000};
  const ControllerCommand command = bench.step();
  EXPECT_NEAR(command.cmd[3], 0.4 * kMass * kGravity, 1e-9);
}

TEST(TrajectoryFollower, FarTargetsCountAsTheWindow) {
  FollowerConfig c = config();
  c.horizontal.ki = 0.0;
  Bench near(c);
  Bench far(c);
  near.setpoint.p_W = {3, 0, 0};
  far.setpoint.p_W = {3000, 0, 0};
  EXPECT_NEAR(near.step().cmd[1], far.step().cmd[1], 1e-12);
}

TEST(TrajectoryFollower, LimitedAxesDoNotWindUp) {
  Bench bench;
  bench.setpoint.p_W = {500, 0, 0};
  for (int k = 0; k < 2000; ++k) bench.step();
  EXPECT_NEAR(bench.follower.trim_W().x(), 0.0, 0.05);
}

// Weak point 32: there was no timeout on trajectory commands.
TEST(TrajectoryFollower, OldSetpointIsNotFollowed) {
  Bench bench;
  EXPECT_TRUE(bench.step(0.01, 0.49).valid);
  EXPECT_FALSE(bench.step(0.01, 0.51).valid);
}

TEST(TrajectoryFollower, BadNumbersAreNotFollowed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Bench bench;
  bench.setpoint.p_W.x() = nan;
  EXPECT_FALSE(bench.step().valid);
  bench.setpoint.p_W.x() = 0.0;
  bench.state.v_W.z() = kInfinity;
  EXPECT_FALSE(bench.step().valid);
  bench.state.v_W.z() = 0.0;
  const ControllerCommand c = bench.step();
  EXPECT_TRUE(c.valid);
  EXPECT_NEAR(c.cmd[3], kMass * kGravity, 1e-9);
}

TEST(TrajectoryFollower, TakesOverATrim) {
  Bench bench;
  bench.follower.restart({0.5, -0.3, 0.2});
  const Vector3 a = Bench::acceleration(bench.step(), 0.0);
  EXPECT_LT((a - Vector3(0.5, -0.3, 0.2)).norm(), 1e-12);
}

TEST(AttitudeView, MatchesTheRotationMatrix) {
  const Quaternion q = attitude(0.3, -0.4, 2.1);
  const AttitudeView view(q);
  EXPECT_NEAR(view.psi_rad, 2.1, 1e-12);
  EXPECT_NEAR(view.sin_psi, std::sin(2.1), 1e-12);
  EXPECT_NEAR(view.cos_psi, std::cos(2.1), 1e-12);
  EXPECT_NEAR(view.cos_tilt, std::cos(0.3) * std::cos(-0.4), 1e-12);
  EXPECT_NEAR(RollPitch::of(q).roll_rad, 0.3, 1e-12);
  EXPECT_NEAR(RollPitch::of(q).pitch_rad, -0.4, 1e-12);
  const AttitudeView up(attitude(0.0, kPi / 2.0, 0.0));
  EXPECT_TRUE(std::isfinite(up.psi_rad + up.sin_psi + up.cos_psi));
}

TEST(TrajectoryFollower, NewGainsActAtOnceAndKeepTheIntegrals) {
  Bench bench;
  bench.setpoint.p_W = {0.5, 0.5, 0.0};
  for (int k = 0; k < 100; ++k) bench.step();
  const Vector3 trim = bench.follower.trim_W();
  ASSERT_GT(trim.x(), 0.1);
  FollowerConfig harder = config();
  harder.east = harder.horizontal;
  harder.east->kp *= 3.0;
  bench.follower.configure(harder);
  const double north = Bench::acceleration(bench.step(1e-6), 0.0).x();
  const double east = Bench::acceleration(bench.step(1e-6), 0.0).y();
  const double kp = config().horizontal.kp;
  EXPECT_NEAR(north, kp * 0.5 + trim.x(), 1e-4);
  EXPECT_NEAR(east, 3.0 * kp * 0.5 + trim.y(), 1e-4);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
