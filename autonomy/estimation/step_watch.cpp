// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/step_watch.hpp"

#include <cmath>

namespace rosflight::autonomy::estimation {
namespace {

constexpr double kOnsetEvery_s = 1.0;
/// Least mean Bayes factor, as a logarithm: of all onsets without a fault a share of 1e-7 exceeds it at most,
/// in gusts that are not as modelled more.
constexpr double kMinLogEvidence = 16.0;

}  // namespace

void StepWatch::restart() {
  for (Hypotheses& all : room_) {
    all.errors.setZero();
    all.information.setZero();
    all.drive.setZero();
  }
  begun_ = 0;
  since_s_ = 0.0;
}

void StepWatch::begin_onset() {
  const int first = begun_ % kOnsets * kSteps;
  Hypotheses& all = room_.front();
  all.errors.middleCols<kSteps>(first).setZero();
  all.information.segment<kSteps>(first).setZero();
  all.drive.segment<kSteps>(first).setZero();
  const auto step = [&all, first](int column, int error, double sigma) {
    all.errors(error, first + column) = 1.0;
    all.variance(first + column) = sigma * sigma;
  };
  for (int axis = 0; axis < 3; ++axis) {
    step(axis, Filter::kGyroBias + axis, sizes_.gyro_rad_s);
    step(3 + axis, Filter::kAccelBias + axis, sizes_.accel_m_s2);
  }
  for (int axis = 0; axis < 2; ++axis) step(6 + axis, Filter::kWind + axis, sizes_.wind_m_s);
  ++begun_;
  since_s_ = 0.0;
}

void StepWatch::predict(const NominalState& x, const ImuIncrement& u, const ProcessNoise& noise) {
  if (begun_ == 0 || since_s_ >= kOnsetEvery_s) begin_onset();
  Filter::carry(x, u, noise, room_.front().errors);
  since_s_ += u.dt_s;
}

void StepWatch::observe(const Filter::Residual<1>& residual, const Filter::Verdict& verdict) {
  if (!running() || !verdict.accepted) return;
  Hypotheses& all = room_.front();
  const Row h = residual.H * all.errors;
  all.information += h.cwiseAbs2() / verdict.variance;
  all.drive += h * (residual.nu(0) / verdict.variance);
  all.errors.noalias() -= verdict.gain * h;
}

StepWatch::Row StepWatch::log_factors() const {
  const Hypotheses& all = room_.front();
  const Eigen::Array<double, 1, kHypotheses> by_size =
      1.0 + all.variance.array() * all.information.array();
  return 0.5 * (all.drive.array().square() * all.variance.array() / by_size - by_size.log());
}

double StepWatch::log_evidence() const {
  if (!running()) return 0.0;
  const Row log_b = log_factors();
  const double largest = log_b.maxCoeff();
  return largest + std::log((log_b.array() - largest).exp().mean());
}

bool StepWatch::decide(Filter& filter) {
  if (!running()) return false;
  const Row log_b = log_factors();
  const double largest = log_b.maxCoeff();
  const Row weights = (log_b.array() - largest).exp();
  if (largest + std::log(weights.mean()) < kMinLogEvidence) return false;
  const Row p = weights / weights.sum();
  const Hypotheses& all = room_.front();
  const Row c = all.variance.array() / (1.0 + all.variance.array() * all.information.array());
  const Row size = all.drive.cwiseProduct(c);
  const Filter::Error mean = all.errors * p.cwiseProduct(size).transpose();
  const Row square = p.array() * (c.array() + size.array().square());
  const Eigen::Matrix<double, Filter::kSize, kHypotheses> scaled =
      all.errors * square.cwiseSqrt().asDiagonal();
  filter.covariance().noalias() += scaled * scaled.transpose();
  filter.covariance().noalias() -= mean * mean.transpose();
  const Filter::Covariance symmetric =
      0.5 * (filter.covariance() + filter.covariance().transpose());
  filter.covariance() = symmetric;
  filter.inject(mean);
  restart();
  return true;
}

}  // namespace rosflight::autonomy::estimation
