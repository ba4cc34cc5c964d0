// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/zones.hpp"

#include <gtest/gtest.h>

#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

/// A controller that receives course, height and airspeed, and nothing else.
struct Bench {
  Bench() { plant.stand(0.0); }
  void run(double seconds) {
    for (long k = 0; k < std::lround(seconds / 0.01); ++k) {
      const auto direct =
          zones.step({plant.time_s(), plant.state(), armed, pilot, command.height_m}, config);
      Surfaces surfaces;
      if (direct) {
        surfaces =
            controller.step({plant.state(), command, 0.0, 0.01, PilotOverride{}, *direct}).surfaces;
      }
      for (int i = 0; i < 4; ++i) plant.step(surfaces, 0.0025);
      if (zones.zone() == AltitudeZone::kTakeOff && armed) bank = std::max(bank, std::abs(roll()));
    }
  }
  double roll() const { return RollPitch::of(plant.state().q_WB).roll_rad; }
  double height() const { return -plant.state().p_W.z(); }

  FlightConfig config = default_config();
  Controller controller{config.controller};
  AltitudeZones zones;
  Plant plant;
  ControllerCommand command{true, 15.0, 60.0, 1.5, 0.0, 0.0};
  bool armed{false};
  bool pilot{false};
  double bank{};
};

TEST(AltitudeZones, TakeOffClimbHoldAndFollowTheCommand) {
  Bench bench;
  bench.run(1.0);
  EXPECT_LT(bench.plant.state().v_W.norm(), 0.5);  // disarmed: stands
  bench.armed = true;
  bench.run(60.0);
  EXPECT_EQ(bench.zones.zone(), AltitudeZone::kHold);
  EXPECT_NEAR(bench.height(), 60.0, 2.0);
  EXPECT_NEAR(wrap_angle(bench.plant.state().course_rad - 1.5), 0.0, 0.05);
  EXPECT_LT(bench.bank, 0.1);
}

/// Points 35 and 37 of the list: low flight and a jump of the height are no take-off.
TEST(AltitudeZones, LowFlightIsNoTakeOffAndThereIsOneTakeOffPerArming) {
  const FlightConfig config = default_config();
  AltitudeZones zones;
  StateEstimate state;
  const auto zone_at = [&](double t_s, double height_m, bool armed = true) {
    state.p_W.z() = -height_m;
    static_cast<void>(zones.step({t_s, state, armed, false, 50.0}, config));
    return zones.zone();
  };
  EXPECT_EQ(zone_at(0.0, 0.0), AltitudeZone::kTakeOff);
  EXPECT_EQ(zone_at(5.0, 4.9), AltitudeZone::kTakeOff);
  EXPECT_EQ(zone_at(6.0, 5.0), AltitudeZone::kClimb);
  EXPECT_EQ(zone_at(7.0, 0.0), AltitudeZone::kClimb);
  EXPECT_EQ(zone_at(9.0, 40.0), AltitudeZone::kHold);
  EXPECT_EQ(zone_at(10.0, 1.0), AltitudeZone::kHold);
  EXPECT_EQ(zone_at(11.0, 0.0, false), AltitudeZone::kTakeOff);
  EXPECT_FALSE(zones.step({12.0, state, false, false, 50.0}, config));
  EXPECT_EQ(zone_at(13.0, 0.0), AltitudeZone::kTakeOff);
}

TEST(AltitudeZones, ArmedInTheAirFliesOn) {
  AltitudeZones zones;
  StateEstimate state;
  state.p_W.z() = -30.0;
  const auto direct = zones.step({0.0, state, true, false, 50.0}, default_config());
  ASSERT_TRUE(direct);
  EXPECT_EQ(zones.zone(), AltitudeZone::kHold);
  EXPECT_FALSE(direct->roll_rad || direct->pitch_rad || direct->throttle);
}

TEST(AltitudeZones, ThePilotsHandStartsTheTakeOffAnew) {
  AltitudeZones zones;
  const FlightConfig config = default_config();
  StateEstimate state;
  const auto throttle = [&](double t_s, bool pilot) {
    return *zones.step({t_s, state, true, pilot, 50.0}, config)->throttle;
  };
  EXPECT_EQ(throttle(0.0, true), 0.0);
  EXPECT_EQ(throttle(10.0, true), 0.0);
  EXPECT_NEAR(throttle(10.5, false), 0.5 / config.takeoff.ramp_s, 1e-9);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
