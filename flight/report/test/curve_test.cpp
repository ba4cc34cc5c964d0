// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace rosflight::report {
namespace {

const double kNan = std::nan("");

std::string time_curve(const std::vector<Point>& points) {
  std::string out;
  append_time_curve(out, points);
  return out;
}

std::string track(const std::vector<Point>& points, double tolerance) {
  std::string out;
  append_track(out, points, tolerance);
  return out;
}

/// The vertices of path data made of M and L.
std::vector<Point> vertices(std::string data) {
  std::replace_if(data.begin(), data.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
  std::vector<Point> out;
  const char* at = data.c_str();
  for (char* end = nullptr;; at = end) {
    const double x = std::strtod(at, &end);
    if (end == at) break;
    at = end;
    out.push_back({x, std::strtod(at, &end)});
  }
  return out;
}

TEST(TimeCurve, FewPointsStayAsTheyAre) {
  EXPECT_EQ(time_curve({{0, 1}, {1, 2}, {2, 0.5}}), "M0 1L1 2L2 0.5");
}

TEST(TimeCurve, OfOnePixelTheLowestAndHighestStayInTheirOrder) {
  EXPECT_EQ(time_curve({{5.0, 3}, {5.1, 9}, {5.2, 4}, {5.3, 1}, {5.4, 2}, {6.0, 2}}),
            "M5.1 9L5.3 1L6 2");
}

TEST(TimeBand, GoesRoundEachRunAndIsAsWideAsTheWidestOfAPixel) {
  const std::vector<Point> lower{{0, 5}, {1, 6}, {1.5, 8}, {2, kNan}, {3, 5}, {4, 5}};
  const std::vector<Point> upper{{0, 1}, {1, 2}, {1.5, 3}, {2, 1}, {3, 1}, {4, 1}};
  std::string out;
  append_time_band(out, lower, upper);
  EXPECT_EQ(out, "M0 5L1 8L1 2L0 1ZM3 5L4 5L4 1L3 1Z");
}

TEST(TimeCurve, NoSpikeIsLostInALongFlight) {
  std::vector<Point> points;
  points.reserve(1'000'000);
  for (int k = 0; k < 1'000'000; ++k) points.push_back({5e-4 * k, 50.0 + std::sin(0.37 * k)});
  points[123'456].y = -7.0;
  points[777'777].y = 107.0;
  const std::string data = time_curve(points);
  EXPECT_NE(data.find(" -7L"), std::string::npos);
  EXPECT_NE(data.find(" 107L"), std::string::npos);
  EXPECT_LT(data.size(), 500U * 2U * 14U);  // Two points per pixel at 14 characters.
}

TEST(TimeCurve, GapsLiftThePenAndLonePointsAreDots) {
  EXPECT_EQ(time_curve({{0, 1}, {1, 2}, {2, kNan}, {3, 5}, {4, kNan}, {5, 6}, {6, 7}}),
            "M0 1L1 2M3 5h0M5 6L6 7");
  EXPECT_EQ(time_curve({{0, kNan}}), "");
  EXPECT_EQ(time_curve({}), "");
  EXPECT_EQ(time_curve({{3, 4}}), "M3 4h0");
}

TEST(TimeCurve, OfALevelLineOnlyTheEndsAreWritten) {
  std::vector<Point> points;
  for (int k = 0; k <= 100; ++k) points.push_back({static_cast<double>(k), k < 50 ? 1.0 : 2.0});
  EXPECT_EQ(time_curve(points), "M0 1L49 1L50 2L100 2");
}

TEST(Track, StraightLinesAreTheirEnds) {
  std::vector<Point> points;
  for (int k = 0; k <= 200; ++k) points.push_back({0.5 * k, 0.25 * k});
  EXPECT_EQ(track(points, 0.15), "M0 0L100 50");
}

TEST(Track, StaysWithinItsTolerance) {
  constexpr double kTolerance = 0.15;
  std::vector<Point> points;
  for (int k = 0; k < 20'000; ++k) {
    const double angle = 4.0 * std::numbers::pi * k / 20'000.0;
    points.push_back({200.0 + 150.0 * std::cos(angle), 200.0 + 100.0 * std::sin(2.0 * angle)});
  }
  const std::vector<Point> kept = vertices(track(points, kTolerance));
  EXPECT_LT(kept.size(), 400U);
  for (std::size_t k = 0; k < points.size(); k += 7) {
    double nearest = 1e9;
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      const double dx = kept[i + 1].x - kept[i].x;
      const double dy = kept[i + 1].y - kept[i].y;
      const double share =
          ((points[k].x - kept[i].x) * dx + (points[k].y - kept[i].y) * dy) / (dx * dx + dy * dy);
      const double t = std::clamp(share, 0.0, 1.0);
      nearest = std::min(
          nearest, std::hypot(points[k].x - kept[i].x - t * dx, points[k].y - kept[i].y - t * dy));
    }
    // Twice the tolerance (points closer than it are skipped first) and the rounding of the
    // coordinates.
    ASSERT_LT(nearest, 2.0 * kTolerance + 0.01) << k;
  }
}

TEST(Track, GapsAndLonePoints) {
  EXPECT_EQ(
      track({{0, 0}, {10, 0}, {kNan, 0}, {20, 20}, {kNan, kNan}, {kNan, 1}, {5, 5}, {6, 9}}, 0.1),
      "M0 0L10 0M20 20h0M5 5L6 9");
  EXPECT_EQ(track({}, 0.1), "");
  EXPECT_EQ(track({{1, 1}, {1, 1}, {1, 1}}, 0.1), "M1 1h0");
}

}  // namespace
}  // namespace rosflight::report
