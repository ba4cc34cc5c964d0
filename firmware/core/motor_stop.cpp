// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/motor_stop.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kStillRate_rad_s = 0.15f;
constexpr float kStillAccel_m_s2 = 0.1f * kGravity_m_s2;
// What the ground may give when the thrust that carried most of the weight goes.
constexpr float kSettlingRate_rad_s = 0.5f;
constexpr float kSettlingAccel_m_s2 = 0.25f * kGravity_m_s2;

constexpr float kSmoothing = 1.0f / 16.0f;  // 40 ms at 400 Hz: vibration is not motion

}  // namespace

/// NaN is motion.
bool MotorStop::without_motion(const Input& in, bool settling) {
  const bool finite = std::isfinite(in.accel_m_s2.sum());
  if (finite) smooth_accel_ += kSmoothing * (in.accel_m_s2 - smooth_accel_);
  const float rate = settling ? kSettlingRate_rad_s : kStillRate_rad_s;
  const float accel = settling ? kSettlingAccel_m_s2 : kStillAccel_m_s2;
  return finite && in.rates_rad_s.squaredNorm() < rate * rate &&
         std::abs(smooth_accel_.norm() - kGravity_m_s2) < accel;
}

void MotorStop::step(Time now, const Input& in) {
  if (stopped()) return;
  const bool still = without_motion(in, probing_ && now - probe_since_ < kSettling);
  if (config_.tip_over) watch_tilt(now, in);
  if (config_.impact) watch_impact(now, in, still);
  if (!config_.fixed_wing) watch_rest(now, in, still);
}

void MotorStop::watch_tilt(Time now, const Input& in) {
  const Quaternion& q = in.q_WB;
  const float cos_tilt = 1.0f - 2.0f * (q.x * q.x + q.y * q.y);
  if (!in.throttle_commanded || cos_tilt > kTipOverCosine) {
    tilted_ = false;
    return;
  }
  if (!tilted_) tilted_since_ = now;
  tilted_ = true;
  if (now - tilted_since_ >= kTipOverTime) stop(StopReason::kTipOver);
}

void MotorStop::watch_impact(Time now, const Input& in, bool still) {
  if (in.accel_m_s2.squaredNorm() > kImpact_m_s2 * kImpact_m_s2) {
    const bool alone = hard_samples_ == 0 || now - hard_at_ > kImpactApart;
    hard_samples_ = alone ? 1 : kImpactSamples;
    hard_at_ = now;
    if (!alone) {
      hit_ = true;
      hit_at_ = now;
      still_after_hit_ = false;
    }
  }
  if (!hit_) return;
  if (now - hit_at_ > kImpactWindow) {
    hit_ = false;
    return;
  }
  if (still && !still_after_hit_) still_since_ = now;
  still_after_hit_ = still;
  if (still && now - still_since_ >= kImpactStillness) stop(StopReason::kImpact);
}

void MotorStop::smooth_altitude(Time now, const Input& in) {
  const float dt_s = hal::seconds(now - altitude_at_);
  const float share = altitude_known_ ? dt_s / (kAltitudeTime_s + dt_s) : 1.0f;
  altitude_m_ += share * (in.altitude_m - altitude_m_);
  altitude_at_ = now;
  altitude_known_ = in.failsafe;
}

void MotorStop::watch_rest(Time now, const Input& in, bool still) {
  smooth_altitude(now, in);
  if (!in.failsafe || !still) {
    resting_ = probing_ = false;
    return;
  }
  if (!resting_) {
    resting_ = true;
    rest_since_ = now;
    lowest_m_ = highest_m_ = altitude_m_;
  }
  lowest_m_ = std::min(lowest_m_, altitude_m_);
  highest_m_ = std::max(highest_m_, altitude_m_);
  if (highest_m_ - lowest_m_ > kAltitudeBand_m) {
    resting_ = probing_ = false;
    return;
  }
  if (probing_) {
    if (now - probe_since_ >= kProbe) stop(StopReason::kFailsafeAtRest);
  } else if (now - rest_since_ >= kFailsafeRest) {
    probing_ = true;
    probe_since_ = now;
  }
}

}  // namespace rosflight::core
