// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/estimator.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::estimation {
namespace {

constexpr double kMinPressure_Pa = 20e3;
constexpr double kMaxPressure_Pa = 115e3;

}  // namespace

// ---- samples in

void Estimator::add(const ImuSample& sample) {
  constexpr double kMaxGyro_rad_s = 50.0;
  constexpr double kMaxAccel_m_s2 = 500.0;
  if (!std::isfinite(sample.t_s) || !(sample.gyro_rad_s.norm() < kMaxGyro_rad_s) ||
      !(sample.accel_m_s2.norm() < kMaxAccel_m_s2)) {
    reject_unusable();
    return;
  }
  constexpr double kLong_s = 0.5;
  const bool long_hole = sample.t_s - imu_.last().t_s > kLong_s;
  const ImuBuffer::Taken taken = imu_.add(sample, filter().state().gyro_bias_B);
  if (taken == ImuBuffer::Taken::kTooOld || taken == ImuBuffer::Taken::kTooNew) {
    take_other_clock(sample);
    return;
  }
  misfits_.count = 0;
  if (!health().initialised) {
    window_.add(sample);
    if (taken == ImuBuffer::Taken::kFull) try_start();
    return;
  }
  if (taken == ImuBuffer::Taken::kFirst) fusion_.set_time(sample.t_s);
  if (taken == ImuBuffer::Taken::kFull) {
    if (long_hole) attitude_lost_s_ = sample.t_s;
    advance(sample.t_s - lag_s_);
    if (imu_.full()) advance(imu_.front().end_s());
  }
}

/// Counts a sample that does not fit the clock; once several have come in order the clock is theirs.
void Estimator::take_other_clock(const ImuSample& sample) {
  constexpr int kEnough = 5;
  constexpr double kBreak_s = 0.1;
  reject_unusable();
  const double since_s = sample.t_s - misfits_.t_s;
  const bool in_order = since_s > 0.0 && since_s < kBreak_s;
  misfits_.count = misfits_.count > 0 && in_order ? misfits_.count + 1 : 1;
  misfits_.t_s = sample.t_s;
  if (misfits_.count < kEnough) return;
  misfits_.count = 0;
  if (!health().initialised) {
    restart();
    return;
  }
  const bool later = sample.t_s > imu_.last().t_s;
  const double by_s = sample.t_s - imu_.last().t_s - (later ? ImuBuffer::kMaxHole_s : kBreak_s);
  imu_.shift(by_s);
  fusion_.shift(by_s);
  queued_ = 0;
  next_s_ = {-1e9, -1e9, -1e9};
  next_rest_s_ = -1e9;
  hint_.t_s = -1e9;
  if (attitude_lost_s_) *attitude_lost_s_ += by_s;
  add(sample);
}

void Estimator::add(const GnssSample& sample) {
  const bool position_ok = std::abs(sample.position.latitude_deg) <= 90.0 &&
                           std::abs(sample.position.longitude_deg) <= 360.0 &&
                           std::abs(sample.position.altitude_m) < 1e5;
  if (!sample.fix_3d) return;
  if (!position_ok || !(sample.v_W_m_s.norm() < 1e3) || !std::isfinite(sample.t_s)) {
    reject_unusable();
    return;
  }
  if (!fusion_.reference().declination_rad)
    fusion_.reference().declination_rad = declination(sample);
  if (!health().initialised) return window_.add(sample);
  allow_for_delay(sample.t_s);
  queue(sample);
}

void Estimator::add(const PoseSample& sample) {
  if (!config().use_pose) return;
  constexpr double kMax_m = 1e6;
  const double norm = sample.q_WB.norm();
  const bool a_pose = sample.p_W.norm() < kMax_m && std::abs(norm - 1.0) < 1e-3;
  if (!a_pose || !std::isfinite(sample.t_s)) {
    reject_unusable();
    return;
  }
  if (!health().initialised) return window_.add(sample);
  allow_for_delay(sample.t_s);
  queue(sample);
}

void Estimator::allow_for_delay(double t_s) {
  constexpr int kEnough = 3;
  constexpr double kMargin_s = 0.03;
  const double age_s = imu_.last().t_s - t_s;
  const bool late = age_s > lag_s_ && age_s + kMargin_s < config().max_lag_s;
  delayed_ = late ? delayed_ + 1 : 0;
  if (delayed_ < kEnough) return;
  delayed_ = 0;
  lag_s_ = age_s + kMargin_s;
}

void Estimator::add(const BaroSample& sample) {
  const bool on_earth =
      sample.pressure_Pa > kMinPressure_Pa && sample.pressure_Pa < kMaxPressure_Pa;
  if (!on_earth) {
    reject_unusable();
    return;
  }
  if (!health().initialised) return window_.add(sample);
  if (sample.t_s < next_s_[1]) return;
  next_s_[1] = sample.t_s + config().baro_interval_s - 1e-6;
  queue(sample);
}

void Estimator::add(const MagSample& sample) {
  const double strength_T = sample.field_T.norm();
  const bool a_field = strength_T > 1e-6 && strength_T < 1e-2;  // the earth's is 22 to 67 uT
  if (!a_field) {
    reject_unusable();
    return;
  }
  if (!health().initialised) return window_.add(sample);
  if (sample.t_s < next_s_[0]) return;
  next_s_[0] = sample.t_s + config().mag_interval_s - 1e-6;
  queue(sample);
}

void Estimator::add(const RangeSample& sample) {
  if (!config().use_range || !health().initialised) return;
  // Many sensors report their limit where there is no echo, or one that is nearer.
  constexpr double kSigmas = 3.0;
  const double margin_m = kSigmas * config().range_sigma_m;
  const bool echoed =
      sample.range_m > sample.min_m + margin_m && sample.range_m < sample.max_m - margin_m;
  if (!echoed) return;
  RangeSample echo = sample;
  echo.t_s -= config().range_delay_s;
  queue(echo);
}

void Estimator::add(const PitotSample& sample) {
  if (fixed_wing()) {
    if (!std::isfinite(sample.pressure_Pa)) {
      reject_unusable();
      return;
    }
    if (!health().initialised || sample.t_s < next_s_[2]) return;
    next_s_[2] = sample.t_s + config().pitot_interval_s - 1e-6;
    queue(sample);
  }
}

void Estimator::add(const SideslipSample& sample) {
  if (health().initialised && std::isfinite(sample.v_air_y_m_s)) queue(sample);
}

void Estimator::set_attitude_hint(double t_s, const Quaternion& q_WB, bool with_heading) {
  const double norm = q_WB.norm();
  const bool a_rotation = norm > 0.5 && norm < 2.0;
  if (!a_rotation || !std::isfinite(t_s)) return;
  hint_.t_s = t_s;
  hint_.q_WB = q_WB.normalized();
  if (!attitude_lost_s_ || filter_time_s() < *attitude_lost_s_) return;
  attitude_lost_s_.reset();
  // That of the flight controller: by gyro and accelerometer alone in between.
  constexpr double kTilt_rad = 0.15;
  constexpr double kHeading_rad = 0.3;
  const Quaternion shown = estimate().q_WB;
  const double turned_rad = with_heading ? 0.0 : heading_of(shown) - heading_of(hint_.q_WB);
  const Quaternion wanted = Eigen::AngleAxisd(turned_rad, Vector3::UnitZ()) * hint_.q_WB;
  fusion_.correct_attitude(log_rotation(shown.conjugate() * wanted), kTilt_rad, kHeading_rad);
}

/// Into the queue, which is in order of time; what the filter has passed already is too late.
void Estimator::queue(const AidSample& sample) {
  constexpr double kSlack_s = 1e-4;
  const double t_s = std::visit([](const auto& s) { return s.t_s; }, sample);
  const bool from_the_future = t_s > imu_.last().t_s + 1.0;
  if (t_s < filter_time_s() - kSlack_s || from_the_future || queued_ == kQueue ||
      !std::isfinite(t_s)) {
    ++fusion_.health().late;
    return;
  }
  std::size_t at = queued_++;
  for (; at > 0 && queue_[at - 1].t_s > t_s; --at) queue_[at] = queue_[at - 1];
  queue_[at] = {t_s, sample};
}

void Estimator::advance(double target_s) {
  std::size_t done = 0;
  while (imu_.size() > 0 && imu_.front().end_s() <= target_s + 1e-9) {
    const double end_s = imu_.front().end_s();
    if (done < queued_ && queue_[done].t_s < end_s) {
      const double t_s = queue_[done].t_s;
      if (t_s > filter_time_s() + 1e-6) fusion_.predict(imu_.take(t_s));
      fusion_.fuse(queue_[done++].sample, imu_.last().t_s);
      continue;
    }
    fusion_.predict(imu_.front());
    imu_.pop();
    if (at_rest_ && filter_time_s() >= next_rest_s_) {
      next_rest_s_ = filter_time_s() + config().rest_interval_s - 1e-6;
      fusion_.fuse_rest();
    }
  }
  if (done > 0) {
    std::move(queue_.begin() + static_cast<std::ptrdiff_t>(done),
              queue_.begin() + static_cast<std::ptrdiff_t>(queued_), queue_.begin());
    queued_ -= done;
  }
  fusion_.health().gnss_age_s = filter_time_s() - fusion_.aided_s();
  fusion_.guard();
}

void Estimator::restart() {
  imu_.forget();
  attitude_lost_s_.reset();
  misfits_ = {};
  lag_s_ = config().lag_s;
  delayed_ = 0;
  queued_ = 0;
  next_s_ = {-1e9, -1e9, -1e9};
  next_rest_s_ = -1e9;
  window_.clear();
  hint_ = {};
  fusion_.reset();
}

}  // namespace rosflight::autonomy::estimation
