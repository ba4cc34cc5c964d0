// SPDX-License-Identifier: BSD-3-Clause
// Output of an Estimator: its state carried on to the newest IMU sample.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/estimator.hpp"

namespace rosflight::autonomy::estimation {

Quality Estimator::aided(double age_s, double good_s) const {
  if (age_s < good_s) return Quality::kGood;
  return age_s < config().dead_reckoning_s ? Quality::kDeadReckoned : Quality::kNone;
}

StateEstimate Estimator::estimate() const {
  StateEstimate out;
  out.t_s = imu_.last().t_s;
  if (!health().initialised) return out;
  NominalState x = filter().state();
  out.bridging = health().bridging;
  for (std::size_t k = 0; k < imu_.size(); ++k) {
    const ImuBuffer::Segment& segment = imu_.at(k);
    out.bridging = out.bridging || segment.hole;  // the filter is not there yet
    const ImuIncrement u =
        segment.unknown ? Filter::steady(x, segment.u.dt_s, config().gravity_m_s2) : segment.u;
    Filter::propagate(x, u, config().gravity_m_s2);
  }
  const ImuIncrement open = imu_.open();
  if (open.dt_s > 0.0) Filter::propagate(x, open, config().gravity_m_s2);

  // The newest rates, over one increment.
  const bool use_open = open.dt_s > 0.5 * config().increment_s || imu_.size() == 0 ||
                        imu_.at(imu_.size() - 1).unknown;
  const ImuIncrement& recent = use_open ? open : imu_.at(imu_.size() - 1).u;
  const double dt = recent.dt_s;
  out.w_B = dt > 0.0 ? Vector3(recent.dtheta_B / dt - x.gyro_bias_B) : Vector3(Vector3::Zero());
  out.a_B = dt > 0.0 ? Vector3(recent.dv_B / dt - x.accel_bias_B) : Vector3(Vector3::Zero());
  out.q_WB = x.q_WB;
  out.p_W = x.p_W - x.q_WB * config().imu_position_B;
  const Vector2 unshown_W = fusion_.unshown_jump_W(out.t_s);
  out.p_W.head<2>() -= unshown_W;
  out.v_W = x.v_W - x.q_WB * out.w_B.cross(config().imu_position_B);
  out.gyro_bias_B = x.gyro_bias_B;
  out.accel_bias_B = x.accel_bias_B;
  out.baro_bias_m = x.baro_bias_m;

  constexpr double kCourseSpeed_m_s = 0.5;
  const double ground_speed = out.v_W.head<2>().norm();
  out.course_rad =
      ground_speed > kCourseSpeed_m_s
          ? std::atan2(out.v_W.y(), out.v_W.x())
          : std::atan2(2.0 * (x.q_WB.x() * x.q_WB.y() + x.q_WB.w() * x.q_WB.z()),
                       1.0 - 2.0 * (x.q_WB.y() * x.q_WB.y() + x.q_WB.z() * x.q_WB.z()));

  const auto& P = filter().covariance();
  const auto sigma = [&P](int first) {
    return P.diagonal().template segment<3>(first).cwiseSqrt().eval();
  };
  out.p_sigma_W_m = sigma(Filter::kPosition);
  out.p_sigma_W_m.head<2>() = (out.p_sigma_W_m.head<2>().cwiseAbs2() + unshown_W.cwiseAbs2() +
                               fusion_.disagreement_W().cwiseAbs2())
                                  .cwiseSqrt();
  out.v_sigma_W_m_s = sigma(Filter::kVelocity);
  out.attitude_sigma_B_rad = sigma(Filter::kTheta);

  const auto age = [this](Aid aid) { return filter_time_s() - health().of(aid).last_accepted_s; };
  if (fixed_wing()) {
    out.wind_W = {x.wind_W.x(), x.wind_W.y(), 0.0};
    out.wind_sigma_W_m_s = {std::sqrt(P(Filter::kWind, Filter::kWind)),
                            std::sqrt(P(Filter::kWind + 1, Filter::kWind + 1)), 0.0};
    const Vector3 air_B = x.q_WB.conjugate() * (out.v_W - out.wind_W);
    out.airspeed_m_s = air_B.norm();
    out.wind_valid = out.wind_sigma_W_m_s.norm() < 0.75 * config().initial_wind_m_s;
    constexpr double kSilent_s = 1.0;
    // Ground speed and wind give it too; lift alone leaves airspeed and pitch undecided.
    const bool known =
        age(Aid::kPitot) < kSilent_s ||
        (age(Aid::kGnssVelocity) < kSilent_s && filter().airspeed_sigma_m_s() < kAirspeedKnown_m_s);
    out.air_valid = out.airspeed_m_s > config().min_airspeed_m_s && known;
    if (out.air_valid) {
      out.alpha_rad = std::atan2(air_B.z(), air_B.x());
      out.beta_rad = std::asin(std::clamp(air_B.y() / out.airspeed_m_s, -1.0, 1.0));
    }
  }

  constexpr double kAttitudeGood_rad = 0.1;
  constexpr double kHeadingGood_rad = 0.2;
  const Vector3& attitude = out.attitude_sigma_B_rad;
  out.attitude =
      attitude.head<2>().maxCoeff() < kAttitudeGood_rad ? Quality::kGood : Quality::kDeadReckoned;
  out.heading =
      attitude.z() < kHeadingGood_rad && std::min(age(Aid::kHeading), age(Aid::kPoseHeading)) < 2.0
          ? Quality::kGood
          : Quality::kDeadReckoned;
  const double aided_s = std::max(fusion_.aided_s(), health().of(Aid::kRest).last_accepted_s);
  out.dead_reckoning_s = std::max(0.0, out.t_s - lag_s_ - aided_s);
  out.horizontal = aided(out.dead_reckoning_s, 1.0);
  constexpr double kSigmas = 3.0;
  out.position_unreliable =
      kSigmas * out.p_sigma_W_m.head<2>().norm() > StateEstimate::kUnreliable_m;
  out.vertical = aided(
      std::min({age(Aid::kBaro), age(Aid::kRange), age(Aid::kGnssVelocity), age(Aid::kPose)}), 1.0);
  return out;
}

}  // namespace rosflight::autonomy::estimation
