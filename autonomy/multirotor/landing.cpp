// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/landing.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kSettle_s = 1.0;     // the descent builds up first
constexpr double kTooSlow = 0.4;      // share of the commanded descent
constexpr double kBelowHover = 0.97;  // standing still with less thrust: on the ground
constexpr double kFalling_m_s = 0.4;  // no ground under it
constexpr double kUnloaded = 0.2;     // share of the hover thrust
constexpr double kStill_m_s = 0.2;
constexpr double kStill_s = 0.3;

}  // namespace

void Landing::start() {
  since_start_s_ = slow_s_ = still_s_ = thrust_N_ = 0.0;
  unloading_ = false;
}

double Landing::descent_speed(double height_m) const {
  const double share = std::clamp(height_m / config_.slow_height_m, 0.0, 1.0);
  const double profile =
      config_.touchdown_speed_m_s + share * (config_.speed_m_s - config_.touchdown_speed_m_s);
  return std::min(profile, std::max(config_.acceleration_m_s2 * since_start_s_, 0.05));
}

Landing::Output Landing::step(const Input& in) {
  const double dt_s = std::clamp(in.dt_s, 0.0, 0.1);
  since_start_s_ += dt_s;
  Output out;
  out.down_speed_m_s = descent_speed(in.height_m);
  if (!unloading_) {
    const bool slow = in.down_speed_m_s < kTooSlow * out.down_speed_m_s &&
                      in.thrust_N < kBelowHover * in.hover_thrust_N;
    const bool stands = (slow || in.at_ground) && since_start_s_ > kSettle_s;
    slow_s_ = stands ? slow_s_ + dt_s : 0.0;
    if (slow_s_ < config_.contact_s) return out;
    unloading_ = true;
    still_s_ = 0.0;
    thrust_N_ = in.thrust_N;
  }
  if (in.down_speed_m_s > kFalling_m_s && !in.at_ground) {
    unloading_ = false;
    slow_s_ = 0.0;
    return out;
  }
  thrust_N_ = std::max(thrust_N_ - in.hover_thrust_N * dt_s / config_.unload_s, 0.0);
  const bool still = thrust_N_ <= kUnloaded * in.hover_thrust_N &&
                     (std::abs(in.down_speed_m_s) < kStill_m_s || in.at_ground);
  still_s_ = still ? still_s_ + dt_s : 0.0;
  out.unloading = true;
  out.thrust_N = thrust_N_;
  out.touched = still_s_ >= kStill_s;
  return out;
}

}  // namespace rosflight::autonomy::multirotor
