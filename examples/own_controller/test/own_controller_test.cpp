// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "examples/own_controller/own_guidance.hpp"
#include "flight/flight.hpp"

namespace own_controller {
namespace {

using rosflight::autonomy::Quaternion;
using rosflight::autonomy::multirotor::AttitudeView;
using rosflight::autonomy::multirotor::ControlMode;
using rosflight::autonomy::multirotor::State;
using rosflight::autonomy::multirotor::Trajectory;
using rosflight::flight::Flight;
using rosflight::flight::FlightChoice;
using rosflight::flight::FlightParts;
using rosflight::flight::FlightSetup;

ControllerCommand command_at(const State& state, const Trajectory& setpoint) {
  GeometricController controller{GeometricConfig{}};
  const AttitudeView attitude(state.q_WB);
  return controller.step({state, attitude, setpoint, 0.0, 0.01, {}});
}

TEST(GeometricController, LevelOnItsSetpointItHovers) {
  const ControllerCommand command = command_at({}, {});
  ASSERT_TRUE(command.valid);
  EXPECT_EQ(command.mode, ControlMode::kRollratePitchrateYawrateThrust);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(command.cmd[k], 0.0, 1e-12);
  EXPECT_NEAR(command.cmd[3], 3.5 * 9.81, 1e-9);
}

// e_R of a turn by an angle about one axis is its sine about that axis (Lee et al., eq. 10).
TEST(GeometricController, AttitudeErrorIsTheSineOfTheAngle) {
  for (int axis = 0; axis < 3; ++axis) {
    State state;
    state.q_WB = Quaternion(Eigen::AngleAxisd(0.4, rosflight::autonomy::Vector3::Unit(axis)));
    const ControllerCommand command = command_at(state, {});
    for (int k = 0; k < 3; ++k) {
      // kr 8 and the first 10 ms of the integral with 12
      const double wanted = k == axis ? -(8.0 + 12.0 * 0.01) * std::sin(0.4) : 0.0;
      EXPECT_NEAR(command.cmd[static_cast<std::size_t>(k)], wanted, 1e-12) << axis << k;
    }
    // Only the share of the force along the body's axis is asked of the motors.
    EXPECT_NEAR(command.cmd[3], 3.5 * 9.81 * (axis == 2 ? 1.0 : std::cos(0.4)), 1e-9);
  }
}

TEST(GeometricController, AccelerationFedForwardTiltsByItsArcTangent) {
  Trajectory setpoint;
  setpoint.a_W = {2.0, 0.0, 0.0};
  const double pitch = -std::atan(2.0 / 9.81);  // nose down: forward
  State state;
  state.q_WB = Quaternion(Eigen::AngleAxisd(pitch, rosflight::autonomy::Vector3::UnitY()));
  const ControllerCommand command = command_at(state, setpoint);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(command.cmd[k], 0.0, 1e-9);
  EXPECT_NEAR(command.cmd[3], 3.5 * std::hypot(2.0, 9.81), 1e-9);
}

TEST(GeometricController, NumbersThatAreNoneAreNotFlown) {
  State state;
  state.p_W.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(command_at(state, {}).valid);
}

/// Mission, and the wind it is flown in.
class Flights : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Flights, EndLandedWithEveryWaypointReached) {
  FlightChoice choice;
  choice.mission = GetParam().first;
  if (*GetParam().second != '\0') choice.wind = GetParam().second;
  const FlightSetup setup(choice);
  const auto flight = std::make_unique<Flight>(setup, FlightParts{.guidance = own_guidance(setup)});
  flight->run();
  const rosflight::flight::FlightScore score = flight->score();
  EXPECT_TRUE(score.success()) << score.verdict;
  EXPECT_LE(flight->own_tracking().rms(), 1.0);  // what the project asks of its own controller
}

INSTANTIATE_TEST_SUITE_P(OwnController, Flights,
                         ::testing::Values(std::pair{"default", ""},
                                           std::pair{"default", "6,270,6"},
                                           std::pair{"figure_eight", ""}));

TEST(OwnGuidance, AFixedWingIsRefusedInOneLine) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  const FlightSetup setup(choice);
  EXPECT_THROW(own_guidance(setup), rosflight::config::Error);
}

}  // namespace
}  // namespace own_controller
