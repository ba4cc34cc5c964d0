// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/controller.hpp"

#include <gtest/gtest.h>

#include <random>

#include "autonomy/quadplane/test/plant.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using testing::config;
using testing::Plant;

constexpr double kDt_s = 0.01;
constexpr double kWeight = 6.0 * 9.80665;  // [N]

/// What holds a velocity in the end, on the plant.
struct Steady {
  Plant plant;
  Controller controller{config()};
  Controller::Output out;

  void hold(const Vector3& v_W, double duration_s, double heading_rad = 0.0) {
    for (double t = 0.0; t < duration_s; t += kDt_s) {
      out = controller.step(plant.state, {.v_W = v_W, .heading_rad = heading_rad}, kDt_s);
      plant.step(out.command, kDt_s);
    }
  }
};

Steady in_the_air() {
  Steady s;
  s.plant.state.p_W.z() = -100.0;
  return s;
}

TEST(Controller, HoversOnTheRotorsAlone) {
  Steady s = in_the_air();
  s.hold(Vector3::Zero(), 5.0);
  EXPECT_NEAR(s.out.lift_force_N, kWeight, 0.1);
  EXPECT_LT(s.out.command.u[0], 0.1F);
  EXPECT_NEAR(s.plant.state.p_W.z(), -100.0, 0.1);
}

/// Lift equation: at airspeed V in level flight the wing carries at most (V/V_s)^2 of the weight, so the rotors carry at
/// least 1 - (V/V_s)^2, and nothing from 1.2 V_s on. 3 % for the attitude and the drag of the plant.
class Corridor : public ::testing::TestWithParam<double> {};

TEST_P(Corridor, RotorsCarryWhatTheWingCannot) {
  const double speed = GetParam();
  Steady s = in_the_air();
  for (double v = 0.0; v < speed; v += 0.1) s.hold({v, 0.0, 0.0}, 0.1);
  s.hold({speed, 0.0, 0.0}, 10.0);
  const double of_stall = speed / config().vehicle.stall_speed_m_s();
  const double by_rotors = -static_cast<double>(s.out.command.u[2]) / kWeight;
  EXPECT_NEAR(s.plant.state.v_W.x(), speed, 0.2);
  EXPECT_NEAR(s.plant.state.p_W.z(), -100.0, 2.0);
  EXPECT_NEAR(s.plant.state.v_W.z(), 0.0, 0.1);
  EXPECT_GT(by_rotors, 1.0 - of_stall * of_stall - 0.03);
  EXPECT_LT(by_rotors, 1.03);
  if (of_stall > 1.2) {
    EXPECT_EQ(s.out.lift_force_N, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(At, Corridor,
                         ::testing::Values(0.0, 3.0, 6.0, 8.0, 10.0, 12.0, 14.0, 15.5, 17.0, 18.0),
                         [](const auto& instance) {
                           return std::to_string(static_cast<int>(10.0 * instance.param)) + "dm_s";
                         });

/// Through the whole transition the height is held: nothing is switched.
TEST(Controller, KeepsItsHeightFromHoverToCruiseAndBack) {
  Steady s = in_the_air();
  double lowest = 0.0;
  double highest = 0.0;
  const auto fly = [&](double v) {
    s.hold({v, 0.0, std::clamp(-100.0 - s.plant.state.p_W.z(), -3.0, 3.0)}, 0.1);
    lowest = std::max(lowest, s.plant.state.p_W.z() + 100.0);
    highest = std::min(highest, s.plant.state.p_W.z() + 100.0);
  };
  for (double v = 0.0; v < 17.0; v += 0.2) fly(v);
  for (double v = 17.0; v > 0.0; v -= 0.12) fly(v);
  EXPECT_LT(lowest, 1.0);
  EXPECT_GT(highest, -1.5);
}

TEST(Controller, LiftRunsWithoutAStepThroughTheTransition) {
  Steady s = in_the_air();
  s.hold(Vector3::Zero(), 3.0);
  float before = s.out.command.u[2];
  float largest = 0.0F;
  for (double v = 0.0; v < 17.0; v += 0.02) {
    s.hold({v, 0.0, 0.0}, 0.01);
    largest = std::max(largest, std::abs(s.out.command.u[2] - before));
    before = s.out.command.u[2];
  }
  EXPECT_LT(largest, 0.05 * kWeight);
}

/// A wing that lifts a third of what its file says, as one whose flow has separated: the rotors carry the rest, at a speed at
/// which they would stand still.
TEST(Controller, CarriesAWingThatHasStalled) {
  Steady s = in_the_air();
  for (double v = 0.0; v < 16.0; v += 0.1) s.hold({v, 0.0, 0.0}, 0.1);
  s.hold({16.0, 0.0, 0.0}, 3.0);
  ASSERT_EQ(s.out.lift_force_N, 0.0);
  const double from_m = s.plant.state.p_W.z();
  s.plant.lift_share = 1.0 / 3.0;
  s.hold({16.0, 0.0, 0.0}, 5.0);
  // Nothing commands the height here; with the rotors at rest it sinks by 72 m in these 5 s.
  EXPECT_LT(s.plant.state.p_W.z() - from_m, 8.0);
  EXPECT_NEAR(s.plant.state.v_W.z(), 0.0, 1.0);
  EXPECT_GT(s.out.lift_force_N, 0.2 * kWeight);
}

/// Whatever state and command: finite, and within the limits of rotors, pusher and surfaces.
TEST(Controller, OutputsAreFiniteAndWithinLimits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto any = [&](double size) {
    return Vector3(size * unit(random), size * unit(random), size * unit(random));
  };
  const FlightConfig c = config();
  Controller controller(c);
  for (int k = 0; k < 20000; ++k) {
    StateEstimate state;
    state.v_W = any(30.0);
    state.wind_W = any(15.0);
    state.w_B = any(6.0);
    state.a_B = any(40.0);
    state.q_WB = Quaternion(unit(random), unit(random), unit(random), unit(random)).normalized();
    Controller::Command in{
        .v_W = any(30.0), .a_ff_W = any(10.0), .heading_rad = 4.0 * unit(random)};
    in.supply = 0.5 + 0.5 * std::abs(unit(random));
    in.on_ground = unit(random) > 0.8;
    if (unit(random) > 0.9) in.lift_force_N = 60.0 * std::abs(unit(random));
    if (unit(random) > 0.99) controller.reset(state);
    const Controller::Output& out = controller.step(state, in, 0.02 * std::abs(unit(random)));
    for (const float u : out.command.u) ASSERT_TRUE(std::isfinite(u)) << k;
    ASSERT_GE(out.command.u[0], 0.0F);
    ASSERT_LE(out.command.u[0], c.vehicle.max_pusher_thrust_N);
    ASSERT_LE(out.command.u[2], 0.0F);
    ASSERT_GE(out.command.u[2], -c.vehicle.max_lift_force_N);
    for (std::size_t axis = 6; axis < 9; ++axis) ASSERT_LE(std::abs(out.command.u[axis]), 1.0F);
    // 10, 8, 3 rad/s^2, spin, the air, and the surfaces' part that the rotors do not add.
    for (std::size_t axis = 3; axis < 6; ++axis) ASSERT_LT(std::abs(out.command.u[axis]), 200.0F);
  }
}

TEST(Controller, RotorsGiveNoTorqueWhereTheyStand) {
  Steady s = in_the_air();
  for (double v = 0.0; v < 17.0; v += 0.1) s.hold({v, 0.0, 0.0}, 0.1);
  s.hold({17.0, 0.0, 0.0}, 3.0);
  ASSERT_EQ(s.out.lift_force_N, 0.0);
  for (std::size_t axis = 3; axis < 6; ++axis) EXPECT_EQ(s.out.command.u[axis], 0.0F);
}

}  // namespace
}  // namespace rosflight::autonomy::quadplane
