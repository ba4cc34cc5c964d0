// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/aid_fusion.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

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

template <bool kWind>
void AidFusion<kWind>::reset() {
  filter_ = Filter{};
  ground_up_m_ = 0.0;
  jump_ = {};
  const std::uint64_t restarts = health_.restarts;
  health_ = {};
  health_.restarts = restarts;
}

template <bool kWind>
void AidFusion<kWind>::start(double t_s, const NominalState& state, const Covariance& covariance,
                             double pressure_Pa) {
  t_s_ = t_s;
  filter_ = Filter{};
  filter_.state() = state;
  filter_.covariance() = covariance;
  density_kg_m3_ = standard_density_kg_m3(pressure_Pa);
  origin_pressure_height_m_ = standard_height_m(pressure_Pa) + state.p_W.z() - state.baro_bias_m;
  health_.initialised = true;
}

template <bool kWind>
void AidFusion<kWind>::predict(const ImuBuffer::Segment& segment) {
  filter_.predict(segment.u, config_.noise, config_.gravity_m_s2);
  t_s_ = segment.end_s();
  if (segment.u.dt_s > 0.0) w_raw_B_ = segment.u.dtheta_B / segment.u.dt_s;
  if (!segment.hole) return;
  // What a vehicle may have done unseen.
  constexpr double kRate_rad_s = 0.5;
  constexpr double kAcceleration_m_s2 = 5.0;
  ++health_.imu_holes;
  health_.bridging = true;
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
bool AidFusion<kWind>::weigh(Aid aid, const typename Filter::template Residual<kRows>& residual,
                             double gate_sigma) {
  const typename Filter::Verdict verdict = filter_.correct(residual, gate_sigma);
  AidHealth& health = health_.of(aid);
  health.nis = verdict.nis / kRows;
  if (verdict.accepted) {
    ++health.accepted;
    health.last_accepted_s = t_s_;
    health.rejecting = false;
    if (aid == Aid::kGnssHorizontal || aid == Aid::kRest) health_.bridging = false;
  } else {
    ++health.rejected;
    if (!health.rejecting) health.rejected_since_s = t_s_;
    health.rejecting = true;
    health.last_rejected_s = t_s_;
  }
  return verdict.accepted;
}

template <bool kWind>
void AidFusion<kWind>::fuse(const AidSample& sample, double newest_s) {
  newest_s_ = newest_s;
  std::visit([this](const auto& s) { this->fuse(s); }, sample);
}

template <bool kWind>
void AidFusion<kWind>::fuse(const GnssSample& sample) {
  if (!reference_.origin) {  // started without a fix: the fix is at the position of the filter
    const Vector3 p_W = filter_.state().p_W + filter_.state().q_WB * gnss_lever();
    const Geodetic here = sample.position;
    constexpr double kMetresPerDegree = 111.2e3;
    reference_.origin =
        Geodetic{here.latitude_deg - p_W.x() / kMetresPerDegree,
                 here.longitude_deg -
                     p_W.y() / (kMetresPerDegree * std::cos(here.latitude_deg * kRadPerDeg)),
                 here.altitude_m + p_W.z()};
  }
  const Vector3 p_W = ned_of(sample.position, *reference_.origin);
  // Where the output will be, which is ahead of the filter.
  const double ahead_s = newest_s_ - t_s_;
  const auto shown_W = [this, ahead_s]() -> Vector2 {
    const NominalState& x = filter_.state();
    return (x.p_W + ahead_s * x.v_W).template head<2>();
  };
  const Vector2 before_W = shown_W();
  constexpr double kGap_s = 1.0;
  const bool was_away = t_s_ - health_.of(Aid::kGnssHorizontal).last_accepted_s > kGap_s;
  const std::uint64_t resets = health_.gnss_resets;
  fuse_gnss(sample, p_W);
  constexpr double kReturning_s = 2.0;
  if (was_away || health_.gnss_resets != resets) jump_.until_s = t_s_ + kReturning_s;
  if (t_s_ > jump_.until_s) return;
  const Vector2 moved_W = shown_W() - before_W;
  jump_.moved_W = unshown_jump_W(t_s_) + moved_W;
  jump_.t_s = t_s_;
}

template <bool kWind>
Vector2 AidFusion<kWind>::unshown_jump_W(double t_s) const {
  const double size_m = jump_.moved_W.norm();
  constexpr double kMax_s = 5.0;
  const double speed_m_s = std::max(config_.jump_speed_m_s, size_m / kMax_s);
  const double shown_m = speed_m_s * (t_s - jump_.t_s);
  if (shown_m >= size_m) return Vector2::Zero();
  return jump_.moved_W * (1.0 - shown_m / size_m);
}

template <bool kWind>
void AidFusion<kWind>::fuse_gnss(const GnssSample& sample, const Vector3& p_W) {
  const auto square = [](double x) { return x * x; };
  auto velocity = Filter::gnss_velocity(filter_.state(), sample.v_W_m_s, gnss_lever(), w_raw_B_);
  velocity.R = square(config_.gnss_velocity_sigma_m_s) * Matrix3::Identity();
  const bool velocity_ok = weigh<3>(Aid::kGnssVelocity, velocity, config_.gate_sigma);

  auto horizontal = Filter::gnss_position(filter_.state(), p_W, gnss_lever()).template rows<2>(0);
  horizontal.R = square(config_.gnss_horizontal_sigma_m) * Eigen::Matrix2d::Identity();
  const bool horizontal_ok = weigh<2>(Aid::kGnssHorizontal, horizontal, config_.gate_sigma);

  auto altitude = Filter::gnss_position(filter_.state(), p_W, gnss_lever()).template rows<1>(2);
  altitude.R(0) = square(config_.gnss_altitude_sigma_m);
  static_cast<void>(weigh<1>(Aid::kGnssAltitude, altitude, config_.gate_sigma));

  if (velocity_ok && horizontal_ok) return;
  if (health_.of(Aid::kGnssVelocity).rejecting_for_s() > config_.gnss_doubt_s) widen_imu_errors();
  const double rejected_s = std::max(health_.of(Aid::kGnssVelocity).rejecting_for_s(),
                                     health_.of(Aid::kGnssHorizontal).rejecting_for_s());
  if (rejected_s > config_.gnss_reset_s) reset_to_gnss(p_W, sample.v_W_m_s);
}

/// The velocity drifts away from that of GNSS: a bias must have jumped. Widens the variances that
/// such a jump affects, so that the next fixes pass their gates and correct it.
template <bool kWind>
void AidFusion<kWind>::widen_imu_errors() {
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
  ++health_.imu_widenings;
}

/// Horizontal position and velocity as GNSS has them; the height only where it has no other aid.
template <bool kWind>
void AidFusion<kWind>::reset_to_gnss(const Vector3& p_W, const Vector3& v_W) {
  constexpr double kTilt_rad = 0.05;
  NominalState& x = filter_.state();
  const Vector3 lever_W = x.q_WB * gnss_lever();
  x.p_W.head<2>() = (p_W - lever_W).head<2>();
  x.v_W = v_W;
  filter_.reset_variance(Filter::kPosition, 2, 2.0 * config_.gnss_horizontal_sigma_m);
  filter_.reset_variance(Filter::kVelocity, 3, 5.0 * config_.gnss_velocity_sigma_m_s);
  for (int k = 0; k < 3; ++k) {  // the same error has turned the attitude too
    filter_.covariance()(Filter::kTheta + k, Filter::kTheta + k) += kTilt_rad * kTilt_rad;
  }
  for (const Aid aid : {Aid::kGnssHorizontal, Aid::kGnssVelocity}) {
    health_.of(aid).rejecting = false;
    health_.of(aid).last_accepted_s = t_s_;
  }
  ++health_.gnss_resets;
}

template <bool kWind>
void AidFusion<kWind>::fuse(const BaroSample& sample) {
  density_kg_m3_ = standard_density_kg_m3(sample.pressure_Pa);
  const double height_m = standard_height_m(sample.pressure_Pa) - origin_pressure_height_m_;
  auto residual = Filter::baro_height(filter_.state(), height_m);
  residual.R(0) = config_.baro_sigma_m * config_.baro_sigma_m;
  if (weigh<1>(Aid::kBaro, residual, config_.gate_sigma)) return;
  if (health_.of(Aid::kBaro).rejecting_for_s() < config_.baro_relearn_s) return;
  filter_.relearn_baro_bias(height_m, config_.baro_sigma_m);
  health_.of(Aid::kBaro).rejecting = false;
  ++health_.baro_relearned;
}

template <bool kWind>
void AidFusion<kWind>::fuse(const MagSample& sample) {
  if (!reference_.declination_rad) return;
  auto residual =
      Filter::magnetic_heading(filter_.state(), sample.field_T, *reference_.declination_rad);
  const double level_T = (filter_.state().q_WB * sample.field_T).template head<2>().norm();
  constexpr double kMinLevel = 0.05;  // of the field: nearer to vertical it has no heading
  if (level_T < kMinLevel * sample.field_T.norm()) return;
  const double by_noise = config_.mag_sigma_T / level_T;
  residual.R(0) = by_noise * by_noise + config_.heading_sigma_rad * config_.heading_sigma_rad;
  static_cast<void>(weigh<1>(Aid::kHeading, residual, config_.heading_gate_sigma));
}

template <bool kWind>
void AidFusion<kWind>::fuse(const RangeSample& sample) {
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

template <bool kWind>
void AidFusion<kWind>::fuse(const PitotSample& sample) {
  if constexpr (kWind) {
    const NominalState& x = filter_.state();
    const Vector3 wind_W(x.wind_W.x(), x.wind_W.y(), 0.0);
    const double forward_m_s = (x.q_WB.conjugate() * (x.v_W - wind_W)).x();
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
void AidFusion<kWind>::fuse(const SideslipSample& sample) {
  auto residual = Filter::sideslip(filter_.state(), sample.v_air_y_m_s);
  residual.R(0) = config_.sideslip_sigma_m_s * config_.sideslip_sigma_m_s;
  static_cast<void>(weigh<1>(Aid::kSideslip, residual, config_.gate_sigma));
}

template <bool kWind>
void AidFusion<kWind>::fuse_rest() {
  auto residual = Filter::velocity(filter_.state(), Vector3::Zero());
  residual.R = config_.rest_sigma_m_s * config_.rest_sigma_m_s * Matrix3::Identity();
  static_cast<void>(weigh<3>(Aid::kRest, residual, config_.gate_sigma));
}

template class AidFusion<false>;
template class AidFusion<true>;

}  // namespace rosflight::autonomy::estimation
