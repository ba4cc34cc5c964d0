// SPDX-License-Identifier: BSD-3-Clause
// Start of an Estimator: its first state and covariance from what the Alignment has averaged.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/estimator.hpp"

namespace rosflight::autonomy::estimation {
namespace {

constexpr double kFreshHint_s = 0.5;

}  // namespace

double Estimator::declination(const GnssSample& fix) const {
  const std::optional<double>& fixed = config().declination_rad;
  if (fixed) return *fixed;
  return config().declination_at != nullptr ? config().declination_at(fix) : 0.0;
}

/// A pose and the field together say how far magnetic north is from the north of the frame.
void Estimator::take_direction_of_pose() {
  std::optional<double>& declination_rad = fusion_.reference().declination_rad;
  if (declination_rad || !window_.last_pose || window_.field.count == 0) return;
  const Vector3 field_W = window_.last_pose->q_WB * window_.field.mean();
  declination_rad = std::atan2(field_W.y(), field_W.x());
}

void Estimator::try_start() {
  if (config().declination_rad) fusion_.reference().declination_rad = config().declination_rad;
  take_direction_of_pose();
  const bool hinted = window_.end_s - hint_.t_s < kFreshHint_s;
  constexpr double kHintedWindow_s = 0.2;
  const double needed_s = !at_rest_ && hinted ? std::min(kHintedWindow_s, config().initial_window_s)
                                              : config().initial_window_s;
  if (window_.length_s() < needed_s) return;
  if (!window_.complete() || !fusion_.reference().declination_rad) {
    constexpr double kTooLong = 4.0;  // windows: what was averaged is no longer the present
    if (window_.length_s() > kTooLong * config().initial_window_s) window_.clear();
    return;
  }
  if (at_rest_ && window_.still(config().gravity_m_s2)) return start(true);
  constexpr double kFreshFix_s = 0.5;
  const bool fresh = window_.last_fix && window_.end_s - window_.last_fix->t_s < kFreshFix_s;
  if (!at_rest_ && fresh) return start(false);
  window_.clear();
}

NominalState Estimator::initial_state(bool on_ground, bool hinted) {
  std::optional<Geodetic>& origin = fusion_.reference().origin;
  const double now_s = window_.end_s;
  const Vector3 gnss_lever = config().gnss_position_B - config().imu_position_B;
  NominalState x;
  const Vector3 field_B = window_.field.mean();
  const double declination_rad = fusion_.reference().declination_rad.value_or(0.0);
  if (on_ground || !hinted) {
    x.q_WB = level_attitude(window_.accel.mean(), field_B, declination_rad);
  } else {
    x.q_WB = with_heading_of(hint_.q_WB, field_B, declination_rad);
  }
  if (!origin) origin = config().origin;
  const bool first_start = !origin;
  if (first_start && window_.fixes.count > 0) {
    const Vector3 mean = window_.fixes.mean();
    Vector3 antenna_W = x.q_WB * config().gnss_position_B;
    if (window_.last_pose) {
      antenna_W += window_.last_pose->p_W;
    } else if (on_ground) {
      antenna_W.z() -= config().height_at_rest_m;
    }
    origin = moved({mean.x(), mean.y(), mean.z()}, -antenna_W);
  }
  if (on_ground) {
    x.gyro_bias_B = window_.gyro.mean();
    x.p_W.z() = -config().height_at_rest_m;
    x.p_W += x.q_WB * config().imu_position_B;
    if (window_.last_pose) {
      x.p_W = window_.last_pose->p_W + x.q_WB * config().imu_position_B;
    } else if (!first_start && window_.last_fix) {
      x.p_W.head<2>() = ned_of(window_.last_fix->position, *origin).head<2>();
    }
  } else if (window_.last_fix && origin) {
    const GnssSample& fix = *window_.last_fix;
    x.v_W = fix.v_W_m_s;
    x.p_W = ned_of(fix.position, *origin) + (now_s - fix.t_s) * fix.v_W_m_s - x.q_WB * gnss_lever;
  }
  return x;
}

ErrorStateEkf::Covariance Estimator::initial_covariance(bool on_ground, bool hinted,
                                                        bool new_origin) const {
  constexpr double kAtOrigin_m = 0.01;
  constexpr double kGroundTilt_rad = 0.03;
  constexpr double kHintTilt_rad = 0.1;
  constexpr double kAirTilt_rad = 0.3;
  constexpr double kAirHeading_rad = 0.3;
  constexpr double kAnyHeading_rad = 1.0;  // until start_heading()
  const double tilt_rad = on_ground ? kGroundTilt_rad : (hinted ? kHintTilt_rad : kAirTilt_rad);
  const double gyro_bias_rad_s =
      on_ground ? 2.0 * config().noise.gyro_rad_s_rtHz / std::sqrt(window_.length_s())
                : config().initial_gyro_bias_rad_s;
  Filter filter;
  filter.covariance().setZero();
  const auto set = [&filter](int first, int size, double sigma) {
    filter.reset_variance(first, size, sigma);
  };
  const double h = new_origin && on_ground ? kAtOrigin_m : 2.0 * config().gnss_horizontal_sigma_m;
  set(Filter::kTheta, 2, tilt_rad);
  // From the field in both cases; a coarse tilt is too far for the first order of start_heading().
  set(Filter::kTheta + 2, 1, on_ground || hinted ? kAnyHeading_rad : kAirHeading_rad);
  set(Filter::kVelocity, 3, on_ground ? config().rest_sigma_m_s : 0.5);
  set(Filter::kPosition, 2, h);
  set(Filter::kPosition + 2, 1, on_ground ? 0.1 : 3.0);
  set(Filter::kGyroBias, 3, gyro_bias_rad_s);
  set(Filter::kAccelBias, 3, config().initial_accel_bias_m_s2);
  set(Filter::kBaroBias, 1, config().baro_sigma_m);
  set(Filter::kWind, 2, config().initial_wind_m_s);
  set(Filter::kMagBias, 3, config().initial_mag_bias_T / Filter::kMicrotesla);
  set(Filter::kAirScale, 2, config().initial_air_scale);
  set(Filter::kGust, 1, config().noise.gust_down_m_s);
  set(Filter::kLiftOffset, 1, config().initial_lift_offset_rad);
  if (new_origin) {  // the slow error of the satellites counts from here
    set(Filter::kGnssBias, 2, config().gnss_horizontal_sigma_m);
    set(Filter::kGnssBias + 2, 1, config().gnss_altitude_sigma_m);
    return filter.covariance();
  }
  set(Filter::kGnssBias, 2, config().noise.gnss_slow_horizontal_m);
  set(Filter::kGnssBias + 2, 1, config().noise.gnss_slow_altitude_m);
  filter.couple(Filter::kPosition, Filter::kGnssBias, on_ground ? 2 : 3, h);
  return filter.covariance();
}

void Estimator::start(bool on_ground) {
  const double now_s = window_.end_s;
  const bool hinted = now_s - hint_.t_s < kFreshHint_s;
  const bool new_origin = !fusion_.reference().origin && !config().origin;
  const NominalState state = initial_state(on_ground, hinted);
  fusion_.start(now_s, state, initial_covariance(on_ground, hinted, new_origin),
                window_.pressure_Pa.mean().x());
  if (on_ground || hinted) fusion_.start_heading(window_.field.mean());
  if (on_ground && window_.last_fix) fusion_.trust_fixes_at_rest();
  imu_.clear();
  queued_ = 0;
  next_rest_s_ = now_s;
  EstimatorHealth& health = fusion_.health();
  health.in_air_start = !on_ground;
  if (window_.last_pose) health.of(Aid::kPose).last_accepted_s = window_.last_pose->t_s;
  for (const Aid aid : {Aid::kHeading, Aid::kBaro, on_ground ? Aid::kRest : Aid::kGnssVelocity}) {
    health.of(aid).last_accepted_s = now_s;  // it started from them
  }
  health.gnss_age_s = now_s - fusion_.aided_s();
  window_.clear();
}

void Estimator::start_at(double t_s, const NominalState& state,
                         const Filter::Covariance& covariance, const Geodetic& origin,
                         double pressure_Pa) {
  restart();
  fusion_.reference().origin = origin;
  if (config().declination_rad) fusion_.reference().declination_rad = config().declination_rad;
  fusion_.start(t_s, state, covariance, pressure_Pa);
  fusion_.health().in_air_start = true;
  next_rest_s_ = t_s;
  imu_ = ImuBuffer{config().increment_s};
}

}  // namespace rosflight::autonomy::estimation
