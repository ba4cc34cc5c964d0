// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "flight/report/html.hpp"

namespace rosflight::report {
namespace {

Bounds bounds(std::initializer_list<double> values) {
  Bounds out;
  for (const double value : values) out.include(value);
  return out;
}

TEST(Bounds, NotANumberAndInfinityDoNotCount) {
  const Bounds b = bounds({std::nan(""), 2.0, std::numeric_limits<double>::infinity(), -1.0});
  EXPECT_EQ(b.low(), -1.0);
  EXPECT_EQ(b.high(), 2.0);
  EXPECT_TRUE(bounds({std::nan("")}).empty());
}

TEST(RoundStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(round_step(10.0, 4), 2.0);
  EXPECT_DOUBLE_EQ(round_step(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(round_step(0.03, 4), 0.005);
  EXPECT_DOUBLE_EQ(round_step(700.0, 5), 100.0);
}

TEST(ValueAxis, TicksAreRoundAndCoverTheData) {
  const Axis axis = value_axis(bounds({-7.3, 12.1}), 1.0, 100.0, 0.0);
  EXPECT_LE(axis.low, -7.3);
  EXPECT_GE(axis.high, 12.1);
  EXPECT_EQ(axis.step, 5.0);
  EXPECT_EQ(axis.ticks().front(), -10.0);
  EXPECT_EQ(axis.label(-5.0), "-5");
  EXPECT_DOUBLE_EQ(axis.pixel(axis.low), 100.0);
  EXPECT_DOUBLE_EQ(axis.pixel(axis.high), 0.0);
}

TEST(ValueAxis, QuietSignalsAreNotBlownUp) {
  const Axis axis = value_axis(bounds({-5.0001, -5.0}), 2.0, 0.0, 1.0);
  EXPECT_GE(axis.high - axis.low, 2.0);
}

TEST(ValueAxis, WhatCannotBeNegativeStartsAtZero) {
  EXPECT_EQ(value_axis(bounds({0.01, 0.9}), 0.1, 0.0, 1.0).low, 0.0);
  EXPECT_GT(value_axis(bounds({15.6, 16.8}), 0.1, 0.0, 1.0).low, 10.0);
}

TEST(ValueAxis, FewTicksWhateverTheData) {
  for (double low : {-1e12, -1e6, -3.3, 0.0, 1e-9, 5.0, 123456.789, 1e12}) {
    for (double span : {0.0, 1e-12, 1e-3, 0.7, 3.0, 99.0, 1e5, 1e12}) {
      const Axis axis = value_axis(bounds({low, low + span}), 1e-6, 100.0, 0.0);
      const auto count = axis.ticks().size();
      EXPECT_GE(count, 2U) << low << " + " << span;
      EXPECT_LE(count, 12U) << low << " + " << span;
      EXPECT_TRUE(std::isfinite(axis.pixel(low)));
    }
  }
}

TEST(ValueAxis, WithoutDataItIsStillAnAxis) {
  const Axis axis = value_axis(Bounds{}, 4.0, 0.0, 1.0);
  EXPECT_EQ(axis.low, 0.0);
  EXPECT_GE(axis.high, 4.0);
}

TEST(TimeAxis, EndsWithTheFlightAndCountsAsPeopleDo) {
  const Axis minute = time_axis(64.0, 0.0, 1.0);
  EXPECT_EQ(minute.high, 64.0);
  EXPECT_EQ(minute.step, 10.0);
  EXPECT_EQ(time_label(20.0, minute), "20");
  const Axis ten_minutes = time_axis(600.0, 0.0, 1.0);
  EXPECT_EQ(ten_minutes.step, 60.0);
  EXPECT_EQ(time_label(120.0, ten_minutes), "2:00");
  EXPECT_EQ(time_label(485.0, ten_minutes), "8:05");
  EXPECT_EQ(time_unit(ten_minutes), " min");
}

TEST(TimeAxis, AFlightOfNoLengthHasAnAxis) {
  for (const double end : {0.0, -1.0, std::nan("")}) {
    const Axis axis = time_axis(end, 0.0, 1.0);
    EXPECT_GT(axis.high, axis.low);
    EXPECT_LE(axis.ticks().size(), 12U);
  }
}

TEST(Number, IsPlain) {
  EXPECT_EQ(number(1.25, 1), "1.2");  // Halves go to even: 1.25 is exact in binary.
  EXPECT_EQ(number(-0.001, 2), "0.00");
  EXPECT_EQ(number(-12.5, 2), "-12.50");
  EXPECT_EQ(number(3e12, 2), "3.00e+12");
  EXPECT_EQ(number(std::nan(""), 2), "–");
  EXPECT_EQ(number(-std::numeric_limits<double>::infinity(), 2), "–");
}

TEST(Coordinate, HasAtMostHundredths) {
  const auto text = [](double value) {
    std::string out;
    append_coordinate(out, value);
    return out;
  };
  EXPECT_EQ(text(12.0), "12");
  EXPECT_EQ(text(12.5), "12.5");
  EXPECT_EQ(text(0.05), "0.05");
  EXPECT_EQ(text(-0.004), "0");
  EXPECT_EQ(text(-3.149), "-3.15");
  EXPECT_EQ(text(1e300), "1000000");
  EXPECT_EQ(text(std::nan("")), "-1000000");
}

TEST(Escape, EveryCharacterThatMeansSomething) {
  EXPECT_EQ(escape("<a href=\"x\">'&'</a>\xFF"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;?");
}

}  // namespace
}  // namespace rosflight::report
