// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/landing.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMinFlare_m = 0.5;

}  // namespace

LandingPath LandingPath::plan(const LandingConfig& config, const Vector3& aim_W, double course_rad,
                              double cruise_m_s, double head_wind_m_s) {
  LandingPath out;
  const double v = config.airspeed_m_s;
  const double vg = std::max(v - head_wind_m_s, kMinOverGround * v);
  const double b = config.flare_time_s * config.touchdown_m_s;
  const double g = config.glide_slope;
  out.flare_height_m = std::max(config.flare_time_s * vg * g - b, kMinFlare_m);
  out.flare_distance_m = vg * config.flare_time_s * std::log((out.flare_height_m + b) / b);
  const double short_m = out.flare_distance_m - out.flare_height_m / g;
  const Vector2 back = -along(course_rad);
  const double ground_m = -aim_W.z();
  const auto place = [&](std::size_t k, double before_m, double height_m, Passing passing) {
    Waypoint& wp = out.waypoints[k];
    wp.p_W << aim_W.head<2>() + before_m * back, -(ground_m + height_m);
    wp.passing = passing;
    wp.course_rad = course_rad;
    wp.airspeed_m_s = k == 0 ? cruise_m_s : v;
  };
  const double slope_m = config.approach_height_m / g;
  place(0, short_m + slope_m + config.level_m, config.approach_height_m, Passing::kDubins);
  place(1, short_m + slope_m, config.approach_height_m, Passing::kLine);
  place(2, short_m, 0.0, Passing::kLine);
  return out;
}

double flare_climb(const LandingConfig& config, double height_m) {
  return -(std::max(height_m, 0.0) / config.flare_time_s + config.touchdown_m_s);
}

}  // namespace rosflight::autonomy::fixedwing
