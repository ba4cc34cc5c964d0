// SPDX-License-Identifier: BSD-3-Clause
// The watch on steps of the IMU against a filter that allowed for the step from the start, and against noise.
#include <gtest/gtest.h>

#include <random>

#include "autonomy/estimation/step_watch.hpp"

namespace rosflight::autonomy::estimation {
namespace {

using Filter = ErrorStateEkf;

constexpr double kDt_s = 0.01;
constexpr double kGravity = 9.80665;
constexpr double kVelocitySigma_m_s = 0.1;

/// A vehicle at rest whose velocity is measured, one axis after the other.
struct Rig {
  explicit Rig(std::uint64_t seed) : random{seed} {
    filter.covariance().setZero();
    filter.reset_variance(Filter::kTheta, 3, 0.01);
    filter.reset_variance(Filter::kVelocity, 3, 0.1);
    filter.reset_variance(Filter::kGyroBias, 3, 1e-3);
    filter.reset_variance(Filter::kAccelBias, 3, 0.02);
  }
  double normal() { return std::normal_distribution<double>{}(random); }
  /// What the accelerometer reads at rest, wrong by `accel_step_m_s2`, for one increment, and its measurements.
  void step(const Vector3& accel_step_m_s2) {
    const Vector3 force_B = Vector3(0.0, 0.0, -kGravity) + accel_step_m_s2;
    const ImuIncrement u{kDt_s, Vector3::Zero(), force_B * kDt_s};
    watch.predict(filter.state(), u, noise);
    filter.predict(u, noise, kGravity);
    Filter::Residual<1> r;
    const int axis = axis_++ % 3;
    r.nu(0) = kVelocitySigma_m_s * normal() - filter.state().v_W(axis);
    r.H(0, Filter::kVelocity + axis) = 1.0;
    r.R(0) = kVelocitySigma_m_s * kVelocitySigma_m_s;
    watch.observe(r, filter.correct(r, 1e3));
  }

  std::mt19937_64 random;
  ProcessNoise noise;
  Filter filter;
  StepWatch watch;

 private:
  int axis_{0};
};

TEST(StepWatch, GivesTheFilterWhatItWouldHaveHadWithTheStepAllowedForFromTheStart) {
  // One hypothesis has a size, the others are as good as no step.
  constexpr double kSigma_m_s2 = 1.0, kTiny = 1e-6;
  for (const double step_m_s2 : {1.5, -2.0}) {
    Rig plain(1), prepared(1);
    plain.watch = StepWatch({kTiny, kSigma_m_s2, kTiny});
    prepared.filter.covariance()(Filter::kAccelBias, Filter::kAccelBias) +=
        kSigma_m_s2 * kSigma_m_s2;
    for (int k = 0; k < 60; ++k) {
      for (Rig* rig : {&plain, &prepared}) rig->step({step_m_s2, 0.0, 0.0});
    }
    ASSERT_GT(plain.watch.log_evidence(), 20.0);
    ASSERT_TRUE(plain.watch.decide(plain.filter));
    EXPECT_FALSE(plain.watch.running());
    const Filter::Error difference =
        Filter::difference(plain.filter.state(), prepared.filter.state());
    // Less the logarithm of the hypotheses without a size, whose weight is 1e-7.
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.02);
    EXPECT_NEAR(plain.filter.state().accel_bias_B.x(), step_m_s2, 0.25);
    const auto& P = plain.filter.covariance();
    EXPECT_NEAR(P(Filter::kAccelBias, Filter::kAccelBias) /
                    prepared.filter.covariance()(Filter::kAccelBias, Filter::kAccelBias),
                1.0, 0.02);
    EXPECT_LT((P - P.transpose()).norm(), 1e-18);
  }
}

TEST(StepWatch, NoiseIsNoStep) {
  Rig rig(3);
  for (int k = 0; k < 100'000; ++k) {
    rig.step(Vector3::Zero());
    if (k % 5 != 0) continue;
    ASSERT_FALSE(rig.watch.decide(rig.filter)) << k;
  }
}

TEST(StepWatch, FindsAStepThatBeganBetweenItsOnsetsAndNamesItsAxis) {
  // At rest a step along x may as well be one of the gyro about y, by the velocity alone: this one is along z.
  Rig rig(4);
  for (int k = 0; k < 1240; ++k) {
    rig.step(Vector3::Zero());
    ASSERT_FALSE(rig.watch.decide(rig.filter));
  }
  constexpr double kStep_m_s2 = 0.7;
  bool found = false;
  for (int k = 0; k < 200 && !found; ++k) {
    rig.step({0.0, 0.0, kStep_m_s2});
    found = rig.watch.decide(rig.filter);
  }
  ASSERT_TRUE(found);
  for (int k = 0; k < 300; ++k) rig.step({0.0, 0.0, kStep_m_s2});
  EXPECT_NEAR(rig.filter.state().accel_bias_B.z(), kStep_m_s2, 0.15);
  EXPECT_LT(rig.filter.state().accel_bias_B.head<2>().norm(), 0.05);
}

TEST(StepWatch, ARejectedSampleDoesNotCount) {
  Rig rig(5);
  for (int k = 0; k < 50; ++k) rig.step(Vector3::Zero());
  const double before = rig.watch.log_evidence();
  Filter::Residual<1> r;
  r.H(0, Filter::kVelocity) = 1.0;
  r.R(0) = 1e-4;
  r.nu(0) = 50.0;
  const Filter::Verdict verdict = rig.filter.correct(r, 5.0);
  ASSERT_FALSE(verdict.accepted);
  rig.watch.observe(r, verdict);
  EXPECT_EQ(rig.watch.log_evidence(), before);
}

}  // namespace
}  // namespace rosflight::autonomy::estimation
