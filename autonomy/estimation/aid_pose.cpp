// SPDX-License-Identifier: BSD-3-Clause
// How an AidFusion uses poses from outside, as of motion capture: position, heading, and what a long absence leads to.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/aid_fusion.hpp"

namespace rosflight::autonomy::estimation {
namespace {

double squared(double x) {
  return x * x;
}

}  // namespace

double AidFusion::aided_s() const {
  return std::max({health_.of(Aid::kGnssVelocity).last_accepted_s,
                   health_.of(Aid::kGnssHorizontal).last_accepted_s,
                   health_.of(Aid::kPose).last_accepted_s});
}

void AidFusion::fuse(const PoseSample& sample) {
  constexpr double kGap_s = 1.0;
  const Vector2 before_W = shown_W();
  const bool was_away = t_s_ - health_.of(Aid::kPose).last_accepted_s > kGap_s;
  const bool was_reset = fuse_position(sample.p_W);
  fuse_heading(sample.q_WB);
  show_gradually(before_W, was_away || was_reset);
}

/// The position without the slow error that satellites have. @returns whether the state was set to it.
bool AidFusion::fuse_position(const Vector3& p_W) {
  const Vector3 lever_B = -config_.imu_position_B;
  auto residual = Filter::gnss_position(filter_.state(), p_W, lever_B);
  residual.nu += filter_.state().gnss_bias_W;
  residual.H.block<3, 3>(0, Filter::kGnssBias).setZero();
  residual.R = squared(config_.pose_position_sigma_m) * Matrix3::Identity();
  if (weigh<3>(Aid::kPose, residual, config_.gate_sigma)) return false;
  if (health_.of(Aid::kPose).rejecting_for_s() <= config_.pose_reset_s) return false;
  // For so long it is not the cameras: the position is theirs, the velocity is learned again.
  constexpr double kVelocity_m_s = 2.0;
  filter_.state().p_W += residual.nu;
  filter_.reset_variance(Filter::kPosition, 3, config_.pose_position_sigma_m);
  filter_.reset_variance(Filter::kVelocity, 3, kVelocity_m_s);
  AidHealth& health = health_.of(Aid::kPose);
  health.rejecting = false;
  health.last_accepted_s = t_s_;
  ++health_.gnss_resets;
  return true;
}

/// The turn from our attitude to the measured one, about the vertical. Like that of the magnetometer it never tilts.
void AidFusion::fuse_heading(const Quaternion& q_WB) {
  const NominalState& x = filter_.state();
  Filter::Residual<1> residual;
  residual.nu(0) = log_rotation(q_WB * x.q_WB.conjugate()).z();
  residual.H.block<1, 3>(0, Filter::kTheta) = x.q_WB.toRotationMatrix().row(2);
  residual.R(0) = squared(config_.pose_heading_sigma_rad);
  const Filter::Verdict verdict = filter_.correct_heading(residual, config_.gate_sigma);
  step_watch_.observe(residual, verdict);
  static_cast<void>(note(Aid::kPoseHeading, verdict, 1));
}

}  // namespace rosflight::autonomy::estimation
