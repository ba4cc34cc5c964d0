// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/commanded_flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "autonomy/multirotor/test/flight.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

using Turn = CommandedFlight::Turn;

/// A vehicle in the small world of plant.hpp, flown by commands that the test gives.
struct Bench {
  Bench() : Bench(default_config().thrust) {}
  /// @param real  what becomes of a throttle, whatever the stack thinks.
  explicit Bench(const ThrustModel& real)
      : config{default_config()},
        flight{config.controller, config.thrust},
        plant{PlantConfig{}, real} {
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
    for (const FlightEvent& event : flight.output().events) {
      if (event.type == FlightEventType::kThrustFault) ++thrust_faults;
    }
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
  int thrust_faults{};
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

/// The flight controller turns throttle into newtons by motor parameters (USE_MOTOR_PARAM = 1, T_max = 120 N), of which the stack
/// knows nothing: seen as a climb through a hold at 2.5 m/s, without end.
TEST(CommandedFlight, AVehicleThatClimbsAtLittleThrustLands) {
  Bench bench(ThrustModel(ThrustModel::curve_of(default_rotors()), {0.7, 120.0}));
  bench.armed = true;
  double highest_m = 0.0;
  for (const double end_s = bench.t_s + 60.0;
       bench.t_s < end_s && bench.phase() != Phase::kLanded;) {
    bench.step(go_to({0, 0, -2}));
    highest_m = std::max(highest_m, -bench.plant.state().p_W.z());
  }
  EXPECT_EQ(bench.thrust_faults, 1);
  EXPECT_EQ(bench.phase(), Phase::kLanded);
  EXPECT_LT(highest_m, 15.0);
  EXPECT_LT(bench.plant.take_impact_m_s(), 2.0);
}

TEST(CommandedFlight, AVehicleThatSinksWithAllItsThrustIsToldAndLands) {
  Bench bench;
  bench.armed = true;
  bench.run(20.0, go_to({0, 0, -40}));
  EXPECT_EQ(bench.thrust_faults, 0);
  bench.status.failsafe = true;  // the flight controller does not do what is commanded
  bench.plant.config().mass_kg = bench.config.controller.max_thrust_N / 9.81 * 1.05;
  bench.run(6.0, go_to({0, 0, -40}));
  EXPECT_EQ(bench.thrust_faults, 0);
  bench.status.failsafe = false;
  bench.run(6.0, go_to({0, 0, -40}));
  EXPECT_EQ(bench.thrust_faults, 1);
  EXPECT_EQ(bench.phase(), Phase::kLanding);
}

/// Whatever is commanded, a vehicle that is as its settings say is never taken for another.
TEST(CommandedFlight, NoCommandMakesAGoodVehicleAFault) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  for (int flight = 0; flight < 20; ++flight) {
    Bench bench;
    bench.armed = true;
    bench.plant.config().wind_W =
        4.0 * Vector3(anywhere(random), anywhere(random), 0.5 * anywhere(random));
    bench.plant.config().thrust_scale = 1.0 + 0.1 * anywhere(random);
    for (int leg = 0; leg < 15; ++leg) {
      const Vector3 to = 10.0 * Vector3(anywhere(random), anywhere(random), anywhere(random));
      bench.run(1.0 + anywhere(random), go_to(to - Vector3(0, 0, 15)));
    }
    EXPECT_EQ(bench.thrust_faults, 0) << "flight " << flight;
  }
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
