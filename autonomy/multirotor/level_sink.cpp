// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/level_sink.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kPole_rad_s = 0.8;
constexpr double kGain_s_m = 0.25;  // share of the thrust per error of the vertical speed
constexpr double kMinShare = 0.85;
constexpr double kMaxShare = 1.15;
constexpr double kBaroGone_s = 1.0;
constexpr double kGroundSlack_m = 0.1;  // of the range, above what it reads on the ground
constexpr double kUnload_s = 2.0;       // from the thrust that hovers to none

}  // namespace

void LevelSink::start(const LandingConfig& config, const Start& from) {
  *this = LevelSink{};
  from_ = from;
  landing_ = Landing(config);
  landing_.start();
  up_m_s_ = -from.down_speed_m_s;
  thrust_N_ = from.hover_thrust_N;
  silent_s_ = kBaroGone_s;
}

void LevelSink::interrupt() {
  interrupted_ = true;
  up_m_s_ = 0.0;
}

void LevelSink::correct(double baro_up_m, double dt_s) {
  if (interrupted_ && baro_known_) up_m_ = baro_up_m - baro_origin_m_;
  if (!baro_known_ || silent_s_ >= kBaroGone_s) baro_origin_m_ = baro_up_m - up_m_;
  baro_known_ = true;
  silent_s_ = 0.0;
  const double error_m = baro_up_m - baro_origin_m_ - up_m_;
  up_m_ += 3.0 * kPole_rad_s * error_m * dt_s;
  up_m_s_ += 3.0 * kPole_rad_s * kPole_rad_s * error_m * dt_s;
  bias_m_s2_ += kPole_rad_s * kPole_rad_s * kPole_rad_s * error_m * dt_s;
}

bool LevelSink::by_baro() const {
  return silent_s_ < kBaroGone_s;
}

void LevelSink::observe(const RawMotion& raw, double dt_s) {
  double force_m_s2 = from_.gravity_m_s2 * thrust_N_ / from_.hover_thrust_N;
  if (raw.a_B) force_m_s2 = -(raw.q_WB.value_or(Quaternion::Identity()) * *raw.a_B).z();
  up_m_ += up_m_s_ * dt_s;
  up_m_s_ += (force_m_s2 - from_.gravity_m_s2 + bias_m_s2_) * dt_s;
  silent_s_ = std::min(silent_s_ + dt_s, kBaroGone_s);
  if (raw.baro_up_m) correct(*raw.baro_up_m, dt_s);
  interrupted_ = false;
}

LevelSink::Output LevelSink::land(double dt_s, bool at_ground) {
  const Landing::Output landing = landing_.step(
      {dt_s, -up_m_s_, from_.height_m + up_m_, thrust_N_, from_.hover_thrust_N, at_ground});
  const double share = 1.0 + kGain_s_m * (-landing.down_speed_m_s - up_m_s_);
  thrust_N_ = landing.unloading ? landing.thrust_N
                                : from_.hover_thrust_N * std::clamp(share, kMinShare, kMaxShare);
  return {thrust_N_, landing.touched};
}

/// Starts and ends the unloading of a vehicle that Landing cannot see the ground for.
void LevelSink::watch_ground(const RawMotion& raw, double dt_s) {
  constexpr double kContact_s = 0.4;
  constexpr double kStands_m = 0.5;
  constexpr double kStands_s = 3.0;
  if (raw.baro_up_m) {
    const double moved_m = *raw.baro_up_m - still_up_m_;
    still_s_ += dt_s;
    if (std::abs(moved_m) > kStands_m) {
      still_s_ = 0.0;
      still_up_m_ = *raw.baro_up_m;
      unloads_ = unloads_ && moved_m > 0.0;  // it falls: that was no ground
    }
  }
  unloads_ = unloads_ || at_ground_s_ > kContact_s || (by_baro() && still_s_ > kStands_s);
}

LevelSink::Output LevelSink::sink(const RawMotion& raw, double dt_s) {
  watch_ground(raw, dt_s);
  if (unloads_) {
    thrust_N_ = std::max(thrust_N_ - from_.hover_thrust_N * dt_s / kUnload_s, 0.0);
    return {thrust_N_, thrust_N_ == 0.0};
  }
  double share = 1.0 + kGain_s_m * (-kBlind_m_s - up_m_s_);
  if (!by_baro()) {
    if (raw.a_B && without_baro_s_ < kIntegrates_s) {
      constexpr double kMean_s = 2.0;
      without_baro_s_ += dt_s;
      steady_share_ += (share - steady_share_) * dt_s / kMean_s;
    } else {
      share = without_baro_s_ > 0.0 ? steady_share_ - kMargin : kShare;
    }
    const double latest_s = kSpare_s + std::max(from_.height_m, 0.0) / kSlowest_m_s;
    const double late_share =
        std::clamp(share, kMinShare, kMaxShare) - kFall_1_s * std::max(since_s_ - latest_s, 0.0);
    unloads_ = late_share < kNone;
    thrust_N_ = from_.hover_thrust_N * late_share;
    return {thrust_N_, false};
  }
  thrust_N_ = from_.hover_thrust_N * std::clamp(share, kMinShare, kMaxShare);
  return {thrust_N_, false};
}

LevelSink::Output LevelSink::step(const RawMotion& raw, std::optional<double> range_m,
                                  double dt_s) {
  dt_s = std::clamp(dt_s, 0.0, 0.1);
  since_s_ += dt_s;
  observe(raw, dt_s);
  const bool at_ground =
      range_m && from_.standing_range_m && *range_m < *from_.standing_range_m + kGroundSlack_m;
  at_ground_s_ = at_ground ? at_ground_s_ + dt_s : 0.0;
  return by_baro() && raw.a_B && !unloads_ ? land(dt_s, at_ground) : sink(raw, dt_s);
}

}  // namespace rosflight::autonomy::multirotor
