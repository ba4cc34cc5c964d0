// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/flight_manager.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "autonomy/quadplane/test/plant.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using testing::config;
using testing::Plant;

constexpr double kDt_s = 0.01;
constexpr std::uint16_t kSwitches = 0x003;
constexpr std::uint16_t kNotActive = 0x3C0;

/// Guidance and plant at 100 Hz. The firmware's part: the override word, and a pilot who hovers.
struct Loop {
  FlightConfig flight_config{config()};
  FlightManager manager{flight_config, testing::mission()};
  Plant plant;
  Status status{.armed = true};
  std::uint16_t pilot{};  ///< Bits of his switches and sticks.
  double silent_s{};
  std::set<Phase> seen;
  std::multiset<FlightEventType> events;
  double t_s{};

  const FlightOutput& step() {
    const std::uint16_t ignored = manager.output().command.ignore;
    status.rc_override =
        static_cast<std::uint16_t>(pilot | ((ignored & 0x03FU) != 0 ? kNotActive : 0U));
    status.silent_s = silent_s;
    t_s += kDt_s;
    const FlightOutput& out = manager.step({t_s, plant.state, status, {}});
    for (const FlightEvent& event : out.events) events.insert(event.type);
    seen.insert(out.phase);
    const bool by_pilot = pilot != 0 || silent_s > 0.1 || out.command.ignore == kIgnoreAll;
    plant.step(by_pilot ? hovers() : out.command, kDt_s);
    return out;
  }
  /// Level, on the lifting rotors, with a throttle that carries.
  FirmwareCommand hovers() const {
    FirmwareCommand command;
    const Quaternion& q = plant.state.q_WB;
    const Vector3 up_B = q.conjugate() * Vector3(0.0, 0.0, -1.0);
    const Vector3 level = 8.0 * up_B.cross(Vector3(0.0, 0.0, -1.0)) * -1.0 - 3.0 * plant.state.w_B;
    command.u[2] = static_cast<float>(-6.0 * 9.80665 - 6.0 * (plant.state.v_W.z()));
    for (std::size_t k = 0; k < 3; ++k)
      command.u[3 + k] = static_cast<float>(level(static_cast<Eigen::Index>(k)));
    return command;
  }
  bool reach(Phase phase, double timeout_s = 300.0) {
    const double end_s = t_s + timeout_s;
    while (t_s < end_s && manager.output().phase != phase) step();
    return manager.output().phase == phase;
  }
  void run(double duration_s) {
    const double end_s = t_s + duration_s;
    while (t_s < end_s) step();
  }
};

TEST(FlightManager, FliesAMissionThroughAllItsPhases) {
  Loop loop;
  double rms = 0.0;
  int samples = 0;
  while (loop.t_s < 300.0 && !loop.manager.output().landed) {
    const FlightOutput& out = loop.step();
    if (!out.tracking) continue;
    rms += (loop.plant.state.p_W - out.setpoint.p_W).squaredNorm();
    ++samples;
  }
  EXPECT_TRUE(loop.manager.output().landed);
  EXPECT_TRUE(loop.manager.output().mission_done);
  const std::set<Phase> all{Phase::kTakeoff, Phase::kTransition, Phase::kCruise, Phase::kBack,
                            Phase::kHover,   Phase::kLanding,    Phase::kLanded};
  EXPECT_EQ(loop.seen, all);
  EXPECT_EQ(loop.events.count(FlightEventType::kWaypointReached), 3U);
  EXPECT_LT((loop.plant.state.p_W - Vector3(50.0, 400.0, 0.0)).norm(), 1.5);
  EXPECT_LT(std::sqrt(rms / samples), 1.5);
}

/// The transition to the wing ends above 1.2 stall speeds, with the rotors off.
TEST(FlightManager, CruiseBeginsAboveTheStallSpeed) {
  Loop loop;
  ASSERT_TRUE(loop.reach(Phase::kCruise));
  const double stall = loop.flight_config.vehicle.stall_speed_m_s();
  EXPECT_GE(loop.plant.state.v_W.norm(), loop.flight_config.wing_only_stalls * stall - 0.1);
  EXPECT_EQ(loop.manager.output().lift_force_N, 0.0);
}

class Takeover : public ::testing::TestWithParam<std::tuple<Phase, double>> {};

/// The firmware reports axes as not active where guidance ignores them: guidance that ignored all of them while the
/// pilot flies would never see that he has given back.
TEST_P(Takeover, GivenBackTheMissionGoesOn) {
  const auto [phase, duration_s] = GetParam();
  Loop loop;
  ASSERT_TRUE(loop.reach(phase));
  loop.run(1.5);
  loop.pilot = kSwitches;
  loop.run(duration_s);
  ASSERT_EQ(loop.manager.output().phase, Phase::kPilot);
  EXPECT_EQ(loop.manager.output().command.ignore, 0x3C0) << "surfaces stay in the middle";
  loop.pilot = 0;
  loop.run(0.1);
  EXPECT_NE(loop.manager.output().phase, Phase::kPilot);
  EXPECT_TRUE(loop.reach(Phase::kLanded));
  EXPECT_TRUE(loop.manager.output().mission_done);
  EXPECT_EQ(loop.events.count(FlightEventType::kPilotGaveBack), 1U);
}

INSTANTIATE_TEST_SUITE_P(
    In, Takeover,
    ::testing::Combine(::testing::Values(Phase::kTakeoff, Phase::kTransition, Phase::kCruise,
                                         Phase::kBack, Phase::kHover),
                       ::testing::Values(0.5, 3.0, 10.0)),
    [](const auto& instance) {
      return std::string(name(std::get<0>(instance.param))) + "for" +
             std::to_string(static_cast<int>(10.0 * std::get<1>(instance.param))) + "ds";
    });

/// Given back in the air the rotors do not wait for their run-up a second time.
TEST(FlightManager, ATakeoffGivenBackGoesOnWithoutALoss) {
  Loop loop;
  ASSERT_TRUE(loop.reach(Phase::kTakeoff));
  loop.run(6.0);
  loop.pilot = kSwitches;
  loop.run(2.0);
  const double height_m = -loop.plant.state.p_W.z();
  ASSERT_GT(height_m, 4.0);
  loop.pilot = 0;
  loop.run(0.1);
  EXPECT_EQ(loop.manager.output().phase, Phase::kTakeoff);
  double lowest = height_m;
  for (int k = 0; k < 300; ++k) {
    loop.step();
    lowest = std::min(lowest, -loop.plant.state.p_W.z());
  }
  EXPECT_GT(lowest, height_m - 0.5);
}

/// Who gives back near the ground wants to be down.
TEST(FlightManager, GivenBackNearTheGroundItLands) {
  Loop loop;
  ASSERT_TRUE(loop.reach(Phase::kTransition));
  loop.pilot = kSwitches;
  loop.run(0.1);
  loop.plant.state.p_W.z() = -0.6;
  loop.plant.state.v_W.setZero();
  loop.run(0.5);
  loop.pilot = 0;
  loop.run(0.1);
  EXPECT_EQ(loop.manager.output().phase, Phase::kLanding);
  EXPECT_TRUE(loop.reach(Phase::kLanded, 20.0));
}

/// Sets the voltage at which a level of the battery counts after 3 s.
void empty_battery(Loop& loop, double cell_V) {
  loop.status.battery_voltage_V = 6.0 * cell_V;
  loop.status.battery_fresh = true;
}

class LowBattery : public ::testing::TestWithParam<Phase> {};

/// Below the second level: to the start.
TEST_P(LowBattery, ReturnsToTheStartAndLands) {
  Loop loop;
  ASSERT_TRUE(loop.reach(GetParam()));
  empty_battery(loop, 3.70);
  EXPECT_TRUE(loop.reach(Phase::kLanded));
  EXPECT_LT(loop.plant.state.p_W.norm(), 2.0);
  EXPECT_FALSE(loop.manager.output().mission_done);
  EXPECT_EQ(loop.events.count(FlightEventType::kBatteryReturn), 1U);
}

/// Below the third: where it can stop, ahead. 17^2/(2 1.2) = 120 m, 3 s at 17 m/s to confirm, a turn.
TEST_P(LowBattery, LandsWhereItIs) {
  Loop loop;
  ASSERT_TRUE(loop.reach(GetParam()));
  const Vector3 at_W = loop.plant.state.p_W;
  const double at_s = loop.t_s;
  empty_battery(loop, 3.55);
  EXPECT_TRUE(loop.reach(Phase::kLanded));
  EXPECT_LT((loop.plant.state.p_W - at_W).head<2>().norm(), 190.0);
  EXPECT_LT(loop.t_s - at_s, 70.0);
  EXPECT_EQ(loop.events.count(FlightEventType::kBatteryLand), 1U);
}

INSTANTIATE_TEST_SUITE_P(In, LowBattery,
                         ::testing::Values(Phase::kTakeoff, Phase::kTransition, Phase::kCruise),
                         [](const auto& instance) { return std::string(name(instance.param)); });

/// A pilot in between does not take the decision back.
TEST(FlightManager, ALowBatteryLandsAlsoAfterATakeover) {
  Loop loop;
  ASSERT_TRUE(loop.reach(Phase::kCruise));
  loop.pilot = kSwitches;
  empty_battery(loop, 3.55);
  loop.run(6.0);
  loop.pilot = 0;
  EXPECT_TRUE(loop.reach(Phase::kLanded, 120.0));
  EXPECT_FALSE(loop.manager.output().mission_done);
}

TEST(FlightManager, OutsideOfTheFenceItReturns) {
  Loop loop;
  Mission mission = testing::mission();
  mission.fence = Fence{.radius_m = 300.0, .height_m = 100.0};
  loop.manager = FlightManager(loop.flight_config, mission);
  EXPECT_TRUE(loop.reach(Phase::kLanded));
  EXPECT_LT(loop.plant.state.p_W.norm(), 2.0);
  EXPECT_EQ(loop.events.count(FlightEventType::kFenceCrossed), 1U);
}

TEST(FlightManager, AfterALongSilenceItReturns) {
  Loop loop;
  ASSERT_TRUE(loop.reach(Phase::kCruise));
  for (int k = 0; k < 1200; ++k) {
    loop.silent_s += kDt_s;
    loop.step();
  }
  loop.silent_s = 0.0;
  EXPECT_TRUE(loop.reach(Phase::kLanded));
  EXPECT_LT(loop.plant.state.p_W.norm(), 2.0);
  EXPECT_EQ(loop.events.count(FlightEventType::kLongGap), 1U);
}

/// Random switches, silences, lost states, requests and gusts: every command is finite and within its limits, no rotor
/// is off below 1.2 stall speeds in wing-borne flight, and it ends on the ground.
class RandomFlights : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomFlights, StayFiniteAndWithinLimits) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Loop loop;
  loop.plant.wind_W = {8.0 * unit(random) - 4.0, 8.0 * unit(random) - 4.0, 0.0};
  const StateEstimate* const state = &loop.plant.state;
  const double wing_only =
      loop.flight_config.wing_only_stalls * loop.flight_config.vehicle.stall_speed_m_s();
  double until_s = 0.0;
  bool lost = false;
  Phase before = Phase::kDisarmed;
  while (loop.t_s < 600.0 && !loop.manager.output().landed) {
    if (loop.t_s > until_s) {
      loop.pilot = unit(random) < 0.2 ? static_cast<std::uint16_t>(1U + 31.0 * unit(random)) : 0U;
      loop.silent_s = unit(random) < 0.1 ? 1.0 : 0.0;
      loop.status.failsafe = unit(random) < 0.05;
      lost = unit(random) < 0.05;
      if (unit(random) < 0.01) loop.manager.request_land();
      if (unit(random) < 0.02) loop.manager.request_return();
      until_s = loop.t_s + 4.0 * unit(random);
    }
    Plant kept = loop.plant;
    if (lost) loop.plant.state.p_W.x() = std::numeric_limits<double>::quiet_NaN();
    const double airspeed = (state->q_WB.conjugate() * (state->v_W - loop.plant.wind_W)).x();
    const FlightOutput& out = loop.step();
    if (lost) {
      kept.step(loop.hovers(), kDt_s);
      loop.plant = kept;
    }
    for (const float u : out.command.u)
      ASSERT_TRUE(std::isfinite(u)) << name(out.phase) << loop.t_s;
    ASSERT_GE(out.command.u[0], 0.0F);
    ASSERT_LE(out.command.u[2], 0.0F);
    ASSERT_GE(out.command.u[2], -loop.flight_config.vehicle.max_lift_force_N);
    for (std::size_t k = 6; k < 9; ++k) ASSERT_LE(std::abs(out.command.u[k]), 1.0F);
    if (out.phase == Phase::kCruise && before == Phase::kTransition) {
      ASSERT_GT(airspeed, wing_only - 0.2);
    }
    before = out.phase;
  }
  EXPECT_TRUE(loop.manager.output().landed)
      << name(loop.manager.output().phase) << " at " << loop.plant.state.p_W.transpose();
}

INSTANTIATE_TEST_SUITE_P(Of, RandomFlights, ::testing::Range(1U, 31U), [](const auto& instance) {
  return "seed" + std::to_string(instance.param) + "th";
});

}  // namespace
}  // namespace rosflight::autonomy::quadplane
