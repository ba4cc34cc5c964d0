// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::viewer::holoocean {
namespace {

using sim::Quaternion;
using sim::Vector3;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDeg = kPi / 180.0;

/// Roll, pitch, yaw of an aircraft: yaw about down, then pitch about right, then roll about forward.
Quaternion aircraft(double roll_deg, double pitch_deg, double yaw_deg) {
  return Eigen::AngleAxisd(yaw_deg * kDeg, Vector3::UnitZ()) *
         Eigen::AngleAxisd(pitch_deg * kDeg, Vector3::UnitY()) *
         Eigen::AngleAxisd(roll_deg * kDeg, Vector3::UnitX());
}

sim::BodyState body(const Vector3& p_W, const Quaternion& q_WB,
                    const Vector3& v_B = Vector3::Zero(), const Vector3& w_B = Vector3::Zero()) {
  return {p_W, q_WB, v_B, w_B};
}

void expect_near(const std::array<float, 3>& found, const Vector3& expected, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(static_cast<double>(found[i]), expected(static_cast<Eigen::Index>(i)), tolerance)
        << i;
}

TEST(HoloOceanFrames, NorthEastDownBecomesForwardLeftUpFromTheOriginOfTheLevel) {
  const AgentState state =
      agent_state(body({3, 4, -50}, Quaternion::Identity()), {100, 200, 5}, 0.0);
  expect_near(state.position_m, {103, 196, 55}, 1e-5);
}

TEST(HoloOceanFrames, AttitudesOfAllOctants) {
  // Conversion by hand: nose up is a negative pitch about left, nose right a negative yaw about up.
  for (const double roll : {-25.0, 25.0}) {
    for (const double pitch : {-40.0, 40.0}) {
      for (const double yaw : {-135.0, -45.0, 45.0, 135.0}) {
        const AgentState state =
            agent_state(body(Vector3::Zero(), aircraft(roll, pitch, yaw)), {}, 0.0);
        expect_near(state.roll_pitch_yaw_deg, {roll, -pitch, -yaw}, 1e-4);
        const Quaternion back = attitude_WB(state.roll_pitch_yaw_deg);
        EXPECT_LT(back.angularDistance(aircraft(roll, pitch, yaw)), 1e-6);
      }
    }
  }
}

TEST(HoloOceanFrames, AVerticalNoseIsOneRotation) {
  for (const double pitch : {-90.0, 90.0}) {
    const Quaternion q_WB = aircraft(20.0, pitch, 50.0);
    const AgentState state = agent_state(body(Vector3::Zero(), q_WB), {}, 0.0);
    EXPECT_LT(attitude_WB(state.roll_pitch_yaw_deg).angularDistance(q_WB), 1e-6) << pitch;
  }
}

TEST(HoloOceanFrames, VelocityIsInWorldAxes) {
  // Heading east with 10 m/s forward and 1 m/s to the right, which is south: (n, e, d) = (-1, 10, 0).
  const AgentState state =
      agent_state(body(Vector3::Zero(), aircraft(0, 0, 90), {10, 1, 0}), {}, 0.0);
  expect_near(state.velocity_m_s, {-1, -10, 0}, 1e-5);
  EXPECT_LT((velocity_W(state.velocity_m_s) - Vector3(-1, 10, 0)).norm(), 1e-5);
}

TEST(HoloOceanFrames, BodyRatesAreInDegreesOnce) {
  const AgentState state = agent_state(
      body(Vector3::Zero(), aircraft(10, 20, 30), Vector3::Zero(), {1, 0.5, -0.25}), {}, 0.0);
  expect_near(state.rate_deg_s, {57.29578, -28.64789, 14.32394}, 1e-4);
}

TEST(HoloOceanFrames, OnePhysicsStepLeadsToTheState) {
  const double h = 1.0 / 30.0;
  const sim::BodyState truth =
      body({5, 6, -70}, aircraft(-20, 15, 100), {20, 1, -2}, {0.8, -0.6, 1.5});
  const AgentState sent = agent_state(truth, {}, h);
  // The engine's step, by the definition of velocity and rate.
  const Vector3 p = position_W(sent.position_m, {}) + velocity_W(sent.velocity_m_s) * h;
  const auto rate_deg_s = [&sent](std::size_t i) {
    return static_cast<double>(sent.rate_deg_s.at(i));
  };
  const Vector3 w = kDeg * Vector3(rate_deg_s(0), -rate_deg_s(1), -rate_deg_s(2));
  const Quaternion q = attitude_WB(sent.roll_pitch_yaw_deg) *
                       Quaternion(Eigen::AngleAxisd(w.norm() * h, w.normalized()));
  EXPECT_LT((p - truth.p_W).norm(), 1e-4);
  EXPECT_LT(q.angularDistance(truth.q_WB), 1e-5);
  // And without the step back it would be 0.67 m ahead.
  const AgentState at_once = agent_state(truth, {}, 0.0);
  EXPECT_NEAR((position_W(at_once.position_m, {}) - position_W(sent.position_m, {})).norm(),
              truth.v_B.norm() / 30.0, 1e-4);
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
