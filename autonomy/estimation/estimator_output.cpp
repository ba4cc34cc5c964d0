// SPDX-License-Identifier: BSD-3-Clause
// What an Estimator tells: its state carried on to the newest IMU sample.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/estimator.hpp"

namespace rosflight::autonomy::estimation {

template <bool kWind>
Trust Estimator<kWind>::aided(double age_s, double good_s) const {
  if (age_s < good_s) return Trust::kGood;
  return age_s < config_.dead_reckoning_s ? Trust::kDeadReckoned : Trust::kNone;
}

template <bool kWind>
StateEstimate Estimator<kWind>::estimate() const {
  StateEstimate out;
  out.t_s = imu_.last().t_s;
  if (!health_.initialised) return out;
  NominalState x = filter_.state();
  for (std::size_t k = 0; k < imu_.size(); ++k) {
    Filter::propagate(x, imu_.at(k).u, config_.gravity_m_s2);
  }
  const ImuIncrement open = imu_.open();
  if (open.dt_s > 0.0) Filter::propagate(x, open, config_.gravity_m_s2);

  // The newest rates, over one increment.
  const ImuIncrement& recent =
      open.dt_s > 0.5 * config_.increment_s || imu_.size() == 0 ? open : imu_.at(imu_.size() - 1).u;
  const double dt = recent.dt_s;
  out.w_B = dt > 0.0 ? Vector3(recent.dtheta_B / dt - x.gyro_bias_B) : Vector3(Vector3::Zero());
  out.a_B = dt > 0.0 ? Vector3(recent.dv_B / dt - x.accel_bias_B) : Vector3(Vector3::Zero());
  out.q_NB = x.q_NB;
  out.p_N = x.p_N - x.q_NB * config_.imu_position_B;
  out.p_N.template head<2>() -= unshown_jump_N(out.t_s);
  out.v_N = x.v_N - x.q_NB * out.w_B.cross(config_.imu_position_B);
  out.gyro_bias_B = x.gyro_bias_B;
  out.accel_bias_B = x.accel_bias_B;
  out.baro_bias_m = x.baro_bias_m;

  constexpr double kCourseSpeed_m_s = 0.5;
  const double ground_speed = out.v_N.template head<2>().norm();
  out.course_rad =
      ground_speed > kCourseSpeed_m_s
          ? std::atan2(out.v_N.y(), out.v_N.x())
          : std::atan2(2.0 * (x.q_NB.x() * x.q_NB.y() + x.q_NB.w() * x.q_NB.z()),
                       1.0 - 2.0 * (x.q_NB.y() * x.q_NB.y() + x.q_NB.z() * x.q_NB.z()));

  const auto& P = filter_.covariance();
  const auto sigma = [&P](int first) {
    return P.diagonal().template segment<3>(first).cwiseSqrt().eval();
  };
  out.p_sigma_N_m = sigma(Filter::kPosition);
  out.v_sigma_N_m_s = sigma(Filter::kVelocity);
  out.attitude_sigma_B_rad = sigma(Filter::kTheta);

  if constexpr (kWind) {
    out.wind_N = {x.wind_N.x(), x.wind_N.y(), 0.0};
    out.wind_sigma_N_m_s = {std::sqrt(P(Filter::kWindIndex, Filter::kWindIndex)),
                            std::sqrt(P(Filter::kWindIndex + 1, Filter::kWindIndex + 1)), 0.0};
    const Vector3 air_B = x.q_NB.conjugate() * (out.v_N - out.wind_N);
    out.airspeed_m_s = air_B.norm();
    out.wind_valid = out.wind_sigma_N_m_s.norm() < 0.75 * config_.initial_wind_m_s;
    out.air_valid = out.airspeed_m_s > config_.min_airspeed_m_s;
    if (out.air_valid) {
      out.alpha_rad = std::atan2(air_B.z(), air_B.x());
      out.beta_rad = std::asin(std::clamp(air_B.y() / out.airspeed_m_s, -1.0, 1.0));
    }
  }

  const auto age = [this](Aid aid) { return filter_s_ - health_.of(aid).last_accepted_s; };
  constexpr double kAttitudeGood_rad = 0.1;
  constexpr double kHeadingGood_rad = 0.2;
  const Vector3& attitude = out.attitude_sigma_B_rad;
  out.attitude = attitude.template head<2>().maxCoeff() < kAttitudeGood_rad ? Trust::kGood
                                                                            : Trust::kDeadReckoned;
  out.heading = attitude.z() < kHeadingGood_rad && age(Aid::kHeading) < 2.0 ? Trust::kGood
                                                                            : Trust::kDeadReckoned;
  out.horizontal = aided(std::min(health_.gnss_age_s, age(Aid::kRest)), 1.0);
  out.vertical = aided(std::min({age(Aid::kBaro), age(Aid::kRange), age(Aid::kGnssVelocity)}), 1.0);
  return out;
}

template Trust Estimator<false>::aided(double, double) const;
template Trust Estimator<true>::aided(double, double) const;
template StateEstimate Estimator<false>::estimate() const;
template StateEstimate Estimator<true>::estimate() const;

}  // namespace rosflight::autonomy::estimation
