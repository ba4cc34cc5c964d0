// SPDX-License-Identifier: BSD-3-Clause
#include "flight/steering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <regex>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::flight {
namespace {

class SteeringTest : public testing::Test {
 protected:
  void run_to(double t_s) {
    while (sim::to_seconds(flight_.now()) < t_s) flight_.step();
  }
  /// In the next step.
  void change(const std::string& text) {
    auto act = std::make_shared<std::function<void(Flight&)>>(parse_change(text, flight_));
    flight_.set_script(
        [act](Flight& flight, sim::Time) { std::exchange(*act, [](Flight&) {})(flight); });
    flight_.step();
  }

  FlightSetup setup_{FlightChoice{}};
  Flight flight_{setup_};
};

TEST_F(SteeringTest, EachFaultOfTheListBeginsNowAndEndsWhenHealed) {
  std::istringstream lines(sim::fault_help());
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    std::string name =
        std::regex_replace(line.substr(2, line.find(' ', 2) - 2), std::regex("N_"), "1_");
    name = std::regex_replace(name, std::regex("VALUE|FACTOR"), "0.5");
    if (name.starts_with("servo")) {
      EXPECT_THROW(parse_change("fault " + name, flight_), config::Error) << "no surfaces";
      continue;
    }
    const sim::Time now = flight_.now();
    change("fault " + name + ":2");
    const sim::Fault& fault = flight_.faults().faults().back();
    EXPECT_EQ(fault.start, now) << name;
    EXPECT_EQ(fault.end, now + std::chrono::seconds(2)) << name;
    ++count;
  }
  EXPECT_EQ(count, 31);
  change("heal");
  for (const sim::Fault& fault : flight_.faults().faults()) EXPECT_LT(fault.end, flight_.now());
}

TEST(SteerFixedWing, AStuckSurfaceKeepsItsDeflectionUntilTheFaultEnds) {
  using namespace std::chrono_literals;
  FlightChoice choice;
  choice.vehicle = "anaconda";
  const FlightSetup setup{choice};
  Flight flight{setup};
  while (!flight.autonomy().tracking) flight.step();
  const auto apply = [&flight](const std::string& text) { parse_change(text, flight)(flight); };
  struct Travel {
    double aileron_rad, left_tail_rad, right_tail_rad;
  };
  /// How far each surface moves in that time. Elevator and rudder are the sums of vehicles/anaconda.yaml: each
  /// half of the tail is what of them it does not share with the other one.
  const auto travel = [&flight](std::chrono::seconds time) {
    std::array<double, 3> low{1.0, 1.0, 1.0};
    std::array<double, 3> high{-1.0, -1.0, -1.0};
    for (const sim::Time end = flight.now() + time; flight.now() < end;) {
      flight.step();
      const sim::Truth& truth = flight.truth();
      const std::array<double, 3> now{truth.aileron_rad,
                                      (truth.rudder_rad - truth.elevator_rad) / 2.0,
                                      (truth.rudder_rad + truth.elevator_rad) / 2.0};
      for (std::size_t k = 0; k < now.size(); ++k) {
        low[k] = std::min(low[k], now[k]);
        high[k] = std::max(high[k], now[k]);
      }
    }
    return Travel{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  };
  constexpr double kMoves_rad = 1e-3;
  constexpr double kRounding_rad = 1e-12;
  EXPECT_GT(travel(2s).aileron_rad, kMoves_rad);
  apply("fault servo0_stuck:3");
  const Travel aileron_stuck = travel(3s);
  EXPECT_EQ(aileron_stuck.aileron_rad, 0.0);
  EXPECT_GT(aileron_stuck.left_tail_rad, kMoves_rad);
  EXPECT_GT(travel(2s).aileron_rad, kMoves_rad) << "it has ended by itself";
  apply("fault servo1_stuck");
  const Travel left_stuck = travel(1s);
  EXPECT_LT(left_stuck.left_tail_rad, kRounding_rad);
  EXPECT_GT(left_stuck.right_tail_rad, kMoves_rad);
  apply("heal");
  EXPECT_GT(travel(2s).left_tail_rad, kMoves_rad);
  EXPECT_THROW(parse_change("fault servo3_stuck", flight), config::Error) << "it has three";
}

TEST_F(SteeringTest, WindIsTheNewOneAndAGustRisesAndEnds) {
  change("wind 8,270");
  run_to(1.0);
  EXPECT_NEAR(flight_.truth().air.wind_W.y(), 8.0, 1e-9) << "from the west";
  change("wind 0,0");
  change("gust 6,0,2");
  run_to(sim::to_seconds(flight_.now()) + 1.0);
  EXPECT_NEAR(flight_.truth().air.wind_W.x(), -6.0, 0.01)
      << "from the north, its peak after half of it";
  run_to(sim::to_seconds(flight_.now()) + 1.5);
  EXPECT_EQ(flight_.truth().air.wind_W.norm(), 0.0);
  change("wind 5,0,7");
  run_to(sim::to_seconds(flight_.now()) + 1.0);
  EXPECT_GT((flight_.truth().air.wind_W - sim::Vector3(-5.0, 0.0, 0.0)).norm(), 1e-3)
      << "turbulence";
}

TEST_F(SteeringTest, ThePilotArmsWhenHeIsLet) {
  change("hold on");
  run_to(40.0);
  EXPECT_EQ(flight_.runner().stage(), Stage::kArm);
  change("switch arm on");
  run_to(41.0);
  EXPECT_EQ(flight_.runner().stage(), Stage::kFly);
  change("stick yaw 0.75");
  run_to(41.1);
  EXPECT_EQ(flight_.pilot().position(sim::rc::Control::kYaw), 0.75F);
  change("stick yaw 0.5");  // moved far, it would override the companion
  run_to(60.0);
  change("return");
  run_to(120.0);
  EXPECT_EQ(flight_.runner().stage(), Stage::kDone);
}

/// A step of the roll stick for 2 s and back. @returns how far the altitude went [m].
double altitude_lost_m(bool kept) {
  const FlightSetup setup{FlightChoice{}};
  Flight flight{setup};
  while (!flight.autonomy().tracking) flight.step();
  const auto altitude_m = [&flight] { return -flight.truth().body.p_W.z(); };
  const double before_m = altitude_m();
  double off_m = 0.0;
  const auto fly = [&](const std::string& text, double s) {
    parse_change(text, flight)(flight);
    for (const sim::Time end = flight.now() + sim::Time{static_cast<std::int64_t>(s * 1e6)};
         flight.now() < end; flight.step())
      off_m = std::max(off_m, std::abs(altitude_m() - before_m));
  };
  if (kept) fly("keep_altitude on", 0.0);
  fly("switch attitude_override on", 1.5);
  fly("stick roll 0.75", 2.0);
  fly("stick roll 0.5", 1.2);
  return off_m;
}

TEST(KeepAltitude, ThePilotKeepsItWhileTheVehicleIsTilted) {
  const double kept_m = altitude_lost_m(true);
  EXPECT_LT(kept_m, 0.7);
  EXPECT_GT(altitude_lost_m(false), 3.0 * kept_m);
}

TEST_F(SteeringTest, AnAltitudeOffsetRaisesAMultirotorAndEndsAtZero) {
  while (!flight_.autonomy().tracking) flight_.step();
  run_to(sim::to_seconds(flight_.now()) + 6.0);
  const auto above_path_m = [this] {
    return flight_.autonomy().setpoint.p_W.z() - flight_.truth().body.p_W.z();
  };
  change("altitude_offset 1.5");
  run_to(sim::to_seconds(flight_.now()) + 0.1);
  EXPECT_LT(above_path_m(), -1.0) << "it is to climb";
  run_to(sim::to_seconds(flight_.now()) + 5.0);
  EXPECT_NEAR(above_path_m(), 0.0, 0.3);
  change("altitude_offset 0");
  run_to(sim::to_seconds(flight_.now()) + 0.1);
  EXPECT_GT(above_path_m(), 1.0) << "and down again";
}

TEST_F(SteeringTest, AKeyOfAutonomyIsInForceFromTheNextStepAndInTheVehicleFile) {
  const auto config = [this]() -> const autonomy::multirotor::FlightConfig& {
    return dynamic_cast<MultirotorGuidance&>(flight_.guidance()).manager().config();
  };
  const std::string before = flight_.vehicle_text();
  change("tune limits.tilt_deg 12");
  EXPECT_NEAR(config().controller.max_tilt_rad, 0.20944, 1e-5);
  EXPECT_EQ(config().follower.max_tilt_rad, config().controller.max_tilt_rad) << "shared";
  EXPECT_NE(flight_.vehicle_text(), before);
  change("tune landing.speed_m_s 1.95");
  change("tune landing.touchdown_speed_m_s 1.9");
  EXPECT_EQ(config().states.landing.touchdown_speed_m_s, 1.9) << "beside what was tuned before";
  EXPECT_NEAR(config().controller.max_tilt_rad, 0.20944, 1e-5);
  change("tune limits.distance_m 2000");
  EXPECT_NE(flight_.vehicle_text().find("tilt_deg: 12"), std::string::npos);
}

TEST_F(SteeringTest, AVehicleTunedInFlightFliesByIt) {
  const auto largest_tilt_rad = [this](double until_s) {
    double largest = 0.0;
    while (sim::to_seconds(flight_.now()) < until_s) {
      flight_.step();
      const sim::Vector3 down_B = flight_.truth().body.q_WB.conjugate() * sim::Vector3::UnitZ();
      largest = std::max(largest, std::acos(std::min(1.0, down_B.z())));
    }
    return largest;
  };
  while (!flight_.autonomy().tracking) flight_.step();
  const double start_s = sim::to_seconds(flight_.now());
  EXPECT_GT(largest_tilt_rad(start_s + 4.0), 0.2);
  change("tune limits.tilt_deg 3");
  largest_tilt_rad(start_s + 5.0);
  EXPECT_LT(largest_tilt_rad(start_s + 12.0), 0.08);
}

TEST(TuneFixedWing, ItsGainsChangeToo) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  const FlightSetup setup{choice};
  Flight flight{setup};
  const auto& manager = dynamic_cast<FixedWingGuidance&>(flight.guidance()).manager();
  ASSERT_NE(manager.config().controller.max_roll_rad, 0.5235987755982988);
  parse_change("tune limits.roll_deg 50", flight)(flight);
  EXPECT_NEAR(manager.config().controller.max_roll_rad, 0.87266, 1e-5);
  EXPECT_EQ(manager.config().follower.max_roll_ff_rad, manager.config().controller.max_roll_rad);
}

TEST_F(SteeringTest, OtherTextsAreRefusedWithWhatIsAllowed) {
  for (const char* text : {"",
                           "dance",
                           "heal now",
                           "wind",
                           "wind 41,0",
                           "gust 5,0",
                           "gust 5,0,1,2",
                           "gust 5,0,0",
                           "gust 5,0,61",
                           "fault",
                           "fault baro@3",
                           "fault baro:0",
                           "switch arm",
                           "switch roll on",
                           "stick arm 1",
                           "stick roll 1.1",
                           "stick roll nan",
                           "hold",
                           "keep_altitude",
                           "keep_altitude yes",
                           "altitude_offset",
                           "altitude_offset 3.1",
                           "altitude_offset nan",
                           "altitude_offset up",
                           "board",
                           "board broken",
                           "land here",
                           "tune",
                           "tune limits.tilt_deg",
                           "tune limits.tilt_deg 61",
                           "tune limits.tilt_deg 1\n2",
                           "wind 5\n,0",
                           "tune limits.tilt 20",
                           "tune limits.tilt_deg [20]",
                           "tune estimator.initial_s 3",
                           "tune landing.touchdown_speed_m_s 1.9",
                           "tune limits.distance_m 100"}) {
    EXPECT_THROW(parse_change(text, flight_), config::Error) << text;
  }
}

}  // namespace
}  // namespace rosflight::flight
