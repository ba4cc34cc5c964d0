// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer_frames.hpp"

#include <Eigen/SVD>
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
  Eigen::Matrix<float, kEntries, kChannels> M;
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

MixerGains pseudo_inverse(const Eigen::Matrix<float, kEntries, kChannels>& M) {
  using Square = Eigen::Matrix<float, kEntries, kChannels>;
  const Eigen::JacobiSVD<Square, Eigen::FullPivHouseholderQRPreconditioner> svd(
      M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto& sigma = svd.singularValues();
  const float smallest = 10.0f * std::numeric_limits<float>::epsilon() * sigma(0);
  Eigen::Matrix<float, kEntries, 1> inverse = Eigen::Matrix<float, kEntries, 1>::Zero();
  for (Eigen::Index k = 0; k < sigma.size(); ++k) {
    if (sigma(k) > smallest) inverse(k) = 1.0f / sigma(k);
  }
  const Square found = svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
  constexpr float kNoise = 1e-6f;
  MixerGains gains = MixerGains::Zero();
  gains.topRows<kChannels>() = (found.array().abs() < kNoise).select(0.0f, found);
  return gains;
}

}  // namespace rosflight::core
