// SPDX-License-Identifier: BSD-3-Clause
// How an AidFusion uses the air: specific force of rotors, side and lift, pitot tube, sideslip, and how gusty the wind is.
#include <algorithm>
#include <cmath>
#include <limits>

#include "autonomy/estimation/aid_fusion.hpp"

namespace rosflight::autonomy::estimation {
namespace {

constexpr double kHovers_m_s = 10.0;  ///< Slower, fuse_hovering().

/// The low-altitude Dryden model of MIL-F-8785C (1980), section 3.7.3.4, h the height in feet from 10 to 1000:
/// L_w = h, L_u = h/k^1.2, sigma_u = sigma_w/k^0.4 with k = 0.177 + 0.000823 h.
double dryden_height_m(double above_ground_m) {
  constexpr double kMin_m = 3.048, kMax_m = 304.8;
  return std::clamp(above_ground_m, kMin_m, kMax_m);
}

/// The density with which the gusts along the path walk for short times, q = sigma_u sqrt(2 V/L_u), by that of the same
/// sigma_w and V: sqrt(2/h) k^0.2 [1/sqrt(m)].
double dryden_walk_1_sqrt_m(double above_ground_m) {
  constexpr double kPerMetre = 0.000823 / 0.3048;
  const double height_m = dryden_height_m(above_ground_m);
  return std::sqrt(2.0 / height_m) * std::pow(0.177 + kPerMetre * height_m, 0.2);
}

}  // namespace

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
  gusts_learned_at_m_ = height_above_ground_m();
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
      if (!step_watch_.running()) widen_imu_errors(kDeadReckonedFault);
    } else if (off && silent(Aid::kHeading)) {
      widen_heading();
    }
  }
  if (fixed_wing()) fuse_lift(force_B.z());
  if (step_watch_.decide(filter_)) ++health_.imu_widenings;
}

/// Without GNSS a fixed wing's gyro and accelerometer are watched by all aids together.
bool AidFusion::watches_steps() const {
  return fixed_wing() && config_.air.lift.area_m2_kg > 0.0 && dead_reckoning() &&
         off_the_ground() && !waits_for_gnss();
}

void AidFusion::watch_steps(const ImuIncrement& u, const ProcessNoise& noise) {
  if (watches_steps()) {
    step_watch_.predict(filter_.state(), u, noise);
  } else if (step_watch_.running()) {
    step_watch_.restart();
  }
}

/// The density with which the wind walks: what was learned, and without GNSS, when nothing is learned, carried on to
/// another height.
double AidFusion::wind_walk_m_s_rts() const {
  if (!fixed_wing() || config_.air.lift.area_m2_kg <= 0.0 || !dead_reckoning()) {
    return wind_noise_m_s_rts_;
  }
  const double calm = config_.noise.wind_m_s_rts;
  return calm + (wind_noise_m_s_rts_ - calm) * dryden_walk_1_sqrt_m(height_above_ground_m()) /
                    dryden_walk_1_sqrt_m(gusts_learned_at_m_);
}

/// Standard deviation of the vertical gust by the walk q of the wind: sigma_w = q/(sqrt(V) dryden_walk_1_sqrt_m()).
double AidFusion::gust_down_m_s() const {
  const double speed_m_s =
      std::max(Filter::air_velocity_B(filter_.state()).norm(), config_.min_airspeed_m_s);
  return std::max(
      config_.noise.gust_down_m_s,
      wind_walk_m_s_rts() / (std::sqrt(speed_m_s) * dryden_walk_1_sqrt_m(height_above_ground_m())));
}

/// Correlation time of a first-order process that walks for short times as the vertical gust, which is of second order:
/// its density is 3 sigma^2 V/L_w there, that of the first order 2 sigma^2/T.
double AidFusion::gust_down_time_s() const {
  const double speed_m_s =
      std::max(Filter::air_velocity_B(filter_.state()).norm(), config_.min_airspeed_m_s);
  return 2.0 / 3.0 * dryden_height_m(height_above_ground_m()) / speed_m_s;
}

/// The specific force of the lift. While GNSS is there it teaches the vertical gust and the error of the lift alone, so
/// that attitude and velocity are as without it. Without GNSS it holds the pitch: the barometer gives the vertical
/// velocity and the pitot tube the airspeed, so that the angle of attack is the pitch less a known angle.
void AidFusion::fuse_lift(double force_m_s2) {
  const LiftModel& lift = config_.air.lift;
  const NominalState& x = filter_.state();
  const double forward_m_s = Filter::air_velocity_B(x).x();
  if (lift.area_m2_kg <= 0.0 || forward_m_s < config_.min_airspeed_m_s) return;
  if (silent(Aid::kPitot)) return fuse_lift_for_airspeed(force_m_s2);
  const double pressure = 0.5 * density_kg_m3_ * lift.area_m2_kg * forward_m_s * forward_m_s;
  const double alpha_rad = (-force_m_s2 / pressure - lift.zero) / lift.slope_1_rad;
  auto residual = Filter::lift(x, force_m_s2, density_kg_m3_, lift);
  const double by_turning =
      config_.lift_turning_m_s * (w_raw_B_ - filter_.state().gyro_bias_B).norm();
  // Near the stall as much lift comes with any angle of attack of some degrees.
  constexpr double kStalling_rad = 0.07;
  const double by_stall =
      std::abs(alpha_rad) > lift.linear_rad ? kStalling_rad * lift.slope_1_rad * pressure : 0.0;
  residual.R(0) = config_.lift_sigma_m_s2 * config_.lift_sigma_m_s2 + by_turning * by_turning +
                  by_stall * by_stall;
  if (!dead_reckoning()) {
    static_cast<void>(filter_.correct_gust(residual, std::numeric_limits<double>::infinity()));
    return;
  }
  const Filter::Verdict verdict = filter_.correct(residual, config_.gate_sigma);
  step_watch_.observe(residual, verdict);
  constexpr int kEnough = 8;
  lift_rejected_ = verdict.accepted ? 0 : lift_rejected_ + 1;
  if (lift_rejected_ < kEnough) return;
  lift_rejected_ = 0;
  widen_imu_errors(kLargeFault);
}

/// The lift for the airspeed where no pitot tube measures it; vertical gusts are its noise.
void AidFusion::fuse_lift_for_airspeed(double force_m_s2) {
  constexpr double kSigma_m_s2 = 2.0;
  constexpr double kByGusts_rts_s = 3.0;
  NominalState x = filter_.state();
  x.gust_down_m_s = 0.0;
  auto residual = Filter::lift(x, force_m_s2, density_kg_m3_, config_.air.lift);
  residual.H(0, Filter::kGust) = residual.H(0, Filter::kLiftOffset) = 0.0;
  const double sigma_m_s2 = kSigma_m_s2 + kByGusts_rts_s * wind_noise_m_s_rts_;
  residual.R(0) = sigma_m_s2 * sigma_m_s2;
  step_watch_.observe(residual, filter_.correct(residual, config_.gate_sigma));
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

/// A vehicle that hovers in a wind has an airspeed before the estimate holds a wind. With the estimated speed u far off, the pressure is
/// taken at the measured speed m, where it is linear in u:
///
///     nu = rho m (m - u),  H = dp/du at m                                                   (1)
///
/// A tube that reads little is not blocked then.
void AidFusion::fuse_hovering(const PitotSample& sample, double forward_m_s) {
  constexpr double kMin_m_s = 1.0;
  const double measured_m_s =
      std::max(std::sqrt(2.0 * std::max(sample.pressure_Pa, 0.0) / density_kg_m3_), kMin_m_s);
  if (std::max(measured_m_s, forward_m_s) < config_.min_airspeed_m_s || waits_for_gnss()) return;
  pitot_blocked_ = false;
  NominalState at = filter_.state();
  const Eigen::Vector2d nose_W = (at.q_WB * Vector3::UnitX()).head<2>();
  const double level_sq = nose_W.squaredNorm();
  constexpr double kLevelEnough = 0.5;
  if (level_sq < kLevelEnough) return;
  const double off_m_s = measured_m_s - forward_m_s;
  at.wind_W -= off_m_s / level_sq * nose_W;
  auto residual = Filter::pitot(at, sample.pressure_Pa, density_kg_m3_);
  residual.nu(0) += density_kg_m3_ * measured_m_s * off_m_s;
  residual.R(0) = config_.pitot_sigma_Pa * config_.pitot_sigma_Pa;
  if (weigh<1>(Aid::kPitot, residual, config_.gate_sigma)) {
    learn_gusts(health_.of(Aid::kPitot).nis);
  } else if (health_.of(Aid::kPitot).rejecting_for_s() > config_.pitot_relearn_s) {
    widen_wind(off_m_s);
  }
}

void AidFusion::fuse(const PitotSample& sample) {
  if (fixed_wing()) {
    const NominalState& x = filter_.state();
    const Vector3 wind_W(x.wind_W.x(), x.wind_W.y(), 0.0);
    const double forward_m_s = (x.q_WB.conjugate() * (x.v_W - wind_W)).x();
    if (config_.hovers && forward_m_s < kHovers_m_s) return fuse_hovering(sample, forward_m_s);
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
