// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/path_follower.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kNoDirection = 1e-6;
constexpr double kNearCentre_m = 1.0;

double ground_speed(const StateEstimate& state) {
  return state.v_W.head<2>().norm();
}

}  // namespace

double PathFollower::roll_ff(const StateEstimate& state, double course_rate_rad_s) const {
  const double drift = std::clamp(wrap_angle(state.course_rad - heading_of(state.q_WB)),
                                  -config_.max_wind_angle_rad, config_.max_wind_angle_rad);
  const double roll =
      std::atan(ground_speed(state) * course_rate_rad_s / (config_.gravity_m_s2 * std::cos(drift)));
  return std::clamp(roll, -config_.max_roll_ff_rad, config_.max_roll_ff_rad);
}

ControllerCommand PathFollower::follow_line(const StateEstimate& state,
                                            const CurrentPath& path) const {
  ControllerCommand out;
  const Vector2 flat = path.q_W.head<2>();
  const double level = flat.norm();
  if (!(level > kNoDirection)) return out;  // straight up or down: no course
  const double chi_q = course_of(flat);
  const Vector2 d = (state.p_W - path.r_W).head<2>();
  const double e_m = d.dot(right_of(chi_q));
  const double ke = config_.line_gain_1_m * e_m;
  const double vg = ground_speed(state);
  const double off = wrap_angle(state.course_rad - chi_q);
  out.course_rad = wrap_angle(chi_q - config_.approach_rad * (2.0 / kPi) * std::atan(ke));
  out.roll_ff_rad = roll_ff(state, -config_.approach_rad * (2.0 / kPi) * config_.line_gain_1_m *
                                       vg * std::sin(off) / (1.0 + ke * ke));
  out.valid = true;
  const double slope = -path.q_W.z() / level;
  out.height_m = -path.r_W.z() + slope * d.dot(along(chi_q));
  out.climb_ff_m_s = slope * vg * std::cos(off);
  return out;
}

ControllerCommand PathFollower::follow_circle(const StateEstimate& state,
                                              const CurrentPath& path) const {
  ControllerCommand out;
  if (!(path.radius_m > 0.0) || path.turn == 0) return out;
  const double turn = path.turn > 0 ? 1.0 : -1.0;
  const Vector2 d = (state.p_W - path.c_W).head<2>();
  const double distance_m = std::max(d.norm(), kNearCentre_m);
  const double phi = d.norm() > kNoDirection ? course_of(d) : state.course_rad;
  const double x = config_.circle_gain * (distance_m - path.radius_m) / path.radius_m;
  const double vg = ground_speed(state);
  const double off = state.course_rad - phi;
  out.course_rad = wrap_angle(phi + turn * (0.5 * kPi + std::atan(x)));
  out.roll_ff_rad =
      roll_ff(state, vg * std::sin(off) / distance_m + turn * config_.circle_gain / path.radius_m *
                                                           vg * std::cos(off) / (1.0 + x * x));
  out.valid = true;
  out.height_m = -path.c_W.z();
  out.climb_ff_m_s = path.slope * vg * std::cos(wrap_angle(state.course_rad - out.course_rad));
  return out;
}

ControllerCommand PathFollower::step(const StateEstimate& state, const CurrentPath& path,
                                     double path_age_s) const {
  const bool good = path.valid && path_age_s >= 0.0 && path_age_s <= config_.timeout_s &&
                    std::isfinite(state.p_W.sum() + state.v_W.sum() + state.course_rad);
  if (!good) return {};
  ControllerCommand out = path.circle ? follow_circle(state, path) : follow_line(state, path);
  out.airspeed_m_s = path.airspeed_m_s;
  out.valid = out.valid && path.airspeed_m_s > 0.0 &&
              std::isfinite(out.course_rad + out.height_m + out.roll_ff_rad + out.climb_ff_m_s);
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
