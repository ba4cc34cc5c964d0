// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer_frames.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosflight::core {
namespace {

constexpr float kMotorRate_hz = 490.0f;
constexpr float kServoRate_hz = 50.0f;

/// A multirotor with all motors pointing up: motor k at angle theta from the nose adds
/// [0, 0, -1/n, -sin theta, cos theta, +-1] to force and torque; yaw signs alternate from +1 (nose
/// right).
struct Frame {
  std::size_t motors;
  float force_z;
  std::array<float, 8> torque_x;
  std::array<float, 8> torque_y;
};

/// Quad + to X8, ids 1..8. Four decimals, as in ROSflight 2.0.1, so that gains agree in every
/// digit.
constexpr std::array<Frame, 8> kFrames{{
    {4, -0.25f, {0.0f, -1.0f, 0.0f, 1.0f}, {1.0f, 0.0f, -1.0f, 0.0f}},
    {4, -0.25f, {-0.7071f, -0.7071f, 0.7071f, 0.7071f}, {0.7071f, -0.7071f, -0.7071f, 0.7071f}},
    {6,
     -0.1667f,
     {0.0f, -0.866f, -0.866f, 0.0f, 0.866f, 0.866f},
     {1.0f, 0.5f, -0.5f, -1.0f, -0.5f, 0.5f}},
    {6,
     -0.1667f,
     {-0.5f, -1.0f, -0.5f, 0.5f, 1.0f, 0.5f},
     {0.866f, 0.0f, -0.866f, -0.866f, 0.0f, 0.866f}},
    {8,
     -0.125f,
     {0.0f, -0.7071f, -1.0f, -0.7071f, 0.0f, 0.7071f, 1.0f, 0.7071f},
     {1.0f, 0.7071f, 0.0f, -0.7071f, -1.0f, -0.7071f, 0.0f, 0.7071f}},
    {8,
     -0.125f,
     {-0.3827f, -0.9239f, -0.9239f, -0.3827f, 0.3827f, 0.9239f, 0.9239f, 0.3827f},
     {0.9239f, 0.3827f, -0.3827f, -0.9239f, -0.9239f, -0.3827f, 0.3827f, 0.9239f}},
    {6,
     -0.1667f,
     {-0.866f, -0.866f, 0.0f, 0.0f, 0.866f, 0.866f},
     {0.5f, 0.5f, -1.0f, -1.0f, 0.5f, 0.5f}},
    {8,
     -0.125f,
     {-0.7071f, -0.7071f, -0.7071f, -0.7071f, 0.7071f, 0.7071f, 0.7071f, 0.7071f},
     {0.7071f, 0.7071f, -0.7071f, -0.7071f, -0.7071f, -0.7071f, 0.7071f, 0.7071f}},
}};

}  // namespace

MixerHeader frame_header(MixerId id) {
  MixerHeader header;
  header.rate_hz.fill(kServoRate_hz);
  switch (id) {
    case MixerId::kEscCalibration:
      header.type.fill(OutputType::kMotor);
      break;
    case MixerId::kFixedWing:
    case MixerId::kInvertedVTail:
      header.type[0] = header.type[1] = header.type[2] = OutputType::kServo;
      header.type[4] = OutputType::kMotor;
      break;
    case MixerId::kCustom:
      break;
    default: {
      const Frame& frame = kFrames[static_cast<std::size_t>(id) - 1];
      // Six motors take eight fast channels: boards share a timer among four.
      const std::size_t fast = frame.motors == 6 ? 8 : frame.motors;
      for (std::size_t k = 0; k < frame.motors; ++k) header.type[k] = OutputType::kMotor;
      for (std::size_t k = 0; k < fast; ++k) header.rate_hz[k] = kMotorRate_hz;
    }
  }
  return header;
}

MixerGains frame_gains(MixerId id) {
  MixerGains gains = MixerGains::Zero();
  Eigen::Matrix<float, kAxes, kChannels> M;
  M.setZero();
  switch (id) {
    case MixerId::kEscCalibration:
      M.row(2).setConstant(0.1f);
      return pseudo_inverse(M);
    case MixerId::kFixedWing:
      gains(4, 0) = 1.0f;
      gains(0, 3) = 1.0f;
      gains(1, 4) = 1.0f;
      gains(2, 5) = 1.0f;
      return gains;
    case MixerId::kInvertedVTail:
      gains(4, 0) = 1.0f;
      gains(0, 3) = 1.0f;
      gains(1, 4) = -0.5f;
      gains(2, 4) = 0.5f;
      gains(1, 5) = 0.5f;
      gains(2, 5) = 0.5f;
      return gains;
    case MixerId::kCustom:
      return gains;
    default:
      break;
  }
  const Frame& frame = kFrames[static_cast<std::size_t>(id) - 1];
  for (std::size_t k = 0; k < frame.motors; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    M(2, column) = frame.force_z;
    M(3, column) = frame.torque_x[k];
    M(4, column) = frame.torque_y[k];
    M(5, column) = k % 2 == 0 ? 1.0f : -1.0f;
  }
  return pseudo_inverse(M);
}

/// One-sided Jacobi rotations (M. R. Hestenes, J. SIAM 6(1), 1958): turns pairs of columns of A = M
/// V until all are orthogonal; their lengths are then the singular values, and the inverse is the
/// sum of v_k a_k^T / |a_k|^2. Sums run in one order on every processor.
MixerGains pseudo_inverse(const Eigen::Matrix<float, kAxes, kChannels>& M) {
  using Square = Eigen::Matrix<float, kAxes, kChannels>;
  constexpr int kMaxSweeps = 30;  // six are usual
  constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
  constexpr Eigen::Index n = kChannels;
  const auto product = [](const Square& A, Eigen::Index p, Eigen::Index q) {
    float sum = 0.0f;
    for (Eigen::Index i = 0; i < n; ++i) sum += A(i, p) * A(i, q);
    return sum;
  };
  MixerGains gains = MixerGains::Zero();
  const float largest = M.cwiseAbs().maxCoeff();
  if (!(largest > 0.0f)) return gains;
  Square A = M / largest;
  Square V = Square::Identity();
  bool turned = true;
  for (int sweep = 0; turned && sweep < kMaxSweeps; ++sweep) {
    turned = false;
    for (Eigen::Index p = 0; p < n; ++p) {
      for (Eigen::Index q = p + 1; q < n; ++q) {
        const float pp = product(A, p, p);
        const float qq = product(A, q, q);
        const float pq = product(A, p, q);
        if (!(std::abs(pq) > kEpsilon * std::sqrt(pp * qq))) continue;
        turned = true;
        const float zeta = (qq - pp) / (2.0f * pq);
        const float t =
            (zeta < 0.0f ? -1.0f : 1.0f) / (std::abs(zeta) + std::sqrt(1.0f + zeta * zeta));
        const float c = 1.0f / std::sqrt(1.0f + t * t);
        for (Square* X : {&A, &V}) {
          for (Eigen::Index i = 0; i < n; ++i) {
            const float x = (*X)(i, p);
            const float y = (*X)(i, q);
            (*X)(i, p) = c * (x - t * y);
            (*X)(i, q) = c * (y + t * x);
          }
        }
      }
    }
  }
  float longest_sq = 0.0f;
  for (Eigen::Index k = 0; k < n; ++k) longest_sq = std::max(longest_sq, product(A, k, k));
  constexpr float kMinRatio = 10.0f * kEpsilon;  // of the largest singular value
  constexpr float kNoise = 1e-6f;
  for (Eigen::Index k = 0; k < n; ++k) {
    const float length_sq = product(A, k, k);
    if (!(length_sq > kMinRatio * kMinRatio * longest_sq)) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) gains(i, j) += V(i, k) * (A(j, k) / length_sq);
    }
  }
  for (Eigen::Index j = 0; j < gains.cols(); ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const float found = gains(i, j) / largest;
      gains(i, j) = std::abs(found) < kNoise ? 0.0f : found;
    }
  }
  return gains;
}

}  // namespace rosflight::core
