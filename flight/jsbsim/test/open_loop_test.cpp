// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/open_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::flight {
namespace {

void expect_same_flight(const std::string& file, const RecordedFlight& flight) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "rosflight_open_loop";
  write(flight, folder);
  const RecordedFlight again = read(folder);
  std::filesystem::remove_all(folder);
  Replay replay(sim::Vehicle::from_file(file), again);
  while (replay.step(1)) {
  }
  const sim::BodyState& end = replay.dynamics().truth().body;
  EXPECT_EQ(end.p_W, flight.end.p_W);  // to the bit
  EXPECT_EQ(end.q_WB.coeffs(), flight.end.q_WB.coeffs());
  EXPECT_EQ(end.v_B, flight.end.v_B);
  EXPECT_EQ(end.w_B, flight.end.w_B);
}

TEST(OpenLoop, AFixedWingsFlightCanBeFlownAgain) {
  const RecordedFlight flight = record_attitude_hold("vehicles/anaconda.yaml", {}, 20.0);
  EXPECT_EQ(flight.outputs.size(), 8000U);
  EXPECT_GT(-flight.end.p_W.z(), 50.0);
  EXPECT_GT((flight.end.p_W - flight.start.p_W).norm(), 100.0);
  EXPECT_LT(flight.end.v_B.norm(), 30.0);
  expect_same_flight("vehicles/anaconda.yaml", flight);
}

TEST(OpenLoop, AMultirotorsMissionCanBeFlownAgain) {
  const RecordedFlight flight = record_mission("vehicles/multirotor.yaml", {}, 5.0);
  EXPECT_EQ(flight.outputs.size(), 2000U);
  expect_same_flight("vehicles/multirotor.yaml", flight);
}

}  // namespace
}  // namespace rosflight::flight
