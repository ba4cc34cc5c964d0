// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/temperature_watch.hpp"

#include <gtest/gtest.h>

namespace rosflight::boards::parts {
namespace {

using Report = TemperatureWatch::Report;

hal::Time at_s(int s) {
  return hal::milliseconds(1000 * s);
}
constexpr float kelvin(float degC) {
  return 273.15f + degC;
}

TEST(TemperatureWatch, WarnsOnceAboveItsLimit) {
  TemperatureWatch watch;
  EXPECT_EQ(watch.step(kelvin(104.9f), false, at_s(1)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(105.1f), false, at_s(11)), Report::kWarning);
  EXPECT_EQ(watch.step(kelvin(120.0f), false, at_s(21)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(104.0f), false, at_s(31)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(106.0f), false, at_s(41)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(106.0f), true, at_s(51)), Report::kRecord) << "in flight it goes on";
}

TEST(TemperatureWatch, WarnsInFlightWithinItsPeriod) {
  TemperatureWatch watch;
  EXPECT_EQ(watch.step(kelvin(50.0f), true, at_s(0)), Report::kRecord);
  EXPECT_EQ(watch.step(kelvin(110.0f), true, at_s(9)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(110.0f), true, at_s(10)), Report::kWarning);
}

TEST(TemperatureWatch, RecordsEveryTenSecondsInFlight) {
  TemperatureWatch watch;
  int records = 0;
  for (int s = 0; s < 60; ++s) {
    const bool armed = s >= 25;
    const Report report = watch.step(kelvin(50.0f), armed, at_s(s));
    EXPECT_NE(report, Report::kWarning);
    if (report != Report::kRecord) continue;
    EXPECT_TRUE(armed);
    ++records;
  }
  EXPECT_EQ(records, 3) << "30, 40, 50 s";
}

TEST(TemperatureWatch, WhatIsNotMeasuredIsNotReported) {
  TemperatureWatch watch;
  EXPECT_EQ(watch.step(0.0f, true, at_s(20)), Report::kNone);
  EXPECT_EQ(watch.step(kelvin(-40.0f), true, at_s(21)), Report::kRecord) << "at once";
}

}  // namespace
}  // namespace rosflight::boards::parts
