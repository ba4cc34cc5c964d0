// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/limits_input.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rosflight_common {
namespace {

using autonomy::FlightEventType;
using rosflight_msgs::msg::BatteryStatus;

/// Six cells of 8 A h, 20 milliohm.
autonomy::BatteryConfig pack() {
  autonomy::BatteryConfig out;
  out.cells = 6.0;
  out.capacity_Ah = 8.0;
  out.resistance_ohm = 0.02;
  return out;
}

BatteryStatus measured(float voltage_V, float current_A) {
  BatteryStatus out;
  out.voltage = voltage_V;
  out.current = current_A;
  return out;
}

rosflight_msgs::msg::Fence fence(double radius_m, double height_m) {
  rosflight_msgs::msg::Fence out;
  out.radius = radius_m;
  out.height = height_m;
  return out;
}

autonomy::Status status_of(const LimitsInput& in, double now_s) {
  autonomy::Status out;
  in.fill(now_s, out);
  return out;
}

TEST(LimitsInput, ABatteryIsFreshForTwoSeconds) {
  LimitsInput in(pack());
  EXPECT_FALSE(status_of(in, 0.0).battery_fresh) << "nothing came";
  in.take(measured(24.0F, 12.0F), 100.0);
  EXPECT_TRUE(status_of(in, 100.0).battery_fresh);
  EXPECT_EQ(status_of(in, 101.9).battery_voltage_V, 24.0);
  EXPECT_EQ(status_of(in, 101.9).battery_current_A, 12.0);
  EXPECT_TRUE(status_of(in, 101.9).battery_fresh);
  EXPECT_FALSE(status_of(in, 102.1).battery_fresh);
  EXPECT_EQ(status_of(in, 102.1).battery_voltage_V, 24.0) << "the throttle goes on by it";
  EXPECT_FALSE(status_of(in, 50.0).battery_fresh) << "the clock was set back";
}

TEST(LimitsInput, ANumberThatIsNotFiniteIsNoMeasurement) {
  LimitsInput in(pack());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  in.take(measured(24.0F, 12.0F), 100.0);
  in.take(measured(nan, 12.0F), 101.0);
  in.take(measured(24.0F, nan), 101.0);
  EXPECT_FALSE(status_of(in, 102.5).battery_fresh);
  EXPECT_EQ(status_of(in, 102.5).battery_voltage_V, 24.0);
}

TEST(LimitsInput, AFenceIsTakenOnceAndNaNEndsIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LimitsInput in(pack());
  EXPECT_FALSE(in.take(fence(nan, nan))) << "there was none before";
  EXPECT_EQ(in.fence_text(), "fence: none");
  EXPECT_TRUE(in.take(fence(200.0, 90.0)));
  EXPECT_FALSE(in.take(fence(200.0, 90.0)));
  ASSERT_TRUE(in.fence());
  EXPECT_EQ(in.fence_text(), "fence: 200 m around the start, 90 m high");
  EXPECT_TRUE(in.take(fence(200.0, 80.0)));
  EXPECT_TRUE(in.take(fence(nan, nan)));
  EXPECT_FALSE(in.fence());
  for (const double bad : {0.0, -1.0, nan}) EXPECT_FALSE(fence_of(fence(bad, 90.0))) << bad;
}

TEST(LimitsInput, AFenceIsTheSameThereAndBack) {
  const autonomy::Fence given{200.0, 90.0};
  EXPECT_EQ(fence_of(message_of(given)), given);
  EXPECT_FALSE(fence_of(message_of({})));
}

TEST(LimitsInput, TakeOffIsRefusedByAPackOfOtherCells) {
  LimitsInput in(pack());
  EXPECT_EQ(in.takeoff_fault(100.0), "") << "not measured";
  EXPECT_EQ(in.not_judged(100.0),
            "battery: found no voltage: the flight does not end when it is low");
  in.take(measured(16.8F, 1.0F), 100.0);
  EXPECT_NE(in.takeoff_fault(100.0).find("6 cells of the vehicle file"), std::string::npos);
  EXPECT_EQ(in.not_judged(100.0), "");
  in.take(measured(25.2F, 1.0F), 100.0);
  EXPECT_EQ(in.takeoff_fault(100.0), "");
  in.take(measured(0.0F, 0.0F), 100.0);
  EXPECT_EQ(in.takeoff_fault(100.0), "");
  EXPECT_NE(in.not_judged(100.0), "");
  EXPECT_EQ(LimitsInput({}).not_judged(100.0), "") << "a supply that never ends";
}

TEST(LimitsInput, ADecisionIsOneLineWithItsNumbers) {
  LimitsInput in(pack());
  in.take(measured(22.06F, 10.0F), 100.0);
  in.take(fence(200.0, 90.0));
  EXPECT_EQ(in.text(FlightEventType::kBatteryReturn, 100.0, 0.171),
            "battery low: returns (3.71 V in each of 6 cells at rest, 17 % of 8 A h left)");
  EXPECT_EQ(in.text(FlightEventType::kBatteryLand, 110.0, 0.05),
            "battery low: lands (5 % of 8 A h left)")
      << "the voltage is old";
  EXPECT_EQ(in.text(FlightEventType::kFenceCrossed, 100.0, 1.0),
            "outside of the fence: returns (200 m around the start, 90 m high)");
  EXPECT_EQ(in.text(FlightEventType::kPilotGaveBack, 100.0, 1.0), "pilot gave back");
}

/// The messages, through FlightLimits, as the stacks connect them.
TEST(LimitsInput, WhatItGivesLetsAFlightWarnReturnAndLand) {
  LimitsInput in(pack());
  autonomy::FlightLimits limits;
  limits.start(in.battery(), {});
  std::vector<FlightEventType> decided;
  double t_s = 100.0;
  const auto fly = [&](double seconds, float voltage_V, double east_m) {
    for (int k = 0; k < 10 * static_cast<int>(seconds); ++k) {
      t_s += 0.1;
      in.take(measured(voltage_V, 0.0F), t_s);
      autonomy::FlightEvents events;
      limits.step(status_of(in, t_s), {0.0, east_m, -10.0}, 0.1, events);
      for (const auto& event : events) decided.push_back(event.type);
    }
  };
  fly(4.0, 6.0F * 3.74F, 10.0);
  EXPECT_FALSE(limits.asks_return());
  in.take(fence(50.0, 90.0));
  limits.set_fence(in.fence());
  fly(1.0, 6.0F * 3.74F, 51.0);
  EXPECT_TRUE(limits.asks_return());
  fly(4.0, 6.0F * 3.71F, 10.0);
  fly(4.0, 6.0F * 3.60F, 10.0);
  EXPECT_TRUE(limits.asks_land());
  EXPECT_EQ(decided, (std::vector{FlightEventType::kBatteryLow, FlightEventType::kFenceCrossed,
                                  FlightEventType::kBatteryReturn, FlightEventType::kBatteryLand}));
}

}  // namespace
}  // namespace rosflight_common
