// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/flight_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flight/report/flight_charts.hpp"
#include "flight/report/status_lanes.hpp"

namespace rosflight::report {
namespace {

Sample at(double t_s) {
  Sample sample;
  sample.t_s = t_s;
  return sample;
}

TEST(FlightRecord, KeepsSamplesAtItsInterval) {
  FlightRecord record(0.01);
  for (int k = 0; k <= 4000; ++k) record.add(at(0.0025 * k));  // 10 s at 400 Hz.
  EXPECT_EQ(record.samples().size(), 1001U);
  EXPECT_NEAR(record.samples().back().t_s, 10.0, 1e-9);
}

TEST(FlightRecord, TheSameStateAgainIsNoChange) {
  FlightRecord record;
  record.set_state("Firmware", 0.0, "armed", Tone::kGood);
  record.set_state("Firmware", 1.0, "armed", Tone::kGood);
  record.set_state("Errors", 1.5, "", Tone::kBad);
  record.set_state("Firmware", 2.0, "disarmed", Tone::kNeutral);
  ASSERT_EQ(record.lanes().size(), 2U);
  ASSERT_EQ(record.lanes()[0].changes.size(), 2U);
  EXPECT_EQ(record.lanes()[0].changes[1].t_s, 2.0);
}

TEST(FlightRecord, EndsWithTheLastThingThatHappened) {
  FlightRecord record;
  EXPECT_EQ(record.end_s(), 0.0);
  record.add(at(3.0));
  EXPECT_EQ(record.end_s(), 3.0);
  record.add_event(4.0, Tone::kNote, "a", "b");
  EXPECT_EQ(record.end_s(), 4.0);
  record.set_state("lane", 5.0, "x", Tone::kNote);
  EXPECT_EQ(record.end_s(), 5.0);
}

TEST(Unwrapped, TurnsGoOnPastHalf) {
  constexpr double kPi = std::numbers::pi;
  const auto out = unwrapped({3.0, -3.0, std::nan(""), -2.9, 3.1, -3.1});
  EXPECT_DOUBLE_EQ(out[1], -3.0 + 2 * kPi);
  EXPECT_TRUE(std::isnan(out[2]));
  EXPECT_DOUBLE_EQ(out[3], -2.9 + 2 * kPi);
  EXPECT_DOUBLE_EQ(out[4], 3.1);
  EXPECT_DOUBLE_EQ(out[5], -3.1 + 2 * kPi);
}

TEST(Unwrapped, ACommandStaysBesideWhatFollowsIt) {
  constexpr double kPi = std::numbers::pi;
  const std::vector<double> actual{0.0, 3.0, 6.0, 9.0};
  const auto command = unwrapped({0.1, -3.1, -0.2, 2.8}, &actual);
  EXPECT_DOUBLE_EQ(command[1], -3.1 + 2 * kPi);
  EXPECT_DOUBLE_EQ(command[2], -0.2 + 2 * kPi);
  EXPECT_DOUBLE_EQ(command[3], 2.8 + 2 * kPi);
}

TEST(StatusLanes, BitsHaveTheNamesOfTheStatusMessage) {
  // ROSflight 2.x, Status: error_code and rc_override.
  EXPECT_EQ(error_names(0), "");
  EXPECT_EQ(error_names(0x01), "invalid mixer");
  EXPECT_EQ(error_names(0x02), "IMU silent");
  EXPECT_EQ(error_names(0x04), "RC lost");
  EXPECT_EQ(error_names(0x08), "unhealthy estimator");
  EXPECT_EQ(error_names(0x10), "time going backwards");
  EXPECT_EQ(error_names(0x20), "uncalibrated IMU");
  EXPECT_EQ(error_names(0x40), "buffer overrun");
  EXPECT_EQ(error_names(0x80), "invalid failsafe");
  EXPECT_EQ(error_names(0x24), "RC lost, uncalibrated IMU");
  EXPECT_EQ(override_names(0x001), "attitude switch");
  EXPECT_EQ(override_names(0x002), "throttle switch");
  EXPECT_EQ(override_names(0x01C), "roll stick, pitch stick, yaw stick");
  EXPECT_EQ(override_names(0x020), "lower throttle");
  EXPECT_EQ(override_names(0x3C0), "");  // The companion is silent: nobody overrides it.
}

TEST(StatusLanes, AStatusFillsTheLanes) {
  FlightRecord record;
  link::Status status;
  record_status(record, 0.0, status);
  status.armed = true;
  status.offboard = true;
  status.control_mode = 2;
  record_status(record, 1.0, status);
  status.failsafe = true;
  status.error_code = 0x04;
  record_status(record, 2.0, status);
  const auto labels = [&](std::size_t lane) {
    std::string out;
    for (const StateChange& change : record.lanes()[lane].changes) out += change.label + ";";
    return record.lanes()[lane].name + ": " + out;
  };
  ASSERT_EQ(record.lanes().size(), 4U);
  EXPECT_EQ(labels(0), "Firmware: disarmed;armed;failsafe;");
  EXPECT_EQ(labels(1), "Control: pilot;offboard, angles;");
  EXPECT_EQ(labels(2), "Override: ;");
  EXPECT_EQ(labels(3), "Errors: ;RC lost;");
}

}  // namespace
}  // namespace rosflight::report
