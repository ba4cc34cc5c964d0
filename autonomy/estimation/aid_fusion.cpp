// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/aid_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::autonomy::estimation {
namespace {

/// Altitude and density in the standard troposphere, equations (1) and (2) of base/atmosphere.hpp.
double standard_height_m(double pressure_Pa) {
  return base::kTroposphere.scale_m * (1.0 - std::pow(pressure_Pa / base::kSeaLevelPressure_Pa,
                                                      base::kTroposphere.altitude_exponent));
}
double standard_density_kg_m3(double pressure_Pa) {
  return base::kSeaLevelDensity_kg_m3 *
         std::pow(pressure_Pa / base::kSeaLevelPressure_Pa, base::kTroposphere.density_exponent);
}

}  // namespace

void AidFusion::reset() {
  filter_ = Filter{};
  ground_up_m_ = 0.0;
  jump_ = {};
  disagreement_W_.setZero();
  force_ = {};
  heading_ = {};
  height_ = {};
  step_watch_.restart();
  lift_rejected_ = 0;
  wind_noise_m_s_rts_ = max_wind_noise_m_s_rts();
  good_.t_s = widened_s_ = long_hole_end_s_ = -1e9;
  settled_since_s_ = 1e9;
  started_on_fixes_s_ = -1e9;
  velocity_monitor_.reset();
  heading_monitor_.reset();
  for (InnovationMean& mean : velocity_means_) mean.reset();
  for (InnovationMean& mean : air_means_) mean.reset();
  health_ = {};
}

void AidFusion::start(double t_s, const NominalState& state, const Covariance& covariance,
                      double pressure_Pa) {
  t_s_ = t_s;
  filter_ = Filter{};
  filter_.state() = state;
  filter_.covariance() = covariance;
  density_kg_m3_ = standard_density_kg_m3(pressure_Pa);
  origin_pressure_height_m_ = standard_height_m(pressure_Pa) + state.p_W.z() - state.baro_bias_m;
  health_.initialised = true;
}

void AidFusion::trust_fixes_at_rest() {
  started_on_fixes_s_ = t_s_;
  settled_since_s_ = -1e9;
}

void AidFusion::predict(const ImuBuffer::Segment& segment) {
  const ImuIncrement u = segment.unknown
                             ? Filter::steady(filter_.state(), segment.u.dt_s, config_.gravity_m_s2)
                             : segment.u;
  t_s_ = segment.end_s();
  if (!segment.hole) {
    ProcessNoise noise = config_.noise;
    noise.wind_m_s_rts = wind_walk_m_s_rts();
    if (fixed_wing()) {
      noise.gust_down_m_s = gust_down_m_s();
      noise.gust_down_time_s = gust_down_time_s();
    }
    watch_steps(u, noise);
    filter_.predict(u, noise, config_.gravity_m_s2);
    if (u.dt_s > 0.0) {
      w_raw_B_ = u.dtheta_B / u.dt_s;
      f_raw_B_ = u.dv_B / u.dt_s;
    }
    fuse_air_force(segment);
    return;
  }
  step_watch_.restart();
  // White noise of what a vehicle may have done unseen; its attitude is never lost altogether.
  constexpr double kTurn_rad_rts = 0.5;
  constexpr double kAcceleration_m_s_rts = 5.0;
  constexpr double kMaxTilt_rad = 0.6;
  ProcessNoise unseen = config_.noise;
  unseen.gyro_rad_s_rtHz = kTurn_rad_rts;
  unseen.accel_m_s2_rtHz = kAcceleration_m_s_rts;
  // In parts: the noise of the velocity moves the position while it acts.
  constexpr double kPart_s = 0.1;
  const double parts = std::max(1.0, std::ceil(u.dt_s / kPart_s));
  const ImuIncrement part{u.dt_s / parts, u.dtheta_B / parts, u.dv_B / parts};
  for (int k = 0; k < static_cast<int>(parts); ++k) {
    filter_.predict(part, unseen, config_.gravity_m_s2);
  }
  for (int k = 0; k < 3; ++k) {
    const double sigma = std::sqrt(filter_.covariance()(Filter::kTheta + k, Filter::kTheta + k));
    if (sigma > kMaxTilt_rad) filter_.reset_variance(Filter::kTheta + k, 1, kMaxTilt_rad);
  }
  w_raw_B_ = filter_.state().gyro_bias_B;
  f_raw_B_ = Filter::steady(filter_.state(), 1.0, config_.gravity_m_s2).dv_B;
  force_ = {};
  constexpr double kLong_s = 0.5;
  if (u.dt_s > kLong_s) long_hole_end_s_ = t_s_;
  ++health_.imu_holes;
  health_.bridging = true;
}

bool AidFusion::note(Aid aid, const Filter::Verdict& verdict, int rows) {
  AidHealth& health = health_.of(aid);
  health.nis = verdict.nis / rows;
  if (verdict.accepted) {
    ++health.accepted;
    health.last_accepted_s = t_s_;
    health.rejecting = false;
    if (aid == Aid::kGnssHorizontal || aid == Aid::kRest || aid == Aid::kPose)
      health_.bridging = false;
  } else {
    ++health.rejected;
    if (!health.rejecting) health.rejected_since_s = t_s_;
    health.rejecting = true;
    health.last_rejected_s = t_s_;
  }
  return verdict.accepted;
}

void AidFusion::fuse(const AidSample& sample, double newest_s) {
  newest_s_ = newest_s;
  std::visit([this](const auto& s) { this->fuse(s); }, sample);
}

void AidFusion::fuse(const GnssSample& sample) {
  if (!reference_.origin) {  // started without a fix: the fix is at the position of the filter
    const Vector3 p_W = filter_.state().p_W + filter_.state().q_WB * gnss_lever();
    reference_.origin = moved(sample.position, -p_W);
    filter_.state().gnss_bias_W.setZero();  // counted from here
    filter_.reset_variance(Filter::kGnssBias, 3, config_.gnss_altitude_sigma_m);
  }
  const Vector3 p_W = ned_of(sample.position, *reference_.origin);
  const Vector2 before_W = shown_W();
  constexpr double kGap_s = 1.0;
  const bool was_away = t_s_ - health_.of(Aid::kGnssHorizontal).last_accepted_s > kGap_s;
  const std::uint64_t resets = health_.gnss_resets;
  fuse_gnss(sample, p_W, was_away);
  show_gradually(before_W, was_away || health_.gnss_resets != resets);
}

/// Where the output will be, which is ahead of the filter.
Vector2 AidFusion::shown_W() const {
  const NominalState& x = filter_.state();
  const double ahead_s = newest_s_ - t_s_;
  return (x.p_W + ahead_s * x.v_W).head<2>();
}

/// A correction by what has been away moves the output at a limited speed. @param before_W  shown_W() before it.
void AidFusion::show_gradually(const Vector2& before_W, bool returned) {
  constexpr double kReturning_s = 2.0;
  if (returned) jump_.until_s = t_s_ + kReturning_s;
  if (t_s_ > jump_.until_s) return;
  const Vector2 moved_W = shown_W() - before_W;
  jump_.moved_W = unshown_jump_W(t_s_) + moved_W;
  jump_.t_s = t_s_;
}

Vector2 AidFusion::unshown_jump_W(double t_s) const {
  const double size_m = jump_.moved_W.norm();
  constexpr double kMax_s = 5.0;
  const double speed_m_s = std::max(config_.jump_speed_m_s, size_m / kMax_s);
  const double shown_m = speed_m_s * (t_s - jump_.t_s);
  if (shown_m >= size_m) return Vector2::Zero();
  return jump_.moved_W * (1.0 - shown_m / size_m);
}

/// Innovations of the velocity by their standard deviations, two sigmas of what is always off to one side
/// counted in: a fault of the IMU is more than that.
Vector3 AidFusion::suspect_velocity(const Vector3& residual) const {
  constexpr double kSigmas = 2.0;
  const Vector3 variance = filter_.covariance().diagonal().segment<3>(Filter::kVelocity) +
                           Vector3::Constant(gnss_velocity_variance(kSigmas));
  return residual.cwiseQuotient(variance.cwiseSqrt());
}

/// Whether normalised innovations of the velocity have kept their sign for some time.
bool AidFusion::velocity_is_off(const Vector3& suspect) {
  bool off = false;
  for (int k = 0; k < 3; ++k) {
    const bool axis_off = velocity_means_[static_cast<std::size_t>(k)].exceeded(suspect(k));
    off = off || axis_off;
  }
  return off;
}

/// Besides the noise: the antenna is not just where the configuration has it, nor the fix of just that
/// instant, so turning and accelerating add to it, here as many sigmas of both.
double AidFusion::gnss_velocity_variance(double sigmas) const {
  const NominalState& x = filter_.state();
  const Vector3 gravity_W(0.0, 0.0, config_.gravity_m_s2);
  const double by_turning =
      sigmas * config_.gnss_position_sigma_m * (w_raw_B_ - x.gyro_bias_B).norm();
  const double by_accelerating = sigmas * config_.gnss_time_sigma_s *
                                 (x.q_WB * (f_raw_B_ - x.accel_bias_B) + gravity_W).norm();
  const double noise = config_.gnss_velocity_sigma_m_s;
  return noise * noise + by_turning * by_turning + by_accelerating * by_accelerating;
}

void AidFusion::fuse_gnss(const GnssSample& sample, const Vector3& p_W, bool was_away) {
  const auto square = [](double x) { return x * x; };
  constexpr double kGap_s = 1.0;
  const double accepted_s =
      std::max(health_.of(Aid::kGnssVelocity).last_accepted_s, started_on_fixes_s_);
  if (t_s_ - accepted_s > kGap_s) settled_since_s_ = 1e9;
  auto velocity = Filter::gnss_velocity(filter_.state(), sample.v_W_m_s, gnss_lever(), w_raw_B_);
  velocity.R = gnss_velocity_variance(1.0) * Matrix3::Identity();
  const Vector3 suspect = suspect_velocity(velocity.nu);
  const bool drifts = velocity_is_off(suspect);
  const bool velocity_ok = weigh<3>(Aid::kGnssVelocity, velocity, config_.gate_sigma);

  auto horizontal = Filter::gnss_position(filter_.state(), p_W, gnss_lever()).template rows<2>(0);
  horizontal.R = square(config_.gnss_horizontal_sigma_m) * Eigen::Matrix2d::Identity();
  const bool horizontal_ok = weigh<2>(Aid::kGnssHorizontal, horizontal, config_.gate_sigma);
  constexpr double kDisagreement_sigma = 2.0;  // one right fix in twenty is off by more
  if (was_away && horizontal_ok &&
      2.0 * health_.of(Aid::kGnssHorizontal).nis > Filter::gate(2, kDisagreement_sigma)) {
    disagreement_W_ += horizontal.nu;
  }
  if (horizontal_ok && settled_since_s_ > t_s_) settled_since_s_ = t_s_;

  auto altitude = Filter::gnss_position(filter_.state(), p_W, gnss_lever()).template rows<1>(2);
  altitude.R(0) = square(config_.gnss_altitude_sigma_m);
  static_cast<void>(weigh<1>(Aid::kGnssAltitude, altitude, config_.gate_sigma));

  const AidHealth& of_velocity = health_.of(Aid::kGnssVelocity);
  if (velocity_monitor_.exceeded(suspect.squaredNorm() / 3.0) ||
      of_velocity.rejecting_for_s() > config_.gnss_rejected_s) {
    widen_imu_errors(kLargeFault);
    if (!velocity_ok) {  // it was not used yet
      static_cast<void>(filter_.correct(velocity, config_.gate_sigma));
    }
  }
  if (drifts) widen_imu_errors(kSmallFault);
  if (health_.of(Aid::kGnssAltitude).rejecting_for_s() > config_.gnss_jump_s) {
    restart_gnss_bias(2, 1, p_W);
    health_.of(Aid::kGnssAltitude).rejecting = false;
  }
  const AidHealth& of_position = health_.of(Aid::kGnssHorizontal);
  // The position was right for a while, then it alone was not: the receiver's has jumped.
  constexpr double kSettled_s = 2.0;
  const bool settled = of_position.rejected_since_s - settled_since_s_ > kSettled_s;
  if (velocity_ok && settled && of_position.rejecting_for_s() > config_.gnss_jump_s) {
    constexpr double kBack = 0.2;  // of the way
    if ((horizontal.nu + disagreement_W_).norm() < kBack * disagreement_W_.norm()) {
      reset_to_gnss(p_W, sample.v_W_m_s);
      disagreement_W_ += horizontal.nu;
      return;
    }
    restart_gnss_bias(0, 2, p_W);
    health_.of(Aid::kGnssHorizontal).rejecting = false;
    return;
  }
  const double rejected_s = std::max(of_velocity.rejecting_for_s(), of_position.rejecting_for_s());
  if (rejected_s <= config_.gnss_reset_s) return;
  reset_to_gnss(p_W, sample.v_W_m_s);
  if (velocity_ok) disagreement_W_ += horizontal.nu;
}

bool AidFusion::off_the_ground() const {
  constexpr double kClear_m = 0.3;
  constexpr double kClearOfRunway_m = 1.5;
  return height_above_ground_m() > (fixed_wing() ? kClearOfRunway_m : kClear_m);
}

double AidFusion::height_above_ground_m() const {
  return -filter_.state().p_W.z() - ground_up_m_ - config_.height_at_rest_m;
}

bool AidFusion::dead_reckoning() const {
  constexpr double kGap_s = 0.5;
  return t_s_ - std::max(health_.of(Aid::kGnssVelocity).last_accepted_s,
                         health_.of(Aid::kPose).last_accepted_s) >
         kGap_s;
}

/// Nothing of this aid was used for a while.
bool AidFusion::silent(Aid aid) const {
  constexpr double kGap_s = 1.0;
  return t_s_ - health_.of(aid).last_accepted_s > kGap_s;
}

/// After a long hole the attitude and the velocity are too far off for what is linear in both: GNSS
/// comes first, if it comes soon.
bool AidFusion::waits_for_gnss() const {
  constexpr double kSoon_s = 1.0;
  return health_.bridging && t_s_ - long_hole_end_s_ < kSoon_s;
}

/// The mean specific force at the body's origin: that at the IMU less what turning adds to it there.
Vector3 AidFusion::force_at_origin() const {
  const Vector3& r_B = config_.imu_position_B;
  const Vector3 w_B = 0.5 * (force_.w_start_B + w_raw_B_) - filter_.state().gyro_bias_B;
  const Vector3 angular_B = (w_raw_B_ - force_.w_start_B) / force_.dt_s;
  return force_.dv_B / force_.dt_s - angular_B.cross(r_B) - w_B.cross(w_B.cross(r_B));
}

void AidFusion::fuse(const BaroSample& sample) {
  density_kg_m3_ = standard_density_kg_m3(sample.pressure_Pa);
  if (waits_for_gnss()) return;  // it may have jumped unseen, and the altitude would follow it
  const double height_m = standard_height_m(sample.pressure_Pa) - origin_pressure_height_m_;
  auto residual = Filter::baro_height(filter_.state(), height_m);
  residual.R(0) = config_.baro_sigma_m * config_.baro_sigma_m;
  const bool accepted = weigh<1>(Aid::kBaro, residual, config_.gate_sigma);
  const bool drifts = height_drifts(residual);
  if (accepted) return;
  if (dead_reckoning() && drifts) {
    widen_vertical();
    if (weigh<1>(Aid::kBaro, residual, config_.gate_sigma)) return;
  }
  if (health_.of(Aid::kBaro).rejecting_for_s() < config_.baro_relearn_s) return;
  filter_.relearn_baro_bias(height_m, config_.baro_sigma_m);
  step_watch_.restart();
  health_.of(Aid::kBaro).rejecting = false;
  ++health_.baro_relearned;
}

void AidFusion::fuse(const RangeSample& sample) {
  const NominalState& x = filter_.state();
  const double cosine = (x.q_WB * Vector3::UnitZ()).z();
  if (cosine < std::cos(config_.range_max_tilt_rad)) return;
  const Vector3 lever_B = config_.range_position_B - config_.imu_position_B;
  auto residual = Filter::range(x, sample.range_m, ground_up_m_, lever_B);
  residual.R(0) = config_.range_sigma_m * config_.range_sigma_m;
  if (weigh<1>(Aid::kRange, residual, config_.gate_sigma)) return;
  if (health_.of(Aid::kRange).rejecting_for_s() < config_.range_relearn_s) return;
  const double sensor_up_m = -(x.p_W + x.q_WB * lever_B).z();
  ground_up_m_ = sensor_up_m - sample.range_m * cosine;
  health_.of(Aid::kRange).rejecting = false;
  ++health_.ground_relearned;
}

void AidFusion::fuse_rest() {
  auto residual = Filter::velocity(filter_.state(), Vector3::Zero());
  residual.R = config_.rest_sigma_m_s * config_.rest_sigma_m_s * Matrix3::Identity();
  static_cast<void>(weigh<3>(Aid::kRest, residual, config_.gate_sigma));
}

}  // namespace rosflight::autonomy::estimation
