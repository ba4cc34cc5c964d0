// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/battery_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "autonomy/common/flight_limits.hpp"

namespace rosflight::autonomy {
namespace {

/// Six cells of 8 A h, 20 milliohm.
BatteryConfig pack() {
  BatteryConfig out;
  out.cells = 6.0;
  out.capacity_Ah = 8.0;
  out.resistance_ohm = 0.02;
  return out;
}

BatteryLevel after(BatteryWatch& watch, double seconds, double cell_at_rest_V, double current_A,
                   bool fresh = true) {
  const double voltage_V = 6.0 * cell_at_rest_V - 0.02 * current_A;
  for (long k = std::lround(seconds / 0.1); k > 0; --k) {
    static_cast<void>(watch.step({voltage_V, current_A, fresh}, 0.1));
  }
  return watch.level();
}

TEST(BatteryWatch, TheChargeIsTheIntegralOfTheCurrent) {
  BatteryWatch watch(pack());
  after(watch, 720.0, 4.0, 20.0);  // 20 A for a fifth of an hour: 4 A h
  EXPECT_NEAR(watch.charge(), 0.5, 1e-3);
  EXPECT_EQ(watch.level(), BatteryLevel::kGood);
  after(watch, 378.0, 4.0, 20.0);  // 2.1 A h more
  EXPECT_NEAR(watch.charge(), 0.2375, 1e-3);
  EXPECT_EQ(watch.level(), BatteryLevel::kWarn);
  EXPECT_EQ(after(watch, 90.0, 4.0, 20.0), BatteryLevel::kReturn);
  EXPECT_EQ(after(watch, 150.0, 4.0, 20.0), BatteryLevel::kLand);
}

TEST(BatteryWatch, TheSagUnderLoadIsNoEmptyBattery) {
  BatteryWatch loaded(pack());
  EXPECT_EQ(after(loaded, 10.0, 3.80, 80.0), BatteryLevel::kGood) << "1.6 V less at the terminals";
  BatteryWatch low(pack());
  EXPECT_EQ(after(low, 10.0, 3.71, 5.0), BatteryLevel::kReturn);
}

TEST(BatteryWatch, ALevelCountsAfterItsTimeAndNeverFallsBack) {
  BatteryWatch watch(pack());
  EXPECT_EQ(after(watch, 2.8, 3.70, 5.0), BatteryLevel::kGood);
  EXPECT_EQ(after(watch, 0.2, 4.00, 5.0), BatteryLevel::kGood);
  EXPECT_EQ(after(watch, 2.8, 3.70, 5.0), BatteryLevel::kGood) << "counted from the start again";
  EXPECT_EQ(after(watch, 0.4, 3.70, 5.0), BatteryLevel::kReturn);
  EXPECT_EQ(after(watch, 60.0, 4.20, 5.0), BatteryLevel::kReturn);
}

TEST(BatteryWatch, ASilentMonitorGoesOnCountingAtItsLastCurrent) {
  BatteryWatch watch(pack());
  after(watch, 10.0, 4.0, 20.0);
  EXPECT_EQ(after(watch, 600.0, 0.0, 0.0, false), BatteryLevel::kGood) << "no voltage is no 0 V";
  EXPECT_NEAR(watch.charge(), 1.0 - 610.0 * 20.0 / (8.0 * 3600.0), 1e-3);
}

TEST(BatteryWatch, APackThatIsNotKnownIsNotJudged) {
  BatteryWatch watch{BatteryConfig{}};
  EXPECT_EQ(after(watch, 1000.0, 1.0, 50.0), BatteryLevel::kGood);
  EXPECT_EQ(watch.charge(), 1.0);
}

/// A full pack, a nearly empty one, and packs of other cells than the file says.
TEST(TakeoffFault, APackThatWouldEndTheFlightAtOnceIsRefusedAndTheCellsAreNamed) {
  const auto with = [](double voltage_V) {
    return takeoff_fault(pack(), {.voltage_V = voltage_V, .current_A = 1.0, .fresh = true});
  };
  EXPECT_EQ(with(25.2), "");
  EXPECT_EQ(with(6.0 * 3.73), "");
  EXPECT_EQ(with(6.0 * 4.35), "") << "a full cell of the higher voltage";
  EXPECT_EQ(
      with(16.8),
      "battery: found 16.8 V, 2.80 V in each of the 6 cells of the vehicle file, allowed 3.72 "
      "to 4.40 V: charge it; battery.cells must be those of the pack");
  EXPECT_NE(with(21.0), "") << "a full pack of five";
  EXPECT_NE(with(6.0 * 3.70), "") << "an empty one of six";
  EXPECT_EQ(
      with(29.4),
      "battery: found 29.4 V, 4.90 V in each of the 6 cells of the vehicle file, allowed 3.72 "
      "to 4.40 V: battery.cells must be those of the pack");
}

TEST(TakeoffFault, WhatIsNotKnownIsNotRefused) {
  EXPECT_EQ(takeoff_fault(pack(), {.voltage_V = 0.0, .current_A = 0.0, .fresh = true}), "");
  EXPECT_EQ(takeoff_fault(pack(), {.voltage_V = 16.8, .current_A = 0.0, .fresh = false}), "");
  EXPECT_EQ(takeoff_fault({}, {.voltage_V = 16.8, .current_A = 0.0, .fresh = true}), "");
}

TEST(TakeoffFault, TheSagOfWhatIsSwitchedOnCounts) {
  const double sagged_V = 6.0 * 3.73 - 0.02 * 5.0;
  EXPECT_EQ(takeoff_fault(pack(), {.voltage_V = sagged_V, .current_A = 5.0, .fresh = true}), "");
}

struct Limited {
  Limited() { limits.start(pack(), Fence{100.0, 50.0}); }
  void fly(double seconds, const Vector3& at_W, double cell_V = 4.0) {
    Status status;
    status.battery_voltage_V = 6.0 * cell_V;
    status.battery_fresh = true;
    for (long k = std::lround(seconds / 0.1); k > 0; --k) {
      FlightEvents events;
      limits.step(status, at_W, 0.1, events);
      for (const FlightEvent& e : events) told.push_back(e.type);
    }
  }
  FlightLimits limits;
  std::vector<FlightEventType> told;
};

TEST(FlightLimits, TheFenceIsACylinderAroundTheStart) {
  const Fence fence{100.0, 50.0};
  EXPECT_TRUE(fence.holds({70.0, 70.0, -50.0}));
  EXPECT_FALSE(fence.holds({71.0, 71.0, -10.0}));
  EXPECT_FALSE(fence.holds({0.0, 0.0, -50.1}));
}

TEST(FlightLimits, OutsideOfTheFenceItReturnsAndSaysSoOnce) {
  Limited flight;
  flight.fly(0.4, {101.0, 0.0, -10.0});
  EXPECT_FALSE(flight.limits.asks_return()) << "noise of a position";
  flight.fly(5.0, {99.0, 0.0, -10.0});
  EXPECT_FALSE(flight.limits.asks_return());
  flight.fly(5.0, {101.0, 0.0, -10.0});
  EXPECT_TRUE(flight.limits.asks_return());
  EXPECT_FALSE(flight.limits.asks_land());
  EXPECT_EQ(flight.told, std::vector{FlightEventType::kFenceCrossed});
}

TEST(FlightLimits, WithoutAPositionTheFenceIsNotJudged) {
  Limited flight;
  flight.fly(5.0, Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(flight.limits.asks_return());
}

TEST(FlightLimits, ABatteryWarnsReturnsAndLands) {
  Limited flight;
  flight.fly(4.0, Vector3::Zero(), 3.74);
  EXPECT_FALSE(flight.limits.asks_return());
  flight.fly(4.0, Vector3::Zero(), 3.71);
  EXPECT_TRUE(flight.limits.asks_return());
  flight.fly(4.0, Vector3::Zero(), 3.60);
  EXPECT_TRUE(flight.limits.asks_land());
  EXPECT_EQ(flight.told, (std::vector{FlightEventType::kBatteryLow, FlightEventType::kBatteryReturn,
                                      FlightEventType::kBatteryLand}));
}

}  // namespace
}  // namespace rosflight::autonomy
