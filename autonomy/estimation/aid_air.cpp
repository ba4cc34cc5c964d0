// SPDX-License-Identifier: BSD-3-Clause
// How an AidFusion uses the air: specific force of rotors, side and lift, pitot tube, sideslip, and how gusty the wind is.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/aid_fusion.hpp"

namespace rosflight::autonomy::estimation {

/// Raises and lowers the process noise of the wind so that innovations of the air are as large as
/// they should be: R. K. Mehra, "On the identification of variances and adaptive Kalman filtering",
/// IEEE Trans. Automatic Control 15, 1970, in its simplest form. Without GNSS a wrong tilt looks like
/// a gust, without a magnetometer a wrong heading: then what was learned stays.
void AidFusion::learn_gusts(double nis) {
  if (dead_reckoning() || silent(Aid::kHeading)) return;
  constexpr double kShare = 0.02;
  constexpr double kMaxNis = 9.0;
  const double factor = std::exp(kShare * (std::min(nis, kMaxNis) - 1.0));
  wind_noise_m_s_rts_ = std::clamp(wind_noise_m_s_rts_ * factor, config_.noise.wind_m_s_rts,
                                   max_wind_noise_m_s_rts());
}

/// A gust has taken the pitot out of its gate, and the wind with it: both are let in again.
void AidFusion::widen_wind(double gust_m_s) {
  filter_.covariance().template block<2, 2>(Filter::kWind, Filter::kWind) +=
      gust_m_s * gust_m_s * Eigen::Matrix2d::Identity();
  wind_noise_m_s_rts_ = max_wind_noise_m_s_rts();
  health_.of(Aid::kPitot).rejecting = false;
  ++health_.wind_relearned;
}

/// A fixed wing hardly slips: the scale of its side force would be learned from noise. It is a "consider" state, as
/// those of correct_heading(): its variance counts, and it is not corrected. Besides, rudder, ailerons and
/// turning add a lateral force, which the model leaves out.
void AidFusion::consider_air_scale(Filter::Residual<1>& residual) const {
  const Eigen::RowVector2d by_scale = residual.H.segment<2>(Filter::kAirScale);
  residual.H.segment<2>(Filter::kAirScale).setZero();
  const auto P = filter_.covariance().template block<2, 2>(Filter::kAirScale, Filter::kAirScale);
  const double by_turning =
      config_.air_force_turning_m_s * (w_raw_B_ - filter_.state().gyro_bias_B).norm();
  residual.R(0) += (by_scale * P * by_scale.transpose())(0) + by_turning * by_turning;
}

/// The specific force along body x and y (rotors) or y (fixed wing), averaged over an interval.
void AidFusion::fuse_air_force(const ImuBuffer::Segment& segment) {
  force_.dv_B += segment.u.dv_B;
  force_.dt_s += segment.u.dt_s;
  if (force_.dt_s < config_.air_force_interval_s) return;
  const Vector3 force_B = force_at_origin();
  force_ = {Vector3::Zero(), 0.0, w_raw_B_};
  if (!off_the_ground() || waits_for_gnss()) return;
  const NominalState& x = filter_.state();
  const double thrust_m_s2 = std::max(0.0, x.accel_bias_B.z() - force_B.z());
  for (int axis = fixed_wing() ? 1 : 0; axis < 2; ++axis) {
    const AirForce model = config_.air.along(axis, thrust_m_s2, density_kg_m3_);
    if (model.linear_1_s <= 0.0 && model.quadratic_1_m <= 0.0) continue;
    auto residual = Filter::air_force(filter_.state(), axis, force_B(axis), model);
    residual.R(0) = config_.air_force_sigma_m_s2 * config_.air_force_sigma_m_s2;
    if (fixed_wing()) consider_air_scale(residual);
    const bool accepted = weigh<1>(Aid::kSideslip, residual, config_.gate_sigma);
    if (accepted) learn_gusts(health_.of(Aid::kSideslip).nis);
    const double size = std::sqrt(health_.of(Aid::kSideslip).nis);
    const bool off =
        air_means_[static_cast<std::size_t>(axis)].exceeded(std::copysign(size, residual.nu(0)));
    if (off && dead_reckoning()) {
      widen_imu_errors(kDeadReckonedFault);
    } else if (off && silent(Aid::kHeading)) {
      widen_heading();
    }
  }
  if (fixed_wing() && silent(Aid::kPitot)) fuse_lift(force_B.z());
}

/// The specific force of the lift, for the airspeed where no pitot measures it. Vertical gusts, which the
/// filter has no state for, are its noise.
void AidFusion::fuse_lift(double force_m_s2) {
  constexpr double kSigma_m_s2 = 2.0;
  constexpr double kByGusts_rts_s = 3.0;
  const LiftModel& lift = config_.air.lift;
  const NominalState& x = filter_.state();
  const double forward_m_s = Filter::air_velocity_B(x).x();
  if (lift.area_m2_kg <= 0.0 || forward_m_s < config_.min_airspeed_m_s) return;
  auto residual = Filter::lift(x, force_m_s2, density_kg_m3_, lift);
  const double sigma_m_s2 = kSigma_m_s2 + kByGusts_rts_s * wind_noise_m_s_rts_;
  residual.R(0) = sigma_m_s2 * sigma_m_s2;
  static_cast<void>(filter_.correct(residual, config_.gate_sigma));
}

/// No gust takes half of the airspeed away: a tube that reads so little is blocked. Where the airspeed was known when it was,
/// it stays so until it nearly agrees, halfway from there to the airspeed: without it the estimate drifts, and would come
/// near a wrong reading by itself.
bool AidFusion::pitot_is_blocked(double measured_m_s, double forward_m_s) {
  constexpr double kBlocked = 0.5;
  constexpr double kOpen = 0.75;
  const double share = measured_m_s / forward_m_s;
  if (share < kBlocked && filter_.airspeed_sigma_m_s() < kAirspeedKnown_m_s) pitot_blocked_ = true;
  if (share > kOpen) pitot_blocked_ = false;
  return pitot_blocked_ || share < kBlocked;
}

void AidFusion::fuse(const PitotSample& sample) {
  if (fixed_wing()) {
    const NominalState& x = filter_.state();
    const Vector3 wind_W(x.wind_W.x(), x.wind_W.y(), 0.0);
    const double forward_m_s = (x.q_WB.conjugate() * (x.v_W - wind_W)).x();
    if (forward_m_s < config_.min_airspeed_m_s || waits_for_gnss()) return;
    auto residual = Filter::pitot(x, sample.pressure_Pa, density_kg_m3_);
    // rho/2 (m^2 - u^2) = rho (m + u)/2 (m - u): with the mean of measured and expected speed the
    // residual is linear, however far off the wind is at first.
    const double measured_m_s = std::sqrt(2.0 * std::max(sample.pressure_Pa, 0.0) / density_kg_m3_);
    residual.nu *= 2.0 * forward_m_s / (measured_m_s + forward_m_s);
    residual.R(0) = config_.pitot_sigma_Pa * config_.pitot_sigma_Pa;
    const bool blocked = pitot_is_blocked(measured_m_s, forward_m_s);
    if (weigh<1>(Aid::kPitot, residual, blocked ? 0.0 : config_.gate_sigma)) {
      learn_gusts(health_.of(Aid::kPitot).nis);
    } else if (!blocked && health_.of(Aid::kPitot).rejecting_for_s() > config_.pitot_relearn_s) {
      widen_wind(measured_m_s - forward_m_s);
    }
    if (config_.use_sideslip && config_.air.side_area_m2_kg <= 0.0) {
      fuse(SideslipSample{sample.t_s, 0.0});
    }
  }
}

void AidFusion::fuse(const SideslipSample& sample) {
  if (waits_for_gnss()) return;
  auto residual = Filter::sideslip(filter_.state(), sample.v_air_y_m_s);
  residual.R(0) = config_.sideslip_sigma_m_s * config_.sideslip_sigma_m_s;
  static_cast<void>(weigh<1>(Aid::kSideslip, residual, config_.gate_sigma));
}

}  // namespace rosflight::autonomy::estimation
