// SPDX-License-Identifier: BSD-3-Clause
// The quad-plane in wind, on a low battery, with faults in its transitions: docs/quadplane.md, docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <tuple>

#include "flight/test/quadplane_rig.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::flight::testing {
namespace {

using Phase = QuadplanePhase;

class Winds : public ::testing::TestWithParam<const char*> {};

/// Transition forward to the north: wind from 0 is a head wind, from 180 a tail wind; the way back meets them as well.
TEST_P(Winds, KeepHeightAndPath) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    FlightChoice choice = quadplane();
    choice.wind = std::string("8,") + GetParam() + ",8";
    choice.seed = seed;
    Rig rig(choice);
    const QuadplaneRecord record = fly(rig);
    EXPECT_TRUE(rig.completed()) << seed << rig.flight->score().verdict;
    EXPECT_LE(record.loss_m, 5.0) << seed;
    EXPECT_LE(record.rms_m(), 3.0) << seed;
    // A corner flown in a stall was 7 m off; a take-off on a wrong wind went 35 m away.
    EXPECT_LE(record.largest_error_m, 5.0) << seed;
    EXPECT_LE(record.takeoff_drift_m, 3.0) << seed;
    EXPECT_LE(record.landing_drift_m, 3.0) << seed;
    EXPECT_LE(record.largest_tilt_deg, 60.0) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(From, Winds, ::testing::Values("0", "90", "180", "270"),
                         [](const auto& instance) {
                           return std::string("from") + instance.param + "deg";
                         });

TEST(Quadplane, CruisesOnTheWingAlone) {
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, Phase::kCruise));
  rig.run_for(8.0);
  const sim::Truth& truth = rig.flight->truth();
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT(truth.rotor_speed_rad_s[k], 20.0);
  EXPECT_GT(truth.rotor_speed_rad_s[4], 200.0);
  EXPECT_NEAR(truth.body.v_B.x(), 17.0, 0.7);
}

/// In still air the true angle of attack stays below the stall wherever the wing carries something.
TEST(Quadplane, NeverStallsInStillAir) {
  Rig rig(quadplane());
  double largest_rad = 0.0;
  while (!rig.flight->finished()) {
    rig.flight->step();
    const sim::Vector3& v_B = rig.flight->truth().body.v_B;
    if (v_B.x() > 8.0) largest_rad = std::max(largest_rad, std::atan2(v_B.z(), v_B.x()));
  }
  const sim::FixedWingParameters aircraft = sim::read_quadplane(rig.setup->vehicle.root());
  EXPECT_LT(largest_rad, aircraft.airframe.stall_angle_rad);
  EXPECT_GT(largest_rad, 0.0);
}

/// Stall speed and corridor in the comment of the vehicle file, from the file's own coefficients: the largest lift of the
/// wing's curve, V_s = sqrt(2 m g/(rho S C_L,max)), 1 - (V/V_s)^2, 1.2 V_s.
TEST(Quadplane, TheVehicleFileSaysTheStallSpeedOfItsCoefficients) {
  const FlightSetup setup(quadplane());
  const sim::FixedWingParameters aircraft = sim::read_quadplane(setup.vehicle.root());
  const sim::Airframe wing(aircraft.airframe);
  double largest = 0.0;
  for (int k = 0; k < 3000; ++k) largest = std::max(largest, wing.lift_coefficient(1e-4 * k));
  const sim::EnvironmentParameters& environment = setup.vehicle.environment();
  const double density =
      sim::Atmosphere(environment.atmosphere).at(environment.origin.altitude_m).density_kg_m3;
  const double weight_N = setup.vehicle.body().mass_kg * environment.gravity_m_s2;
  const double stall_m_s =
      std::sqrt(2.0 * weight_N / (density * aircraft.airframe.area_m2 * largest));
  const auto carries = [&](double v) { return 1.0 - v * v / (stall_m_s * stall_m_s); };
  std::stringstream text;
  text << std::ifstream("vehicles/quadplane.yaml").rdbuf();
  const std::string file = text.str();
  for (const std::string& part :
       {fmt::format("coefficient of the wing {:.2f},", largest),
        fmt::format("{:.1f} m/s in the air at the origin", stall_m_s),
        fmt::format("{:.2f} kg/m^3", density), fmt::format("{:.2f} at 8 m/s", carries(8.0)),
        fmt::format("{:.2f} at 10 m/s", carries(10.0)), fmt::format("0 at {:.1f} m/s", stall_m_s),
        fmt::format("1.2 V_s = {:.1f} m/s", 1.2 * stall_m_s)}) {
    EXPECT_NE(file.find(part), std::string::npos) << part;
  }
  const auto& flight = std::get<QuadplanePlan>(setup.plan).autonomy.flight;
  EXPECT_NEAR(flight.vehicle.stall_speed_m_s(), stall_m_s, 0.01);
  EXPECT_GE(flight.cruise_m_s, flight.wing_only_stalls * stall_m_s);
}

/// Steps until a note contains a text. @returns false: the flight has ended without it.
bool reach_note(Rig& rig, const std::string& text) {
  bool noted = false;
  rig.flight->runner().set_notify(
      [&](const FlightNote& note) { noted = noted || note.text.find(text) != std::string::npos; });
  while (!noted && !rig.flight->finished()) rig.flight->step();
  rig.flight->runner().set_notify(nullptr);
  return noted;
}

/// Softly, disarmed, not at the end of the mission.
void expect_down(Rig& rig) {
  rig.flight->run();
  const FlightScore score = rig.flight->score();
  EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << score.verdict;
  EXPECT_TRUE(rig.flight->runner().disarmed());
  EXPECT_TRUE(score.landing.soft(score.limits)) << score.verdict;
}

double from_m(const Rig& rig, const sim::Vector3& p_W) {
  return (rig.flight->truth().body.p_W - p_W).head<2>().norm();
}

class LowBattery : public ::testing::TestWithParam<const char*> {};

TEST_P(LowBattery, BringsItBackToTheStart) {
  FlightChoice choice = quadplane({std::string("battery_low@") + GetParam()});
  choice.wind = "6,270,6";
  Rig rig(choice);
  ASSERT_TRUE(reach_note(rig, "battery low: returns"));
  expect_down(rig);
  EXPECT_LT(from_m(rig, sim::Vector3::Zero()), 4.0) << rig.flight->score().verdict;
}

INSTANTIATE_TEST_SUITE_P(At, LowBattery, ::testing::Values("20", "33", "60", "120", "140"),
                         [](const auto& instance) { return std::string(instance.param) + "s"; });

/// The last level: it stops ahead, v^2/(2 a) with 23 m/s over ground and 1.2 m/s^2, and lands there.
TEST(Quadplane, AnEmptyBatteryLandsItAtOnce) {
  FlightChoice choice = quadplane();
  choice.wind = "6,270,6";
  choice.overrides = {"autonomy.battery.land_charge=0.97", "autonomy.battery.return_charge=0",
                      "autonomy.battery.warn_charge=0"};
  Rig rig(choice);
  ASSERT_TRUE(reach_note(rig, "battery low: lands"));
  EXPECT_GT(rig.height_m(), 20.0);
  const sim::Vector3 decided_W = rig.flight->truth().body.p_W;
  const double decided_s = sim::to_seconds(rig.flight->now());
  expect_down(rig);
  EXPECT_LT(from_m(rig, decided_W), 240.0);
  EXPECT_LT(sim::to_seconds(rig.flight->now()) - decided_s, 75.0);
}

class WeakMotor : public ::testing::TestWithParam<std::tuple<Phase, int>> {};

TEST_P(WeakMotor, InATransitionCompletesTheMission) {
  const auto [phase, motor] = GetParam();
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(1.0);
  rig.flight->faults().add(sim::parse_fault(
      fmt::format("motor{}_partial=0.8@{}", motor, sim::to_seconds(rig.flight->now()))));
  const QuadplaneRecord record = fly(rig);
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
  EXPECT_LE(record.loss_m, 5.0);
  EXPECT_LE(record.rms_m(), 3.0);
}

INSTANTIATE_TEST_SUITE_P(In, WeakMotor,
                         ::testing::Combine(::testing::Values(Phase::kTransition, Phase::kBack),
                                            ::testing::Values(0, 1, 2, 3)),
                         [](const auto& instance) {
                           return fmt::format("{}_motor{}th", name(std::get<0>(instance.param)),
                                              std::get<1>(instance.param));
                         });

class Silence : public ::testing::TestWithParam<std::tuple<Phase, const char*>> {};

/// From the second second of a transition on the link is cut or the receiver silent for 3 s.
TEST_P(Silence, InATransitionTheMissionIsCompleted) {
  const auto [phase, fault] = GetParam();
  Rig rig(quadplane());
  ASSERT_TRUE(reach(rig, phase));
  rig.run_for(2.0);
  rig.flight->faults().add(
      sim::parse_fault(fmt::format(fmt::runtime(fault), sim::to_seconds(rig.flight->now()))));
  const double height_m = rig.height_m();
  double largest_tilt = 0.0;
  for (int k = 0; k < 1200; ++k) {
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
  }
  EXPECT_LT(largest_tilt, 30.0);
  EXPECT_GT(rig.height_m(), height_m - 5.0);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->score().verdict;
}

INSTANTIATE_TEST_SUITE_P(In, Silence,
                         ::testing::Combine(::testing::Values(Phase::kTransition, Phase::kBack),
                                            ::testing::Values("link_cut@{}:3", "rc_silence@{}:3")),
                         [](const auto& instance) {
                           const std::string fault = std::get<1>(instance.param);
                           return fmt::format("{}_{}", name(std::get<0>(instance.param)),
                                              fault.substr(0, fault.find('@')));
                         });

class ForGood : public ::testing::TestWithParam<Phase> {
 protected:
  /// Steps to 4 s after the beginning of a transition; the faults begin then.
  static void begin(Rig& rig, const std::vector<std::string>& faults) {
    ASSERT_TRUE(reach(rig, GetParam()));
    rig.run_for(4.0);
    for (const std::string& fault : faults) {
      rig.flight->faults().add(
          sim::parse_fault(fmt::format("{}@{}", fault, sim::to_seconds(rig.flight->now()))));
    }
  }
};

/// A cut link takes everything but the firmware and the pilot's sticks: level, upright, given up after 60 s.
TEST_P(ForGood, ACutLinkLeavesALevelVehicle) {
  Rig rig(quadplane());
  begin(rig, {"link_cut"});
  double largest_tilt = 0.0;
  while (!rig.flight->finished()) {
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
    if (rig.flight->runner().stage() == Stage::kFailed) break;
  }
  EXPECT_EQ(rig.flight->runner().failure(), "link lost in flight");
  EXPECT_LT(largest_tilt, 30.0);
}

/// Without a receiver the companion flies on and lands; nobody can disarm, so the vehicle stays there with its rotors on, and slides when
/// the mission is given up and the failsafe throttle carries most of it.
TEST_P(ForGood, ASilentReceiverEndsOnTheGroundAtTheAim) {
  Rig rig(quadplane());
  begin(rig, {"rc_silence"});
  const QuadplaneRecord record = fly(rig);
  EXPECT_TRUE(details(rig).landed);
  EXPECT_EQ(rig.flight->runner().failure(), "stage disarm took longer than 15 s");
  EXPECT_LE(record.loss_m, 5.0);
  EXPECT_LE(record.rms_m(), 3.0);
  EXPECT_LT(record.landing_drift_m, 3.0);
  EXPECT_TRUE(rig.flight->truth().on_ground);
  EXPECT_LT(rig.tilt_deg(), 5.0);
}

/// With neither the firmware's failsafe throttle brings it down: level, as fast as the rotors damp it.
TEST_P(ForGood, LinkAndReceiverSinkToTheGround) {
  Rig rig(quadplane());
  begin(rig, {"link_cut", "rc_silence"});
  double largest_tilt = 0.0;
  double sink_m_s = 0.0;
  for (int k = 0; k < 48000 && !rig.flight->truth().on_ground; ++k) {
    sink_m_s = rig.sink_m_s();
    rig.flight->step();
    largest_tilt = std::max(largest_tilt, rig.tilt_deg());
  }
  EXPECT_TRUE(rig.flight->truth().on_ground) << rig.height_m();
  EXPECT_LT(sink_m_s, 1.5);
  EXPECT_LT(largest_tilt, 30.0);
}

INSTANTIATE_TEST_SUITE_P(In, ForGood, ::testing::Values(Phase::kTransition, Phase::kBack),
                         [](const auto& instance) { return std::string(name(instance.param)); });

}  // namespace
}  // namespace rosflight::flight::testing
