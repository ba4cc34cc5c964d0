// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/estimator.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::estimation {
namespace {

/// Height in the US Standard Atmosphere 1976 (troposphere): (T0/L) (1 - (p/p0)^(R L/g)).
double standard_height_m(double pressure_Pa) {
  return 44330.77 * (1.0 - std::pow(pressure_Pa / 101325.0, 0.190263));
}
/// Density of the same atmosphere: p/p0 to the power 1 - R L/g.
double standard_density_kg_m3(double pressure_Pa) {
  return 1.225 * std::pow(pressure_Pa / 101325.0, 0.809737);
}

constexpr double kLowestPressure_Pa = 20e3;
constexpr double kHighestPressure_Pa = 115e3;
constexpr double kFreshHint_s = 0.5;

}  // namespace

// ---- samples in

template <bool kWind>
void Estimator<kWind>::add(const ImuSample& sample) {
  constexpr double kMostGyro_rad_s = 50.0;
  constexpr double kMostAccel_m_s2 = 500.0;
  if (!std::isfinite(sample.t_s) || !(sample.gyro_rad_s.norm() < kMostGyro_rad_s) ||
      !(sample.accel_m_s2.norm() < kMostAccel_m_s2)) {
    ++health_.unusable;
    return;
  }
  const ImuBuffer::Taken taken = imu_.add(sample, filter_.state().gyro_bias_B);
  if (taken == ImuBuffer::Taken::kTooOld) {
    ++health_.unusable;
    return;
  }
  if (taken == ImuBuffer::Taken::kJump) {
    ++health_.restarts;
    restart();
    return;
  }
  if (!health_.initialised) {
    window_.add(sample);
    if (taken == ImuBuffer::Taken::kFull) try_start();
    return;
  }
  if (taken == ImuBuffer::Taken::kFirst) filter_s_ = sample.t_s;
  if (taken == ImuBuffer::Taken::kFull) {
    advance(sample.t_s - config_.lag_s);
    if (imu_.full()) advance(imu_.front().end_s());
  }
}

template <bool kWind>
void Estimator<kWind>::add(const GnssSample& sample) {
  const bool place_ok = std::abs(sample.place.latitude_deg) <= 90.0 &&
                        std::abs(sample.place.longitude_deg) <= 360.0 &&
                        std::abs(sample.place.altitude_m) < 1e5;
  if (!sample.fix_3d) return;
  if (!place_ok || !(sample.v_N_m_s.norm() < 1e3) || !std::isfinite(sample.t_s)) {
    ++health_.unusable;
    return;
  }
  if (!declination_rad_) declination_rad_ = declination(sample);
  if (!health_.initialised) return window_.add(sample);
  queue(sample);
}

template <bool kWind>
void Estimator<kWind>::add(const BaroSample& sample) {
  const bool on_earth =
      sample.pressure_Pa > kLowestPressure_Pa && sample.pressure_Pa < kHighestPressure_Pa;
  if (!on_earth) {
    ++health_.unusable;
    return;
  }
  if (!health_.initialised) return window_.add(sample);
  if (sample.t_s < next_s_[1]) return;
  next_s_[1] = sample.t_s + config_.baro_interval_s - 1e-6;
  queue(sample);
}

template <bool kWind>
void Estimator<kWind>::add(const MagSample& sample) {
  const double strength_T = sample.field_T.norm();
  const bool a_field = strength_T > 1e-6 && strength_T < 1e-2;  // the earth's is 22 to 67 uT
  if (!a_field) {
    ++health_.unusable;
    return;
  }
  if (!health_.initialised) return window_.add(sample);
  if (sample.t_s < next_s_[0]) return;
  next_s_[0] = sample.t_s + config_.mag_interval_s - 1e-6;
  queue(sample);
}

template <bool kWind>
void Estimator<kWind>::add(const RangeSample& sample) {
  if (!config_.use_range || !health_.initialised) return;
  const bool echoed = sample.range_m > sample.min_m && sample.range_m < sample.max_m;
  if (!echoed) return;
  RangeSample echo = sample;
  echo.t_s -= config_.range_delay_s;
  queue(echo);
}

template <bool kWind>
void Estimator<kWind>::add(const PitotSample& sample) {
  if constexpr (kWind) {
    if (!std::isfinite(sample.pressure_Pa)) {
      ++health_.unusable;
      return;
    }
    if (!health_.initialised || sample.t_s < next_s_[2]) return;
    next_s_[2] = sample.t_s + config_.pitot_interval_s - 1e-6;
    queue(sample);
  }
}

template <bool kWind>
void Estimator<kWind>::add(const SideslipSample& sample) {
  if (health_.initialised && std::isfinite(sample.v_air_y_m_s)) queue(sample);
}

template <bool kWind>
void Estimator<kWind>::set_attitude_hint(double t_s, const Quaternion& q_NB) {
  const double norm = q_NB.norm();
  const bool a_rotation = norm > 0.5 && norm < 2.0;
  if (!a_rotation || !std::isfinite(t_s)) return;
  hint_.t_s = t_s;
  hint_.q_NB = q_NB.normalized();
}

template <bool kWind>
double Estimator<kWind>::time_of(const Sample& sample) {
  return std::visit([](const auto& s) { return s.t_s; }, sample);
}

/// Into the queue, which is in order of time; what the filter has passed already is too late.
template <bool kWind>
void Estimator<kWind>::queue(const Sample& sample) {
  constexpr double kSlack_s = 1e-4;
  const double t_s = time_of(sample);
  const bool from_the_future = t_s > imu_.last().t_s + 1.0;
  if (t_s < filter_s_ - kSlack_s || from_the_future || queued_ == kQueue || !std::isfinite(t_s)) {
    ++health_.late;
    return;
  }
  std::size_t at = queued_++;
  for (; at > 0 && queue_[at - 1].t_s > t_s; --at) queue_[at] = queue_[at - 1];
  queue_[at] = {t_s, sample};
}

// ---- the filter, lag_s behind

template <bool kWind>
void Estimator<kWind>::advance(double target_s) {
  std::size_t done = 0;
  while (imu_.size() > 0 && imu_.front().end_s() <= target_s + 1e-9) {
    const double end_s = imu_.front().end_s();
    if (done < queued_ && queue_[done].t_s < end_s) {
      const double t_s = queue_[done].t_s;
      if (t_s > filter_s_ + 1e-6) predict(imu_.take(t_s));
      fuse(queue_[done++].sample);
      continue;
    }
    predict(imu_.front());
    imu_.pop();
    if (at_rest_ && filter_s_ >= next_rest_s_) fuse_rest();
  }
  if (done > 0) {
    std::move(queue_.begin() + static_cast<std::ptrdiff_t>(done),
              queue_.begin() + static_cast<std::ptrdiff_t>(queued_), queue_.begin());
    queued_ -= done;
  }
  const double aided_s = std::max(health_.of(Aid::kGnssVelocity).last_accepted_s,
                                  health_.of(Aid::kGnssHorizontal).last_accepted_s);
  health_.gnss_age_s = filter_s_ - aided_s;
}

template <bool kWind>
void Estimator<kWind>::predict(const ImuBuffer::Segment& segment) {
  filter_.predict(segment.u, config_.noise, config_.gravity_m_s2);
  filter_s_ = segment.end_s();
  if (segment.u.dt_s > 0.0) w_raw_B_ = segment.u.dtheta_B / segment.u.dt_s;
  if (!segment.hole) return;
  // What a vehicle may have done unseen.
  constexpr double kRate_rad_s = 0.5;
  constexpr double kAcceleration_m_s2 = 5.0;
  ++health_.imu_holes;
  const double dt = segment.u.dt_s;
  for (int k = 0; k < 3; ++k) {
    const auto square = [](double x) { return x * x; };
    filter_.covariance()(Filter::kTheta + k, Filter::kTheta + k) += square(kRate_rad_s * dt);
    filter_.covariance()(Filter::kVelocity + k, Filter::kVelocity + k) +=
        square(kAcceleration_m_s2 * dt);
    filter_.covariance()(Filter::kPosition + k, Filter::kPosition + k) +=
        square(kAcceleration_m_s2 * dt * dt);
  }
}

template <bool kWind>
template <int kRows>
bool Estimator<kWind>::weigh(Aid aid, const typename Filter::template Residual<kRows>& residual,
                             double gate_sigma) {
  const typename Filter::Verdict verdict = filter_.correct(residual, gate_sigma);
  AidHealth& health = health_.of(aid);
  health.nis = verdict.nis / kRows;
  if (verdict.accepted) {
    ++health.accepted;
    health.last_accepted_s = filter_s_;
    health.refusing = false;
  } else {
    ++health.refused;
    if (!health.refusing) health.refused_since_s = filter_s_;
    health.refusing = true;
    health.last_refused_s = filter_s_;
  }
  return verdict.accepted;
}

template <bool kWind>
void Estimator<kWind>::fuse(const Sample& sample) {
  std::visit([this](const auto& s) { this->fuse(s); }, sample);
}

template <bool kWind>
void Estimator<kWind>::fuse(const GnssSample& sample) {
  if (!origin_) {  // started without a fix: the place of the fix is where the filter thinks it is
    const Vector3 p_N = filter_.state().p_N + filter_.state().q_NB * gnss_lever();
    const Geodetic here = sample.place;
    constexpr double kMetresPerDegree = 111.2e3;
    origin_ = Geodetic{here.latitude_deg - p_N.x() / kMetresPerDegree,
                       here.longitude_deg -
                           p_N.y() / (kMetresPerDegree * std::cos(here.latitude_deg * kRadPerDeg)),
                       here.altitude_m + p_N.z()};
  }
  const Vector3 p_N = ned_of(sample.place, *origin_);
  // Where the output will be, which is ahead of the filter.
  const double ahead_s = imu_.last().t_s - filter_s_;
  const auto shown_N = [this, ahead_s]() -> Vector2 {
    const NominalState& x = filter_.state();
    return (x.p_N + ahead_s * x.v_N).template head<2>();
  };
  const Vector2 before_N = shown_N();
  constexpr double kGap_s = 1.0;
  const bool was_away = filter_s_ - health_.of(Aid::kGnssHorizontal).last_accepted_s > kGap_s;
  const std::uint64_t resets = health_.gnss_resets;
  fuse_gnss(sample, p_N);
  constexpr double kReturning_s = 2.0;
  if (was_away || health_.gnss_resets != resets) jump_.until_s = filter_s_ + kReturning_s;
  if (filter_s_ > jump_.until_s) return;
  const Vector2 moved_N = shown_N() - before_N;
  jump_.moved_N = unshown_jump_N(filter_s_) + moved_N;
  jump_.t_s = filter_s_;
}

template <bool kWind>
Vector2 Estimator<kWind>::unshown_jump_N(double t_s) const {
  const double size_m = jump_.moved_N.norm();
  constexpr double kLongest_s = 5.0;
  const double speed_m_s = std::max(config_.jump_speed_m_s, size_m / kLongest_s);
  const double shown_m = speed_m_s * (t_s - jump_.t_s);
  if (shown_m >= size_m) return Vector2::Zero();
  return jump_.moved_N * (1.0 - shown_m / size_m);
}

template <bool kWind>
void Estimator<kWind>::fuse_gnss(const GnssSample& sample, const Vector3& p_N) {
  const auto square = [](double x) { return x * x; };
  auto velocity = Filter::gnss_velocity(filter_.state(), sample.v_N_m_s, gnss_lever(), w_raw_B_);
  velocity.R = square(config_.gnss_velocity_sigma_m_s) * Matrix3::Identity();
  const bool velocity_ok = weigh<3>(Aid::kGnssVelocity, velocity, config_.gate_sigma);

  auto horizontal = Filter::gnss_position(filter_.state(), p_N, gnss_lever()).template rows<2>(0);
  horizontal.R = square(config_.gnss_horizontal_sigma_m) * Eigen::Matrix2d::Identity();
  const bool horizontal_ok = weigh<2>(Aid::kGnssHorizontal, horizontal, config_.gate_sigma);

  auto altitude = Filter::gnss_position(filter_.state(), p_N, gnss_lever()).template rows<1>(2);
  altitude.R(0) = square(config_.gnss_altitude_sigma_m);
  static_cast<void>(weigh<1>(Aid::kGnssAltitude, altitude, config_.gate_sigma));

  if (velocity_ok && horizontal_ok) return;
  if (health_.of(Aid::kGnssVelocity).refusing_for_s() > config_.gnss_doubt_s) doubt_the_imu();
  const double refused_s = std::max(health_.of(Aid::kGnssVelocity).refusing_for_s(),
                                    health_.of(Aid::kGnssHorizontal).refusing_for_s());
  if (refused_s > config_.gnss_reset_s) reset_to_gnss(p_N, sample.v_N_m_s);
}

/// The velocity runs away from what GNSS has: a bias must have jumped. Widens what such a jump
/// touches, so that the next fixes are let in and tell where it went.
template <bool kWind>
void Estimator<kWind>::doubt_the_imu() {
  constexpr double kTilt_rad = 0.02;
  constexpr double kVelocity_m_s = 0.2;
  constexpr double kGyroBias_rad_s = 0.01;
  constexpr double kAccelBias_m_s2 = 0.1;
  const auto widen = [this](int first, double sigma) {
    for (int k = first; k < first + 3; ++k) filter_.covariance()(k, k) += sigma * sigma;
  };
  widen(Filter::kTheta, kTilt_rad);
  widen(Filter::kVelocity, kVelocity_m_s);
  widen(Filter::kGyroBias, kGyroBias_rad_s);
  widen(Filter::kAccelBias, kAccelBias_m_s2);
  ++health_.imu_doubts;
}

/// Horizontal position and velocity as GNSS has them; the height only where it has no other aid.
template <bool kWind>
void Estimator<kWind>::reset_to_gnss(const Vector3& p_N, const Vector3& v_N) {
  constexpr double kTilt_rad = 0.05;
  NominalState& x = filter_.state();
  const Vector3 lever_N = x.q_NB * gnss_lever();
  x.p_N.head<2>() = (p_N - lever_N).head<2>();
  x.v_N = v_N;
  filter_.reset_variance(Filter::kPosition, 2, 2.0 * config_.gnss_horizontal_sigma_m);
  filter_.reset_variance(Filter::kVelocity, 3, 5.0 * config_.gnss_velocity_sigma_m_s);
  for (int k = 0; k < 3; ++k) {  // whatever led here turned the attitude too
    filter_.covariance()(Filter::kTheta + k, Filter::kTheta + k) += kTilt_rad * kTilt_rad;
  }
  for (const Aid aid : {Aid::kGnssHorizontal, Aid::kGnssVelocity}) {
    health_.of(aid).refusing = false;
    health_.of(aid).last_accepted_s = filter_s_;
  }
  ++health_.gnss_resets;
}

template <bool kWind>
double Estimator<kWind>::pressure_height_m(double pressure_Pa) const {
  return standard_height_m(pressure_Pa) - origin_pressure_height_m_;
}

template <bool kWind>
void Estimator<kWind>::fuse(const BaroSample& sample) {
  density_kg_m3_ = standard_density_kg_m3(sample.pressure_Pa);
  const double height_m = pressure_height_m(sample.pressure_Pa);
  auto residual = Filter::baro_height(filter_.state(), height_m);
  residual.R(0) = config_.baro_sigma_m * config_.baro_sigma_m;
  if (weigh<1>(Aid::kBaro, residual, config_.gate_sigma)) return;
  if (health_.of(Aid::kBaro).refusing_for_s() < config_.baro_relearn_s) return;
  filter_.relearn_baro_bias(height_m, config_.baro_sigma_m);
  health_.of(Aid::kBaro).refusing = false;
  ++health_.baro_relearned;
}

template <bool kWind>
void Estimator<kWind>::fuse(const MagSample& sample) {
  if (!declination_rad_) return;
  auto residual = Filter::magnetic_heading(filter_.state(), sample.field_T, *declination_rad_);
  const double level_T = (filter_.state().q_NB * sample.field_T).template head<2>().norm();
  constexpr double kLeastLevel = 0.05;  // of the field: nearer to vertical it has no heading
  if (level_T < kLeastLevel * sample.field_T.norm()) return;
  const double by_noise = config_.mag_sigma_T / level_T;
  residual.R(0) = by_noise * by_noise + config_.heading_sigma_rad * config_.heading_sigma_rad;
  static_cast<void>(weigh<1>(Aid::kHeading, residual, config_.heading_gate_sigma));
}

template <bool kWind>
void Estimator<kWind>::fuse(const RangeSample& sample) {
  const NominalState& x = filter_.state();
  const double cosine = (x.q_NB * Vector3::UnitZ()).z();
  if (cosine < std::cos(config_.range_max_tilt_rad)) return;
  const Vector3 lever_B = config_.range_position_B - config_.imu_position_B;
  auto residual = Filter::range(x, sample.range_m, ground_up_m_, lever_B);
  residual.R(0) = config_.range_sigma_m * config_.range_sigma_m;
  if (weigh<1>(Aid::kRange, residual, config_.gate_sigma)) return;
  if (health_.of(Aid::kRange).refusing_for_s() < config_.range_relearn_s) return;
  const double sensor_up_m = -(x.p_N + x.q_NB * lever_B).z();
  ground_up_m_ = sensor_up_m - sample.range_m * cosine;
  health_.of(Aid::kRange).refusing = false;
  ++health_.ground_relearned;
}

template <bool kWind>
void Estimator<kWind>::fuse(const PitotSample& sample) {
  if constexpr (kWind) {
    const NominalState& x = filter_.state();
    const Vector3 wind_N(x.wind_N.x(), x.wind_N.y(), 0.0);
    const double forward_m_s = (x.q_NB.conjugate() * (x.v_N - wind_N)).x();
    if (forward_m_s < config_.min_airspeed_m_s) return;
    auto residual = Filter::pitot(x, sample.pressure_Pa, density_kg_m3_);
    // rho/2 (m^2 - u^2) = rho (m + u)/2 (m - u): with the mean of measured and expected speed the
    // residual is linear, however far off the wind is at first.
    const double measured_m_s = std::sqrt(2.0 * std::max(sample.pressure_Pa, 0.0) / density_kg_m3_);
    residual.nu *= 2.0 * forward_m_s / (measured_m_s + forward_m_s);
    residual.R(0) = config_.pitot_sigma_Pa * config_.pitot_sigma_Pa;
    static_cast<void>(weigh<1>(Aid::kPitot, residual, config_.gate_sigma));
    if (config_.use_sideslip) fuse(SideslipSample{sample.t_s, 0.0});
  }
}

template <bool kWind>
void Estimator<kWind>::fuse(const SideslipSample& sample) {
  auto residual = Filter::sideslip(filter_.state(), sample.v_air_y_m_s);
  residual.R(0) = config_.sideslip_sigma_m_s * config_.sideslip_sigma_m_s;
  static_cast<void>(weigh<1>(Aid::kSideslip, residual, config_.gate_sigma));
}

template <bool kWind>
void Estimator<kWind>::fuse_rest() {
  next_rest_s_ = filter_s_ + config_.rest_interval_s - 1e-6;
  auto residual = Filter::velocity(filter_.state(), Vector3::Zero());
  residual.R = config_.rest_sigma_m_s * config_.rest_sigma_m_s * Matrix3::Identity();
  static_cast<void>(weigh<3>(Aid::kRest, residual, config_.gate_sigma));
}

// ---- start

template <bool kWind>
double Estimator<kWind>::declination(const GnssSample& fix) const {
  if (config_.declination_rad) return *config_.declination_rad;
  return config_.declination_at != nullptr ? config_.declination_at(fix) : 0.0;
}

template <bool kWind>
void Estimator<kWind>::restart() {
  imu_.clear();
  queued_ = 0;
  next_s_ = {-1e9, -1e9, -1e9};
  next_rest_s_ = -1e9;
  window_.clear();
  filter_ = Filter{};
  hint_ = {};
  ground_up_m_ = 0.0;
  jump_ = {};
  const std::uint64_t restarts = health_.restarts;
  health_ = {};
  health_.restarts = restarts;
}

template <bool kWind>
void Estimator<kWind>::try_start() {
  if (config_.declination_rad) declination_rad_ = config_.declination_rad;
  const bool hinted = window_.end_s - hint_.t_s < kFreshHint_s;
  constexpr double kHintedWindow_s = 0.2;
  const double needed_s = !at_rest_ && hinted ? std::min(kHintedWindow_s, config_.initial_window_s)
                                              : config_.initial_window_s;
  if (window_.length_s() < needed_s) return;
  if (!window_.complete() || !declination_rad_) {
    constexpr double kTooLong = 4.0;  // windows: what was averaged is no longer the present
    if (window_.length_s() > kTooLong * config_.initial_window_s) window_.clear();
    return;
  }
  if (at_rest_ && window_.still(config_.gravity_m_s2)) return start(true);
  constexpr double kFreshFix_s = 0.5;
  const bool fresh = window_.last_fix && window_.end_s - window_.last_fix->t_s < kFreshFix_s;
  if (!at_rest_ && fresh) return start(false);
  window_.clear();
}

template <bool kWind>
void Estimator<kWind>::start(bool on_ground) {
  const double now_s = window_.end_s;
  const bool hinted = now_s - hint_.t_s < kFreshHint_s;
  NominalState x;
  const Vector3 field_B = window_.field.mean();
  const double declination_rad = declination_rad_.value_or(0.0);
  if (on_ground || !hinted) {
    x.q_NB = level_attitude(window_.accel.mean(), field_B, declination_rad);
  } else {
    x.q_NB = with_heading_of(hint_.q_NB, field_B, declination_rad);
  }
  if (!origin_) origin_ = config_.origin;
  const bool first_start = !origin_;
  if (first_start && window_.fixes.count > 0) {
    const Vector3 mean = window_.fixes.mean();
    const double below_antenna_m =
        (x.q_NB * config_.gnss_position_B).z() - (on_ground ? config_.height_at_rest_m : 0.0);
    origin_ = Geodetic{mean.x(), mean.y(), mean.z() + below_antenna_m};
  }
  if (on_ground) {
    x.gyro_bias_B = window_.gyro.mean();
    x.p_N.z() = -config_.height_at_rest_m;
    x.p_N += x.q_NB * config_.imu_position_B;
    if (!first_start && window_.last_fix) {
      x.p_N.head<2>() = ned_of(window_.last_fix->place, *origin_).head<2>();
    }
  } else if (window_.last_fix && origin_) {
    const GnssSample& fix = *window_.last_fix;
    x.v_N = fix.v_N_m_s;
    x.p_N = ned_of(fix.place, *origin_) + (now_s - fix.t_s) * fix.v_N_m_s - x.q_NB * gnss_lever();
  }
  const double pressure_Pa = window_.pressure_Pa.mean().x();
  density_kg_m3_ = standard_density_kg_m3(pressure_Pa);
  origin_pressure_height_m_ = standard_height_m(pressure_Pa) + x.p_N.z();

  constexpr double kGroundTilt_rad = 0.03;
  constexpr double kHintTilt_rad = 0.1;
  constexpr double kAirTilt_rad = 0.3;
  constexpr double kAirHeading_rad = 0.3;
  const double tilt_rad = on_ground ? kGroundTilt_rad : (hinted ? kHintTilt_rad : kAirTilt_rad);
  const double gyro_bias_rad_s =
      on_ground ? 2.0 * config_.noise.gyro_rad_s_rtHz / std::sqrt(window_.length_s())
                : config_.initial_gyro_bias_rad_s;
  filter_ = Filter{};
  filter_.state() = x;
  filter_.covariance().setZero();
  const auto set = [this](int first, int size, double sigma) {
    filter_.reset_variance(first, size, sigma);
  };
  const double h = on_ground ? 0.1 : 2.0 * config_.gnss_horizontal_sigma_m;
  set(Filter::kTheta, 2, tilt_rad);
  set(Filter::kTheta + 2, 1, on_ground ? 2.0 * config_.heading_sigma_rad : kAirHeading_rad);
  set(Filter::kVelocity, 3, on_ground ? config_.rest_sigma_m_s : 0.5);
  set(Filter::kPosition, 2, h);
  set(Filter::kPosition + 2, 1, on_ground ? 0.1 : 3.0);
  set(Filter::kGyroBias, 3, gyro_bias_rad_s);
  set(Filter::kAccelBias, 3, config_.initial_accel_bias_m_s2);
  set(Filter::kBaroBias, 1, config_.baro_sigma_m);
  if constexpr (kWind) set(Filter::kWindIndex, 2, config_.initial_wind_m_s);

  imu_.clear();
  queued_ = 0;
  filter_s_ = now_s;
  next_rest_s_ = now_s;
  health_.initialised = true;
  health_.in_air_start = !on_ground;
  for (const Aid aid : {Aid::kHeading, Aid::kBaro, on_ground ? Aid::kRest : Aid::kGnssVelocity}) {
    health_.of(aid).last_accepted_s = now_s;  // it started from them
  }
  health_.gnss_age_s = now_s - health_.of(Aid::kGnssVelocity).last_accepted_s;
  window_.clear();
}

template <bool kWind>
void Estimator<kWind>::start_at(double t_s, const NominalState& state,
                                const typename Filter::Covariance& covariance,
                                const Geodetic& origin, double pressure_Pa) {
  restart();
  filter_.state() = state;
  filter_.covariance() = covariance;
  origin_ = origin;
  density_kg_m3_ = standard_density_kg_m3(pressure_Pa);
  origin_pressure_height_m_ = standard_height_m(pressure_Pa) + state.p_N.z() - state.baro_bias_m;
  if (config_.declination_rad) declination_rad_ = config_.declination_rad;
  filter_s_ = t_s;
  next_rest_s_ = t_s;
  imu_ = ImuBuffer{config_.increment_s};
  health_.initialised = true;
  health_.in_air_start = true;
}

template class Estimator<false>;
template class Estimator<true>;

}  // namespace rosflight::autonomy::estimation
