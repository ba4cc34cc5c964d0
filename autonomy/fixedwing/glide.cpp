// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/glide.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMinFinal_m = 50.0;
constexpr double kFinalStep_m = 5.0;
constexpr int kFinals = 81;  // up to 450 m
constexpr double kArcStep_rad = 0.2;
constexpr int kCourses = 8;

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

double GlidePlanner::turn_height_m() const {
  const double v = config_.airspeed_m_s;
  const double bank = std::atan(v * v / (config_.gravity_m_s2 * config_.radius_m));
  return 2.0 * kPi * config_.radius_m / config_.ratio * std::pow(std::cos(bank), -1.5);
}

double GlidePlanner::height_needed_m(const Pose& from, const Pose& key, double final_m,
                                     const Vector2& wind_m_s) const {
  const double v = config_.airspeed_m_s;
  const double bank = std::atan(v * v / (config_.gravity_m_s2 * config_.radius_m));
  const double turning = std::pow(std::cos(bank), -1.5);
  double height_m =
      std::max(final_m - config_.flare_m, 0.0) / distance_per_height(key.course_rad, wind_m_s);
  for (const DubinsPath::Part& part : shortest_dubins_path(from, key, config_.radius_m).parts) {
    if (part.radius_m == 0.0) {
      height_m += part.length_m / distance_per_height(part.start.course_rad, wind_m_s);
      continue;
    }
    const double swept = part.length_m / part.radius_m;
    const int steps = std::max(static_cast<int>(std::ceil(std::abs(swept) / kArcStep_rad)), 1);
    for (int k = 0; k < steps; ++k) {
      const double course = part.start.course_rad + swept * (k + 0.5) / steps;
      height_m += turning * part.length_m / steps / distance_per_height(course, wind_m_s);
    }
  }
  return height_m;
}

std::optional<GlidePath> GlidePlanner::on_course(const Pose& from, double height_m,
                                                 const Field& field, double course_rad,
                                                 const Vector2& wind_m_s) const {
  std::optional<GlidePath> best;
  for (int k = 0; k < kFinals; ++k) {
    const double final_m = kMinFinal_m + kFinalStep_m * k;
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
  for (int k = 0; k < kCourses; ++k) {
    // The preferred course, the opposite one, then those between.
    constexpr std::array<int, kCourses> kOrder{0, 4, 1, 7, 2, 6, 3, 5};
    const double course = preferred + 2.0 * kPi / kCourses * kOrder.at(static_cast<std::size_t>(k));
    std::optional<GlidePath> path = on_course(from, height_m, field, course, wind_m_s);
    if (!path) continue;
    if (path->spare_m > turn_height_m()) return {};  // a turn first
    return path;
  }
  return {};
}

bool GlidePlanner::out_of_reach(const Pose& from, double height_m, const Field& field,
                                const Vector2& wind_m_s) const {
  const Vector2 to_aim = field.aim_W.head<2>() - from.p_m;
  return to_aim.norm() >
         height_m * distance_per_height(course_of(to_aim), wind_m_s) + config_.flare_m;
}

}  // namespace rosflight::autonomy::fixedwing
