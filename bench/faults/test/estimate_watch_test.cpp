// SPDX-License-Identifier: BSD-3-Clause
// What counts as an estimate that reports its errors; no flight.
#include "bench/faults/estimate_watch.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rosflight::bench::faults {
namespace {

using Sigmas = Eigen::Matrix<double, 9, 1>;

/// Samples twenty times a second: `off_m` from `begin_s` to `end_s`.
void fly(EstimateWatch& watch, double begin_s, double end_s, double off_m, bool unreliable) {
  for (int k = 0; begin_s + 0.05 * k < end_s; ++k) {
    watch.sample(begin_s + 0.05 * k, Sigmas::Zero(), off_m, unreliable);
  }
}

/// Whether the flight counts as one whose position was off, and as one that reported it in time.
void expect_case(const EstimateWatch& watch, unsigned far, unsigned in_time) {
  EXPECT_EQ(watch.count().far, far);
  EXPECT_EQ(watch.count().in_time, in_time);
}

TEST(EstimateWatch, AStateIsOutsideBeyondThreeOfItsOwnSigmas) {
  EstimateWatch watch(0.0);
  Sigmas sigmas = Sigmas::Zero();
  sigmas(1) = -3.01;
  sigmas(4) = 2.99;
  sigmas(6) = std::numeric_limits<double>::quiet_NaN();
  watch.sample(0.0, sigmas, 0.0, false);
  sigmas.setZero();
  sigmas(6) = 4.0;
  watch.sample(0.05, sigmas, 0.0, false);
  const EstimateCount count = watch.count();
  EXPECT_EQ(count.samples, 2U);
  EXPECT_EQ(count.outside, (std::array<std::uint64_t, 9>{0, 1, 0, 0, 0, 0, 2, 0, 0}));
  EXPECT_EQ(count.worst(), 6U);
  EXPECT_EQ(count.worst_share(), 1.0);
  EXPECT_EQ(EstimateCount{}.worst_share(), 0.0);
}

TEST(EstimateWatch, AReportWithinTenSecondsIsInTime) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 5.0, 14.0, false);
  fly(watch, 5.0, 14.0, 16.0, false);
  fly(watch, 14.0, 30.0, 40.0, true);
  expect_case(watch, 1, 1);
  EXPECT_EQ(watch.count().said, 1U);
}

TEST(EstimateWatch, AReportAfterTenSecondsIsTooLate) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 10.3, 16.0, false);
  fly(watch, 10.3, 30.0, 40.0, true);
  expect_case(watch, 1, 0);
}

TEST(EstimateWatch, AReportThatIsTakenBackTooEarlyIsNone) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 2.0, 16.0, true);
  fly(watch, 2.0, 12.2, 16.0, false);
  expect_case(watch, 1, 0);
}

TEST(EstimateWatch, AnErrorThatPassesBeforeTenSecondsIsNoCase) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 9.0, 16.0, false);
  fly(watch, 9.0, 9.5, 3.0, false);
  fly(watch, 9.5, 19.0, 16.0, false);
  expect_case(watch, 0, 0);
  EXPECT_EQ(watch.count().said, 0U);
}

TEST(EstimateWatch, AReportWithoutAnErrorIsNoCaseAndIsCounted) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 1.0, 0.5, true);
  EXPECT_EQ(watch.count().far, 0U);
  EXPECT_EQ(watch.count().said, 1U);
}

TEST(EstimateWatch, CountsOfFlightsAdd) {
  EstimateWatch watch(0.0);
  fly(watch, 0.0, 11.0, 16.0, false);
  EstimateCount sum = watch.count();
  sum.add(watch.count());
  EXPECT_EQ(sum.samples, 2 * watch.count().samples);
  EXPECT_EQ(sum.far, 2U);
  EXPECT_EQ(sum.in_time, 0U);
}

}  // namespace
}  // namespace rosflight::bench::faults
