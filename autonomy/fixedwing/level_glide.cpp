// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/level_glide.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kStill_m = 0.7;  // noise of a barometer
constexpr double kStill_rad_s = 0.1;
constexpr double kAbove_m = 0.5;  // by the range sensor: in the air

}  // namespace

void LevelGlide::start(double height_m, double standing_range_m) {
  *this = LevelGlide{};
  height_m_ = std::max(height_m, 0.0);
  standing_range_m_ = standing_range_m;
}

bool LevelGlide::step(const RawMotion& raw, std::optional<double> range_m, double dt_s) {
  since_s_ += dt_s;
  still_s_ += dt_s;
  const std::optional<double> above_m =
      range_m ? std::optional(*range_m - standing_range_m_) : std::nullopt;
  low_ = above_m && *above_m < kRound_m;
  const bool moves =
      (raw.baro_up_m && still_up_m_ && std::abs(*raw.baro_up_m - *still_up_m_) > kStill_m) ||
      (raw.w_B && raw.w_B->norm() > kStill_rad_s) || (above_m && *above_m > kAbove_m);
  if (moves || !still_up_m_ || !raw.baro_up_m) {
    still_s_ = 0.0;
    still_up_m_ = raw.baro_up_m;
  }
  return still_s_ > kRests_s || since_s_ > kSpare_s + height_m_ / kSlowest_m_s;
}

Controller::Direct LevelGlide::direct(const SafetyConfig& safety) const {
  Controller::Direct out;
  out.roll_rad = 0.0;
  out.throttle = 0.0;
  out.airspeed_by_pitch_m_s = safety.glide_m_s;  // not known: at the pitch of a glide
  if (low_) out.min_pitch_rad = kRound_rad;
  return out;
}

StateEstimate LevelGlide::state(const RawMotion& raw) {
  StateEstimate out;
  out.q_WB = raw.q_WB.value_or(Quaternion::Identity());
  out.w_B = raw.w_B.value_or(Vector3::Zero());
  out.a_B = raw.a_B.value_or(Vector3::Zero());
  out.attitude = Quality::kGood;
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
