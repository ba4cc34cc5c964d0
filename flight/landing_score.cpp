// SPDX-License-Identifier: BSD-3-Clause
#include "flight/landing_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "autonomy/common/angles.hpp"

namespace rosflight::flight {
namespace {

using Touchdown = LandingScore::Touchdown;

bool harder(const Touchdown& a, const Touchdown& b) {
  return a.hardest_m_s > b.hardest_m_s;
}

/// The harder one, with the larger bank and tilt of both.
Touchdown worst(const Touchdown& a, const Touchdown& b) {
  Touchdown out = harder(a, b) ? a : b;
  out.tilt_rad = std::max(a.tilt_rad, b.tilt_rad);
  out.bank_rad = std::max(std::abs(a.bank_rad), std::abs(b.bank_rad));
  return out;
}

}  // namespace

void LandingScore::step(const sim::Truth& truth) {
  const double t_s = sim::to_seconds(truth.time);
  const double height_m = -truth.body.p_W.z();
  const sim::Vector3 v_W = truth.body.q_WB * truth.body.v_B;
  tilt_rad_ = std::acos(std::clamp((truth.body.q_WB * sim::Vector3::UnitZ()).z(), -1.0, 1.0));
  const bool contact = truth.on_ground;
  if (!airborne_) {
    if (contact) {
      ground_height_m_ = height_m;
    } else if (height_m > ground_height_m_ + rebound_m_) {
      airborne_ = true;
    }
  } else if (contact && !touchdown_) {
    touchdown_ = Touchdown{t_s,
                           sink_m_s_,
                           sink_m_s_,
                           tilt_rad_,
                           autonomy::RollPitch::of(truth.body.q_WB).roll_rad,
                           truth.body.p_W,
                           std::atan2(v_W.y(), v_W.x())};
    ground_height_m_ = height_m;
  } else if (contact) {
    if (!contact_) touchdown_->hardest_m_s = std::max(touchdown_->hardest_m_s, sink_m_s_);
    ground_height_m_ = height_m;
  } else if (touchdown_ && height_m > ground_height_m_ + rebound_m_) {
    if (rested_) {
      earlier_ = earlier_ ? worst(*earlier_, *touchdown_) : *touchdown_;
    } else {
      ++early_contacts_;
    }
    touchdown_.reset();
    rested_ = false;
  }
  down_for_s_ = contact && touchdown_ ? down_for_s_ + (t_s - last_s_) : 0.0;
  rests_for_s_ = down_for_s_ > 0.0 && v_W.norm() < kRest_m_s ? rests_for_s_ + (t_s - last_s_) : 0.0;
  rested_ = rested_ || rests_for_s_ >= kRest_s;
  contact_ = contact;
  sink_m_s_ = v_W.z();
  last_s_ = t_s;
}

double LandingScore::distance_m(const LandingLimits& limits) const {
  if (!touchdown_) return std::numeric_limits<double>::quiet_NaN();
  return (touchdown_->p_W - limits.aim_W).head<2>().norm();
}

bool LandingScore::inside(const LandingLimits& limits) const {
  if (!touchdown_) return false;
  if (!limits.course_rad) return distance_m(limits) <= limits.half_length_m;
  const sim::Vector3 away = touchdown_->p_W - limits.aim_W;
  const double north = std::cos(*limits.course_rad);
  const double east = std::sin(*limits.course_rad);
  return std::abs(away.x() * north + away.y() * east) <= limits.half_length_m &&
         std::abs(away.y() * north - away.x() * east) <= limits.half_width_m;
}

const LandingScore::Touchdown* LandingScore::hardest() const {
  if (!touchdown_) return nullptr;
  return earlier_ && harder(*earlier_, *touchdown_) ? &*earlier_ : &*touchdown_;
}

bool LandingScore::soft(const LandingLimits& limits) const {
  const auto within = [&limits](const std::optional<Touchdown>& t) {
    return t && t->hardest_m_s <= limits.max_speed_m_s &&
           (limits.max_bank_rad == 0.0 || std::abs(t->bank_rad) <= limits.max_bank_rad);
  };
  return within(touchdown_) && (!earlier_ || within(earlier_)) && !crashed();
}

bool LandingScore::crashed() const {
  if (early_contacts_ > 0) return true;
  const auto breaks = [](const std::optional<Touchdown>& t) {
    return t && (t->hardest_m_s > kCrashSpeed_m_s || t->tilt_rad > kCrashTilt_rad);
  };
  return breaks(earlier_) || breaks(touchdown_) || (touchdown_ && tilt_rad_ > kCrashTilt_rad);
}

}  // namespace rosflight::flight
