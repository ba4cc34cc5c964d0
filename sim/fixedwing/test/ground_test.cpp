// SPDX-License-Identifier: BSD-3-Clause
// From the ground and back: take-off roll, hand launch, landing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "sim/fixedwing/test/hangar.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

double roll_of(const BodyState& body) {
  const Matrix3 R = body.q_WB.toRotationMatrix();
  return std::atan2(R(2, 1), R(2, 2));
}
double pitch_of(const BodyState& body) {
  return std::asin(-body.q_WB.toRotationMatrix()(2, 0));
}
double sink_m_s(const BodyState& body) {
  return (body.q_WB * body.v_B).z();
}

/// Wings level, a pitch angle, a throttle: hands on an Anaconda's inverted V-tail.
struct Pilot {
  double pitch_rad{};
  double throttle{};

  hal::OutputValues operator()(const BodyState& body) const {
    const double travel = 40.0 * kDegree;
    const double aileron = -0.5 * roll_of(body) - 0.05 * body.w_B.x();
    const double elevator = -0.8 * (pitch_rad - pitch_of(body)) + 0.08 * body.w_B.y();
    const double rudder = 0.1 * body.w_B.z();
    const auto output = [travel](double angle) {
      return static_cast<float>(std::clamp(0.5 + 0.5 * angle / travel, 0.0, 1.0));
    };
    hal::OutputValues outputs{};
    outputs[0] = output(aileron);
    outputs[1] = output(0.5 * (rudder - elevator));
    outputs[2] = output(0.5 * (rudder + elevator));
    outputs[4] = static_cast<float>(throttle);
    return outputs;
  }
};

/// Flies until `done` or for `most_s`; the pilot is asked every step.
void fly(RigidBody& dynamics, double most_s, const std::function<Pilot(const Truth&)>& pilot,
         const std::function<bool(const Truth&)>& done) {
  const Time end = dynamics.truth().time + hal::microseconds(std::llround(most_s * 1e6));
  while (dynamics.truth().time < end && !done(dynamics.truth())) {
    const Truth& truth = dynamics.truth();
    dynamics.step(truth.time + hal::microseconds(2500), pilot(truth)(truth.body));
  }
}

TEST(Ground, TakesOffFromItsWheels) {
  Hangar hangar("anaconda");
  RigidBody& dynamics = hangar.dynamics;
  const auto never = [](const Truth&) { return false; };
  fly(dynamics, 2.0, [](const Truth&) { return Pilot{}; }, never);
  const auto pilot = [](const Truth& truth) {
    return Pilot{truth.body.v_B.x() > 13.0 ? 12.0 * kDegree : 0.0, 0.8};
  };
  double lift_off_m = 0.0;
  double lift_off_m_s = 0.0;
  double most_roll = 0.0;
  fly(dynamics, 10.0, pilot, [&](const Truth& truth) {
    if (truth.on_ground) {
      lift_off_m = truth.body.p_W.head<2>().norm();
      lift_off_m_s = truth.body.v_B.x();
    }
    most_roll = std::max(most_roll, std::abs(roll_of(truth.body)));
    return false;
  });
  const BodyState& end = dynamics.truth().body;
  EXPECT_GT(-end.p_W.z(), 20.0);
  EXPECT_GT(lift_off_m, 3.0);
  EXPECT_LT(lift_off_m, 40.0);
  // Not below the speed at which peak lift carries the weight.
  const double stall_m_s = std::sqrt(2.0 * 4.5 * 9.80665 / (1.07 * 0.52 * 1.26));
  EXPECT_GT(lift_off_m_s, stall_m_s);
  EXPECT_LT(most_roll, 10.0 * kDegree);
  EXPECT_LT(std::abs(end.p_W.y()), 10.0);
}

TEST(Ground, IsThrownByHand) {
  Hangar hangar("anaconda");
  BodyState hand;
  hand.p_W.z() = -1.8;
  hand.q_WB = Eigen::AngleAxisd(12.0 * kDegree, Vector3::UnitY());
  hand.v_B.x() = 9.0;  // a good throw into no wind, below the stall
  ASSERT_TRUE(hangar.dynamics.set_state(hand));
  double least_m = 10.0;
  fly(
      hangar.dynamics, 5.0, [](const Truth&) { return Pilot{12.0 * kDegree, 1.0}; },
      [&](const Truth& truth) {
        least_m = std::min(least_m, -truth.body.p_W.z());
        return false;
      });
  EXPECT_GT(least_m, 0.5);
  EXPECT_GT(-hangar.dynamics.truth().body.p_W.z(), 10.0);
}

TEST(Ground, LandsAndRollsToAStop) {
  Hangar hangar("anaconda");
  RigidBody& dynamics = hangar.dynamics;
  Trim approach = hangar.trim({14.0, -4.0 * kDegree, 0.0, 12.0});
  ASSERT_TRUE(dynamics.set_state(approach.body, approach.module_state));
  const double glide_pitch = approach.pitch_rad;
  const double glide_throttle = approach.throttle;
  double touch_sink_m_s = 0.0;
  Vector3 touch = Vector3::Zero();
  const auto pilot = [&](const Truth& truth) {
    if (touch.x() > 0.0) return Pilot{0.0, 0.0};
    const double height_m = -truth.body.p_W.z() - 0.2;
    return height_m > 2.0 ? Pilot{glide_pitch, glide_throttle} : Pilot{5.0 * kDegree, 0.0};
  };
  double most_roll = 0.0;
  fly(dynamics, 60.0, pilot, [&](const Truth& truth) {
    if (truth.on_ground && touch.x() == 0.0) {
      touch = truth.body.p_W;
      touch_sink_m_s = sink_m_s(truth.body);
    }
    most_roll = std::max(most_roll, std::abs(roll_of(truth.body)));
    return touch.x() > 0.0 && truth.body.v_B.norm() < 0.01;
  });
  const BodyState& end = dynamics.truth().body;
  ASSERT_GT(touch.x(), 50.0);
  EXPECT_LT(touch_sink_m_s, 1.5);
  EXPECT_TRUE(dynamics.truth().on_ground);
  EXPECT_LT(end.v_B.norm(), 0.05);
  EXPECT_NEAR(-end.p_W.z(), -dynamics.rest_state().p_W.z(), 0.02);  // on its wheels
  EXPECT_LT(most_roll, 5.0 * kDegree);
  // Rolling friction alone would take v^2/(2 mu g) = 200 m from 14 m/s; drag shortens it.
  const double roll_out_m = (end.p_W - touch).norm();
  EXPECT_GT(roll_out_m, 40.0);
  EXPECT_LT(roll_out_m, 200.0);
}

TEST(Ground, FallsOnItsNoseAndStaysInOnePiece) {
  Hangar hangar("anaconda");
  BodyState dive;
  dive.p_W.z() = -5.0;
  dive.q_WB = Eigen::AngleAxisd(-60.0 * kDegree, Vector3::UnitY());
  dive.v_B.x() = 15.0;
  ASSERT_TRUE(hangar.dynamics.set_state(dive));
  for (int i = 1; i <= 8000; ++i) hangar.dynamics.step(hal::microseconds(2500 * i), {});
  const BodyState& end = hangar.dynamics.truth().body;
  EXPECT_TRUE(end.p_W.allFinite());
  EXPECT_LT(end.v_B.norm(), 0.1);
  EXPECT_LT(-end.p_W.z(), 1.0);
}

}  // namespace
}  // namespace rosflight::sim::test
