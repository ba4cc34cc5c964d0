// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/commanded_flight.hpp"

#include <gtest/gtest.h>

#include "autonomy/multirotor/test/flight.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

using Turn = CommandedFlight::Turn;

/// A vehicle in the small world of plant.hpp, flown by commands that the test gives.
struct Bench {
  Bench()
      : config{default_config()},
        flight{config.controller, config.thrust},
        plant{PlantConfig{}, config.thrust} {
    flight.renew(config.states);
  }

  Turn step(const ControllerCommand& command, bool good = true) {
    constexpr int kWorldSteps = 5;
    status.armed = armed;
    const Turn turn = flight.begin({.t_s = t_s,
                                    .state = plant.state(),
                                    .status = status,
                                    .ready = good,
                                    .command_good = good});
    if (turn == Turn::kOwn || turn == Turn::kFollow) flight.finish(plant.state(), command);
    for (int k = 0; k < kWorldSteps; ++k) plant.step(flight.output().command, armed, 1e-3);
    t_s += 1e-3 * kWorldSteps;
    return turn;
  }
  void run(double seconds, const ControllerCommand& command, bool good = true) {
    for (const double end_s = t_s + seconds; t_s < end_s;) step(command, good);
  }
  Phase phase() const { return flight.output().phase; }

  FlightConfig config;
  CommandedFlight flight;
  Plant plant;
  Status status{};
  double t_s{};
  bool armed{false};
};

ControllerCommand go_to(const Vector3& p_W) {
  return {ControlMode::kNposEposDposYaw, {p_W.x(), p_W.y(), p_W.z(), 0.0}, true};
}

TEST(CommandedFlight, TakesOffFliesWhatItIsToldAndLandsOnRequest) {
  Bench bench;
  bench.run(0.5, go_to({5, 2, -4}));
  EXPECT_EQ(bench.phase(), Phase::kDisarmed);
  bench.armed = true;
  bench.run(1.0, go_to({5, 2, -4}), false);
  EXPECT_EQ(bench.phase(), Phase::kDisarmed) << "nobody to fly for";
  bench.run(20.0, go_to({5, 2, -4}));
  EXPECT_EQ(bench.phase(), Phase::kOffboard);
  EXPECT_LT((bench.plant.state().p_W - Vector3(5, 2, -4)).norm(), 0.3);
  bench.flight.request_land();
  bench.run(20.0, go_to({5, 2, -4}));
  EXPECT_EQ(bench.phase(), Phase::kLanded);
  EXPECT_TRUE(bench.flight.on_ground());
  bench.armed = false;
  bench.run(0.1, go_to({5, 2, -4}));
  EXPECT_EQ(bench.phase(), Phase::kDisarmed);
  bench.flight.renew(bench.config.states);
  bench.armed = true;
  bench.run(20.0, go_to({0, 0, -3}));
  EXPECT_EQ(bench.phase(), Phase::kOffboard) << "a landing that was asked for is forgotten";
  EXPECT_LT((bench.plant.state().p_W - Vector3(0, 0, -3)).norm(), 0.3);
}

// Weak points 34, 35: a command that is not good was flown for ever.
TEST(CommandedFlight, HoldsWhereItIsWithoutGoodCommandsAndLandsInTheEnd) {
  Bench bench;
  bench.armed = true;
  bench.run(20.0, go_to({5, 2, -4}));
  ASSERT_EQ(bench.phase(), Phase::kOffboard);
  bench.run(10.0, go_to({50, 50, -40}), false);
  EXPECT_EQ(bench.phase(), Phase::kPositionHold);
  EXPECT_LT((bench.plant.state().p_W - Vector3(5, 2, -4)).norm(), 0.5);
  bench.run(bench.config.states.lost_command_land_s + 15.0, go_to({50, 50, -40}), false);
  EXPECT_EQ(bench.phase(), Phase::kLanded);
}

TEST(CommandedFlight, WithoutAStateTheVehicleIsThePilots) {
  Bench bench;
  bench.armed = true;
  bench.run(20.0, go_to({5, 2, -4}));
  bench.flight.lose_state();
  EXPECT_EQ(bench.flight.output().command.ignore, kIgnoreAll);
  ASSERT_EQ(bench.flight.output().events.count, 1U);
  EXPECT_EQ(bench.flight.output().events.list[0].type, FlightEventType::kStateLost);
  bench.step(go_to({5, 2, -4}));
  EXPECT_EQ(bench.flight.output().events.list[0].type, FlightEventType::kStateRegained);
  EXPECT_EQ(bench.phase(), Phase::kPositionHold);
  EXPECT_EQ(bench.flight.output().command.ignore, 0);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
