// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/glide.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMinFinal_m = 50.0;  // and no shorter than the radius of turns, for the planner
constexpr double kFinalStep_m = 5.0;
constexpr int kFinals = 81;  // up to 450 m
constexpr double kArcStep_rad = 0.2;
constexpr int kCourses = 16;
constexpr double kUncertain_m = 2.0;    // height that gusts and an inexact glide ratio take or give
constexpr double kShareBySpeed = 0.03;  // of a path's height, used up by airspeed on top of it
constexpr double kClearly = 0.8;  // share of the miss of a course with which a later one is better

/// n^(3/2) of a turn over ground. The heading turns by Vg^2/(V r cos c) with the crab angle c, so
/// down the wind the bank is steeper than in still air.
double turn_cost(double airspeed_m_s, double over_ground_m_s, double across_wind_m_s,
                 double radius_m, double gravity_m_s2) {
  const double sin_crab = std::clamp(across_wind_m_s / airspeed_m_s, -0.9, 0.9);
  const double tan_bank = over_ground_m_s * over_ground_m_s /
                          (gravity_m_s2 * radius_m * std::sqrt(1.0 - sin_crab * sin_crab));
  return std::pow(1.0 + tan_bank * tan_bank, 0.75);
}

double ground_speed(double airspeed_m_s, double course_rad, const Vector2& wind_m_s) {
  const double along_wind = wind_m_s.dot(along(course_rad));
  const double across = wind_m_s.dot(right_of(course_rad));
  const double forward_sq = airspeed_m_s * airspeed_m_s - across * across;
  return std::max(along_wind + std::sqrt(std::max(forward_sq, 0.0)), kMinOverGround * airspeed_m_s);
}

}  // namespace

double GlidePlanner::distance_per_height(double course_rad, const Vector2& wind_m_s) const {
  return config_.ratio * ground_speed(config_.airspeed_m_s, course_rad, wind_m_s) /
         config_.airspeed_m_s;
}

double GlidePlanner::final_height_m(double final_m, double course_rad,
                                    const Vector2& wind_m_s) const {
  return (final_m + config_.beyond_m) / distance_per_height(course_rad, wind_m_s) -
         config_.flare_m / config_.ratio;
}

double GlidePlanner::arc_height_m(double length_m, double course_rad,
                                  const Vector2& wind_m_s) const {
  const double v = config_.airspeed_m_s;
  return length_m / distance_per_height(course_rad, wind_m_s) *
         turn_cost(v, ground_speed(v, course_rad, wind_m_s), wind_m_s.dot(right_of(course_rad)),
                   config_.radius_m, config_.gravity_m_s2);
}

double GlidePlanner::turn_height_m() const {
  return arc_height_m(2.0 * kPi * config_.radius_m, 0.0, Vector2::Zero());
}

double GlidePlanner::height_needed_m(const Pose& from, const Pose& key, double final_m,
                                     const Vector2& wind_m_s) const {
  double height_m = std::max(final_height_m(final_m, key.course_rad, wind_m_s), 0.0);
  for (const DubinsPath::Part& part : shortest_dubins_path(from, key, config_.radius_m).parts) {
    if (part.radius_m == 0.0) {
      height_m += part.length_m / distance_per_height(part.start.course_rad, wind_m_s);
      continue;
    }
    const double swept = part.length_m / part.radius_m;
    const int steps = std::max(static_cast<int>(std::ceil(std::abs(swept) / kArcStep_rad)), 1);
    for (int k = 0; k < steps; ++k) {
      const double course = part.start.course_rad + swept * (k + 0.5) / steps;
      height_m += arc_height_m(part.length_m / steps, course, wind_m_s);
    }
  }
  return height_m;
}

std::optional<GlidePath> GlidePlanner::on_course(const Pose& from, double height_m,
                                                 const Field& field, double course_rad,
                                                 const Vector2& wind_m_s) const {
  std::optional<GlidePath> best;
  for (int k = 0; k < kFinals; ++k) {
    const double final_m = std::max(kMinFinal_m, config_.radius_m) + kFinalStep_m * k;
    GlidePath path;
    path.aim_W = field.aim_W;
    path.final_m = final_m;
    path.key = {field.aim_W.head<2>() - final_m * along(course_rad), wrap_angle(course_rad)};
    path.height_needed_m = height_needed_m(from, path.key, final_m, wind_m_s);
    path.spare_m = height_m - path.height_needed_m;
    if (path.spare_m >= 0.0 && (!best || path.spare_m < best->spare_m)) best = path;
  }
  return best;
}

std::optional<GlidePath> GlidePlanner::plan(const Pose& from, double height_m, const Field& field,
                                            const Vector2& wind_m_s) const {
  const double straight = course_of(field.aim_W.head<2>() - from.p_m);
  const double preferred =
      field.course_rad.value_or(wind_m_s.norm() > 1.0 ? course_of(-wind_m_s) : straight);
  std::optional<GlidePath> best;
  double least_m = 0.0;
  for (int k = 0; k < kCourses; ++k) {
    const double course = preferred + 2.0 * kPi / kCourses * k;
    std::optional<GlidePath> path = on_course(from, height_m, field, course, wind_m_s);
    if (!path) continue;
    const double over_m = std::max(path->spare_m - kShareBySpeed * path->height_needed_m, 0.0);
    const double miss_m = (over_m + kUncertain_m) * distance_per_height(course, wind_m_s);
    if (best && miss_m > kClearly * least_m) continue;
    least_m = miss_m;
    best = path;
  }
  if (best && best->spare_m > turn_height_m()) return {};  // a turn first
  return best;
}

bool GlidePlanner::out_of_reach(const Pose& from, double height_m, const Field& field,
                                const Vector2& wind_m_s) const {
  const Vector2 to_aim = field.aim_W.head<2>() - from.p_m;
  return to_aim.norm() >
         height_m * distance_per_height(course_of(to_aim), wind_m_s) + config_.flare_m;
}

}  // namespace rosflight::autonomy::fixedwing
