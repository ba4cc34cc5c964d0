// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/longitudinal.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kMin_m_s = 1.0;

double climb_angle(double climb_m_s, double airspeed_m_s) {
  return std::asin(std::clamp(climb_m_s / std::max(airspeed_m_s, kMin_m_s), -0.9, 0.9));
}

/// A loop around zero on top of a feed-forward, in the limits of the sum.
double on_top(Pid& pid, double feed_forward, double low, double high, double error, double rate,
              double dt_s) {
  pid.set_limits({low - feed_forward, high - feed_forward});
  return feed_forward + pid.step_with_rate(error, 0.0, -rate, dt_s);
}

double known_throttle(const LongitudinalLaw::Input& in) {
  return std::clamp(in.throttle_ff, in.min_throttle, in.max_throttle);
}

}  // namespace

SuccessiveLoops::SuccessiveLoops(const SuccessiveLoopConfig& config)
    : config_(config), height_(config.height), airspeed_(config.airspeed) {}

LongitudinalLaw::Output SuccessiveLoops::step(const Input& in) {
  const double error_m = std::clamp(in.height_c_m - in.height_m, -config_.max_height_error_m,
                                    config_.max_height_error_m);
  Output out;
  out.climb_angle_rad =
      on_top(height_, climb_angle(in.climb_ff_m_s, in.airspeed_m_s), in.min_climb_rad,
             in.max_climb_rad, error_m, in.climb_ff_m_s - in.climb_m_s, in.dt_s);
  out.throttle = known_throttle(in);
  if (in.airspeed_known) {
    out.throttle = on_top(airspeed_, in.throttle_ff, in.min_throttle, in.max_throttle,
                          in.airspeed_c_m_s - in.airspeed_m_s, -in.airspeed_rate_m_s2, in.dt_s);
  }
  return out;
}

void SuccessiveLoops::reset() {
  height_.reset();
  airspeed_.reset();
}

TotalEnergy::TotalEnergy(const TotalEnergyConfig& config)
    : config_(config), energy_(config.energy), balance_(config.balance) {}

LongitudinalLaw::Output TotalEnergy::step(const Input& in) {
  const double g = config_.gravity_m_s2;
  const double v = in.airspeed_m_s;
  const double v_c = std::max(in.airspeed_c_m_s, kMin_m_s);
  const double reference = 0.5 * v_c * v_c;
  const double potential = g * std::clamp(in.height_c_m - in.height_m, -config_.max_height_error_m,
                                          config_.max_height_error_m);
  const double potential_rate = g * (in.climb_ff_m_s - in.climb_m_s);
  const double kinetic = in.airspeed_known ? 0.5 * (v_c * v_c - v * v) : 0.0;
  const double kinetic_rate = in.airspeed_known ? -v * in.airspeed_rate_m_s2 : 0.0;
  Output out;
  out.throttle = known_throttle(in);
  if (in.airspeed_known) {
    out.throttle = on_top(energy_, in.throttle_ff, in.min_throttle, in.max_throttle,
                          (potential + kinetic) / reference,
                          (potential_rate + kinetic_rate) / reference, in.dt_s);
  }
  out.climb_angle_rad =
      on_top(balance_, climb_angle(in.climb_ff_m_s, v), in.min_climb_rad, in.max_climb_rad,
             (potential - in.speed_share * kinetic) / reference,
             (potential_rate - in.speed_share * kinetic_rate) / reference, in.dt_s);
  return out;
}

void TotalEnergy::reset() {
  energy_.reset();
  balance_.reset();
}

}  // namespace rosflight::autonomy::fixedwing
