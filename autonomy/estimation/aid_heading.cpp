// SPDX-License-Identifier: BSD-3-Clause
// How an AidFusion uses the magnetometer: for the heading alone, and what it does when heading and gyro disagree.
#include <algorithm>
#include <cmath>
#include <limits>

#include "autonomy/estimation/aid_fusion.hpp"
#include "base/angles.hpp"

namespace rosflight::autonomy::estimation {

void AidFusion::fuse(const MagSample& sample) {
  if (!reference_.declination_rad) return;
  auto residual =
      Filter::magnetic_heading(filter_.state(), sample.field_T, *reference_.declination_rad);
  const double level_T = (filter_.state().q_WB * sample.field_T).head<2>().norm();
  constexpr double kMinLevel = 0.05;  // of the field: nearer to vertical it has no heading
  if (level_T < kMinLevel * sample.field_T.norm()) return;
  const double by_noise = config_.mag_sigma_T / level_T;
  residual.R(0) = by_noise * by_noise + config_.heading_sigma_rad * config_.heading_sigma_rad;
  const bool fits = field_fits(sample.field_T);
  const double gate_sigma = heading_gate(residual, fits);
  const Filter::Verdict verdict = filter_.correct_heading(residual, gate_sigma);
  step_watch_.observe(residual, verdict);
  if (note(Aid::kHeading, verdict, 1)) {
    learn_vertical_field(sample.field_T);
  }
  // What was used has been weighed with all other aids by the watch on steps, where that runs.
  const bool weighed = step_watch_.running() && verdict.accepted;
  if (heading_drifts(residual, fits) && !weighed) widen_heading();
}

double AidFusion::vertical_field_T(const Vector3& field_B) const {
  const NominalState& x = filter_.state();
  return (x.q_WB * (field_B - x.mag_bias_B)).z();
}

void AidFusion::learn_vertical_field(const Vector3& field_B) {
  constexpr double kShare = 0.01;
  const double down_T = vertical_field_T(field_B);
  heading_.down_T = heading_.down_T.value_or(down_T);
  *heading_.down_T += kShare * (down_T - *heading_.down_T);
}

/// Whether the vertical part of the field is as it was: it does not depend on the heading, so a gyro
/// that is wrong about the vertical leaves it, while a magnetometer that is turned or beside new
/// iron changes it as soon as the vehicle tilts.
bool AidFusion::field_fits(const Vector3& field_B) const {
  if (!heading_.down_T) return true;
  constexpr double kTilt_rad = 0.02;  // times the horizontal field
  const double level_T = (filter_.state().q_WB * field_B).head<2>().norm();
  const double sigma_T =
      Eigen::Vector3d{config_.mag_sigma_T, config_.initial_mag_bias_T, kTilt_rad * level_T}.norm();
  return std::abs(vertical_field_T(field_B) - *heading_.down_T) <
         config_.heading_gate_sigma * sigma_T;
}

/// The gate of a heading: none passes that does not fit; after a refusal of some time, only once it has
/// fitted for kEnough_s, since that of a wrong magnetometer passes the right one in turns: in a circle
/// at 20 degrees of bank for more than a second. Meanwhile such a circle turns by a radian.
double AidFusion::heading_gate(const Filter::Residual<1>& residual, bool fits) {
  constexpr double kRefused_s = 0.3;
  constexpr double kEnough_s = 5.0;
  constexpr double kSeldom_s = 0.1;  // samples that come seldomer count as much
  const double since_s = std::min(t_s_ - heading_.seen_s, kSeldom_s);
  heading_.seen_s = t_s_;
  const AidHealth& health = health_.of(Aid::kHeading);
  if (health.rejecting_for_s() < kRefused_s) {
    heading_.fitting_s = 0.0;
    return fits ? config_.heading_gate_sigma : 0.0;
  }
  const double S = (residual.H * filter_.covariance() * residual.H.transpose())(0) + residual.R(0);
  const double limit = Filter::gate(1, config_.heading_gate_sigma);
  const bool inside = residual.nu(0) * residual.nu(0) <= limit * S;
  heading_.fitting_s = fits && inside ? heading_.fitting_s + since_s : 0.0;
  return heading_.fitting_s > kEnough_s ? config_.heading_gate_sigma : 0.0;
}

/// Whether the heading drifts away from that of the magnetometer as with a gyro that is wrong by up
/// to kGyroStepLimit_rad_s, counted from the last heading that was used.
bool AidFusion::heading_drifts(const Filter::Residual<1>& residual, bool fits) {
  constexpr double kSigmas = 4.0;
  const AidHealth& health = health_.of(Aid::kHeading);
  if (!health.rejecting) {
    heading_.residual_rad = residual.nu(0);
    heading_.t_s = t_s_;
    heading_.jumped = false;
  }
  const double drift_rad = std::abs(base::wrap_angle(residual.nu(0) - heading_.residual_rad));
  const double possible_rad =
      kSigmas * std::sqrt(residual.R(0)) + kGyroStepLimit_rad_s * (t_s_ - heading_.t_s);
  heading_.jumped = heading_.jumped || drift_rad > possible_rad || !fits;
  if (heading_.jumped) {
    heading_monitor_.reset();
    return false;
  }
  if (!heading_monitor_.exceeded(health.nis)) return false;
  // Widened again and again, it would have followed: another aid holds it against the magnetometer.
  constexpr double kPause_s = 10.0;
  constexpr int kEnough = 2;
  heading_.widened = t_s_ - heading_.widened_s < kPause_s ? heading_.widened + 1 : 1;
  heading_.widened_s = t_s_;
  heading_.jumped = heading_.widened > kEnough;
  return !heading_.jumped;
}

/// The heading drifts: widens it and the gyro bias about the vertical.
void AidFusion::widen_heading() {
  constexpr double kHeading_rad = 0.1;
  constexpr double kGyroBias_rad_s = 0.2;
  const double kAcross_rad_s = dead_reckoning() && !step_watch_.running()
                                   ? 0.1
                                   : 0.05;  // the wrong axis need not be vertical
  const Vector3 down_B = filter_.state().q_WB.conjugate() * Vector3::UnitZ();
  const Matrix3 along = down_B * down_B.transpose();
  auto& P = filter_.covariance();
  P.block<3, 3>(Filter::kTheta, Filter::kTheta) += kHeading_rad * kHeading_rad * along;
  P.block<3, 3>(Filter::kGyroBias, Filter::kGyroBias) +=
      kGyroBias_rad_s * kGyroBias_rad_s * along +
      kAcross_rad_s * kAcross_rad_s * Matrix3::Identity();
  // The iron has taken in part of the drift.
  constexpr double kIron_microtesla = 0.3;
  P.block<3, 3>(Filter::kMagBias, Filter::kMagBias) +=
      kIron_microtesla * kIron_microtesla * Matrix3::Identity();
  heading_.fitting_s = 1e9;  // the next one counts
  ++health_.heading_widenings;
}

void AidFusion::start_heading(const Vector3& field_B) {
  if (!reference_.declination_rad) return;
  auto residual = Filter::magnetic_heading(filter_.state(), field_B, *reference_.declination_rad);
  const double level_T = (filter_.state().q_WB * field_B).head<2>().norm();
  const double sigma_rad =
      Eigen::Vector2d{config_.mag_sigma_T / level_T, config_.heading_sigma_rad}.norm();
  residual.R(0) = sigma_rad * sigma_rad;
  static_cast<void>(filter_.correct(residual, std::numeric_limits<double>::infinity()));
}

}  // namespace rosflight::autonomy::estimation
