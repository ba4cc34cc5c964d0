// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/ground_detector.hpp"

#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kStill_m_s = 1.0;
constexpr double kStill_s = 1.0;
constexpr double kTouch_m_s = 0.2;  // a smaller vertical speed is rolling, a larger one sinking
constexpr double kTouch_s = 0.4;
constexpr double kRolling_m = 0.4;  // by the range sensor: wheels, a nose that is up, a small hop
constexpr double kLevelAbove_s = 3.0;
constexpr double kTouchHeight_m = 3.0;  // the ground is at most this much higher than given
constexpr double kMinCosTilt = 0.8;     // beyond this tilt a range is a poor measure of the height

double cos_tilt(const Quaternion& q) {
  return 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y());
}

}  // namespace

double GroundDetector::height_m(const StateEstimate& state, std::optional<double> range_m,
                                double max_range_m, double ground_up_m) {
  const double tilt = cos_tilt(state.q_WB);
  measured_ = range_m && std::isfinite(*range_m) && *range_m >= 0.0 && tilt > kMinCosTilt &&
              *range_m <= max_range_m;
  if (measured_) {
    return *range_m * tilt - standing_range_m_;
  }
  return -ground_up_m - state.p_W.z();
}

bool GroundDetector::on_ground(const StateEstimate& state, double height_m, bool descending,
                               bool flaring, double dt_s) {
  const bool rolls = std::abs(state.v_W.z()) < kTouch_m_s && height_m < kTouchHeight_m;
  level_s_ = descending && rolls ? level_s_ + dt_s : 0.0;
  const bool above = measured_ && height_m > kRolling_m;
  const double needed_s = above ? kLevelAbove_s : (flaring ? kTouch_s : 3.0 * kTouch_s);
  return level_s_ > needed_s;
}

bool GroundDetector::stands(const StateEstimate& state, double dt_s) {
  const bool moves = state.v_W.head<2>().norm() > kStill_m_s;
  still_s_ = moves ? 0.0 : still_s_ + dt_s;
  return still_s_ > kStill_s;
}

}  // namespace rosflight::autonomy::fixedwing
