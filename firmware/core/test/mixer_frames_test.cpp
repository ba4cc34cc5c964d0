// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace rosflight::core {
namespace {

/// Gains of one input on the first channels; the rest is zero.
using Gains = std::map<int, std::vector<float>>;  // input: 0 F_x, 2 F_z, 3 Q_x, 4 Q_y, 5 Q_z
constexpr int kFx = 0, kFz = 2, kQx = 3, kQy = 4, kQz = 5;

struct Table {
  MixerId id;
  std::string types;  ///< One letter per channel: A auxiliary, S servo, M motor.
  std::vector<float> rates_hz;
  Gains gains;
};

std::vector<float> rates(std::size_t fast) {
  std::vector<float> r(10, 50.0f);
  std::fill_n(r.begin(), fast, 490.0f);
  return r;
}

/// The tables of ROSflight 2.0.1, gains as its PRI_MIXER parameters show them after selection.
const std::vector<Table>& tables() {
  static const std::vector<Table> all{
      {MixerId::kEscCalibration, "MMMMMMMMMM", rates(0), {{kFz, std::vector<float>(10, 1.0f)}}},
      {MixerId::kQuadPlus,
       "MMMMAAAAAA",
       rates(4),
       {{kFz, {-1, -1, -1, -1}},
        {kQx, {0, -0.5f, 0, 0.5f}},
        {kQy, {0.5f, 0, -0.5f, 0}},
        {kQz, {0.25f, -0.25f, 0.25f, -0.25f}}}},
      {MixerId::kQuadX,
       "MMMMAAAAAA",
       rates(4),
       {{kFz, {-1, -1, -1, -1}},
        {kQx, {-0.353557f, -0.353557f, 0.353557f, 0.353557f}},
        {kQy, {0.353557f, -0.353557f, -0.353557f, 0.353557f}},
        {kQz, {0.25f, -0.25f, 0.25f, -0.25f}}}},
      {MixerId::kHexPlus,
       "MMMMMMAAAA",
       rates(8),
       {{kFz, std::vector<float>(6, -0.9998f)},
        {kQx, {0, -0.288684f, -0.288684f, 0, 0.288684f, 0.288684f}},
        {kQy, {0.333333f, 0.166667f, -0.166667f, -0.333333f, -0.166667f, 0.166667f}},
        {kQz, {0.166667f, -0.166667f, 0.166667f, -0.166667f, 0.166667f, -0.166667f}}}},
      {MixerId::kHexX,
       "MMMMMMAAAA",
       rates(8),
       {{kFz, std::vector<float>(6, -0.9998f)},
        {kQx, {-0.166667f, -0.333333f, -0.166667f, 0.166667f, 0.333333f, 0.166667f}},
        {kQy, {0.288684f, 0, -0.288684f, -0.288684f, 0, 0.288684f}},
        {kQz, {0.166667f, -0.166667f, 0.166667f, -0.166667f, 0.166667f, -0.166667f}}}},
      {MixerId::kOctoPlus,
       "MMMMMMMMAA",
       rates(8),
       {{kFz, std::vector<float>(8, -1.0f)},
        {kQx, {0, -0.176777f, -0.250002f, -0.176777f, 0, 0.176777f, 0.250002f, 0.176777f}},
        {kQy, {0.250002f, 0.176777f, 0, -0.176777f, -0.250002f, -0.176777f, 0, 0.176777f}},
        {kQz, {0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f}}}},
      {MixerId::kOctoX,
       "MMMMMMMMAA",
       rates(8),
       {{kFz, std::vector<float>(8, -1.0f)},
        {kQx,
         {-0.09567f, -0.230963f, -0.230963f, -0.09567f, 0.09567f, 0.230963f, 0.230963f, 0.09567f}},
        {kQy,
         {0.230963f, 0.09567f, -0.09567f, -0.230963f, -0.230963f, -0.09567f, 0.09567f, 0.230963f}},
        {kQz, {0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f}}}},
      {MixerId::kY6,
       "MMMMMMAAAA",
       rates(8),
       {{kFz, std::vector<float>(6, -0.9998f)},
        {kQx, {-0.288684f, -0.288684f, 0, 0, 0.288684f, 0.288684f}},
        {kQy, {0.166667f, 0.166667f, -0.333333f, -0.333333f, 0.166667f, 0.166667f}},
        {kQz, {0.166667f, -0.166667f, 0.166667f, -0.166667f, 0.166667f, -0.166667f}}}},
      {MixerId::kX8,
       "MMMMMMMMAA",
       rates(8),
       {{kFz, std::vector<float>(8, -1.0f)},
        {kQx,
         {-0.176778f, -0.176778f, -0.176778f, -0.176778f, 0.176778f, 0.176778f, 0.176778f,
          0.176778f}},
        {kQy,
         {0.176778f, 0.176778f, -0.176778f, -0.176778f, -0.176778f, -0.176778f, 0.176778f,
          0.176778f}},
        {kQz, {0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f, 0.125f, -0.125f}}}},
      {MixerId::kFixedWing,
       "SSSAMAAAAA",
       rates(0),
       {{kFx, {0, 0, 0, 0, 1}}, {kQx, {1}}, {kQy, {0, 1}}, {kQz, {0, 0, 1}}}},
      {MixerId::kInvertedVTail,
       "SSSAMAAAAA",
       rates(0),
       {{kFx, {0, 0, 0, 0, 1}}, {kQx, {1}}, {kQy, {0, -0.5f, 0.5f}}, {kQz, {0, 0.5f, 0.5f}}}}};
  return all;
}

TEST(MixerFrames, AreAllThere) {
  EXPECT_EQ(tables().size(), 11u);
  for (std::size_t k = 0; k < tables().size(); ++k) {
    EXPECT_EQ(static_cast<std::size_t>(tables()[k].id), k);
    EXPECT_TRUE(is_predefined(static_cast<std::int32_t>(k)));
  }
  for (const std::int32_t id : {-1, 11, 12, 255}) EXPECT_FALSE(is_predefined(id));
}

TEST(MixerFrames, HeadersAreThoseOfTheReference) {
  const std::map<char, OutputType> letters{
      {'A', OutputType::kAux}, {'S', OutputType::kServo}, {'M', OutputType::kMotor}};
  for (const Table& table : tables()) {
    SCOPED_TRACE(static_cast<int>(table.id));
    const MixerHeader header = frame_header(table.id);
    for (std::size_t k = 0; k < kChannels; ++k) {
      EXPECT_EQ(header.type[k], letters.at(table.types[k])) << "channel " << k;
      EXPECT_EQ(header.rate_hz[k], table.rates_hz[k]) << "channel " << k;
    }
  }
}

TEST(MixerFrames, GainsAreThoseOfTheReferenceAndElseZero) {
  for (const Table& table : tables()) {
    const MixerGains gains = frame_gains(table.id);
    for (Eigen::Index input = 0; input < gains.cols(); ++input) {
      const auto row = table.gains.find(static_cast<int>(input));
      for (Eigen::Index channel = 0; channel < gains.rows(); ++channel) {
        const auto k = static_cast<std::size_t>(channel);
        const bool listed = row != table.gains.end() && k < row->second.size();
        const float expected = listed ? row->second[k] : 0.0f;
        // Six digits are published; singular values in float add noise of some 1e-6, as in the
        // reference.
        EXPECT_NEAR(gains(channel, input), expected, 2e-6f)
            << "mixer " << static_cast<int>(table.id) << " input " << input << " channel "
            << channel;
      }
    }
  }
}

TEST(MixerFrames, UnusedInputsAndChannelsAreExactlyZero) {
  for (const Table& table : tables()) {
    const MixerGains gains = frame_gains(table.id);
    for (Eigen::Index channel = 0; channel < gains.rows(); ++channel) {
      const bool used = channel < 10 && table.types[static_cast<std::size_t>(channel)] != 'A';
      if (!used) {
        EXPECT_TRUE(gains.row(channel).isZero(0.0f)) << static_cast<int>(table.id) << channel;
      }
    }
    for (const Eigen::Index input : {1, 6, 7, 8, 9}) EXPECT_TRUE(gains.col(input).isZero(0.0f));
  }
}

TEST(MixerFrames, FollowTheGeometryOfTheirArms) {
  // The rule behind the tables (ROSflight 2.0 paper, appendix): a motor at angle theta adds
  // [-1/n, -sin theta, cos theta, d] to [F_z, Q_x, Q_y, Q_z]; gains are its least-norm inverse.
  // Here computed in double, in closed form, from angles alone: M M^T is diagonal for these frames.
  struct Frame {
    MixerId id;
    std::vector<double> angle_deg;
  };
  const std::vector<Frame> frames{
      {MixerId::kQuadPlus, {0, 90, 180, 270}},
      {MixerId::kQuadX, {45, 135, 225, 315}},
      {MixerId::kHexPlus, {0, 60, 120, 180, 240, 300}},
      {MixerId::kHexX, {30, 90, 150, 210, 270, 330}},
      {MixerId::kOctoPlus, {0, 45, 90, 135, 180, 225, 270, 315}},
      {MixerId::kOctoX, {22.5, 67.5, 112.5, 157.5, 202.5, 247.5, 292.5, 337.5}},
      {MixerId::kY6, {60, 60, 180, 180, 300, 300}},
      {MixerId::kX8, {45, 45, 135, 135, 225, 225, 315, 315}}};
  for (const Frame& frame : frames) {
    const MixerGains gains = frame_gains(frame.id);
    const auto n = static_cast<double>(frame.angle_deg.size());
    for (std::size_t k = 0; k < frame.angle_deg.size(); ++k) {
      const double theta = frame.angle_deg[k] * 3.14159265358979 / 180;
      const double d = k % 2 == 0 ? 1 : -1;
      const auto row = static_cast<Eigen::Index>(k);
      SCOPED_TRACE(static_cast<int>(frame.id) * 100 + static_cast<int>(k));
      // The tables have four decimals: 1e-4 of relative error, 2e-4 with 1/6 = 0.1667.
      EXPECT_NEAR(double{gains(row, 2)}, -1.0, 3e-4);
      EXPECT_NEAR(double{gains(row, 3)}, -std::sin(theta) * 2 / n, 1e-4);
      EXPECT_NEAR(double{gains(row, 4)}, std::cos(theta) * 2 / n, 1e-4);
      EXPECT_NEAR(double{gains(row, 5)}, d / n, 1e-4);
    }
  }
}

using Square = Eigen::Matrix<float, kAxes, kChannels>;

/// The four equations that define the Moore-Penrose inverse, R. Penrose 1955.
void expect_pseudo_inverse(const Square& M, const MixerGains& padded, float tolerance) {
  const Eigen::Matrix<float, kChannels, kAxes> P = padded.topRows<kChannels>();
  const float scale = M.norm() * P.norm() + 1.0f;
  EXPECT_LT((M * P * M - M).norm(), tolerance * scale * M.norm());
  EXPECT_LT((P * M * P - P).norm(), tolerance * scale * P.norm());
  EXPECT_LT((M * P - (M * P).transpose()).norm(), tolerance * scale);
  EXPECT_LT((P * M - (P * M).transpose()).norm(), tolerance * scale);
}

TEST(PseudoInverse, KeepsPenrosesEquations) {
  std::uint32_t state = 12345;
  const auto random = [&] {  // any spread of numbers will do
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 8388608.0f - 1.0f;
  };
  for (int trial = 0; trial < 20; ++trial) {
    Square M = Square::Zero();
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = 0; j < 8; ++j) M(i, j) = random();
    }
    if (trial % 2 == 1) M.row(4) = M.row(3) - 2.0f * M.row(2);  // deficient in rank
    expect_pseudo_inverse(M, pseudo_inverse(M), 1e-5f);
  }
}

TEST(PseudoInverse, OfNothingIsNothing) {
  EXPECT_TRUE(pseudo_inverse(Square::Zero()).isZero(0.0f));
}

TEST(PseudoInverse, OfASquareMatrixIsTheInverse) {
  Square M = Square::Identity() * 4.0f;
  M(0, 1) = 1.0f;
  const MixerGains P = pseudo_inverse(M);
  EXPECT_TRUE((P.topRows<kChannels>() * M).isApprox(Square::Identity(), 1e-5f));
}

TEST(PseudoInverse, ClearsNoise) {
  Square M = Square::Zero();
  M(0, 0) = 2e6f;  // inverse 5e-7: below what counts
  M(1, 1) = 2.0e5f;
  const MixerGains P = pseudo_inverse(M);
  EXPECT_EQ(P(0, 0), 0.0f);
  EXPECT_NEAR(P(1, 1), 5e-6f, 1e-10f);
}

TEST(PseudoInverse, GivesTheQuadrotorOfTheShippedFiles) {
  // Squared speeds from newtons and newton metres, |r_x| = |r_y| = 0.2298 m: 1/(4 k_T), 1/(4 k_T l)
  // and 1/(4 k_Q) in the two parameter files that ROSflight 2.0 ships.
  struct Case {
    double k_thrust, k_torque, force, tilt, yaw;
  };
  for (const Case& c : {Case{4.299379e-5, 9.360986e-7, 5814.7935, 25303.7142, 267065.8876},
                        Case{4.903854e-5, 1.121021e-6, 5098.0312, 22184.6441, 223010.9894}}) {
    const double x[4] = {0.2298, -0.2298, -0.2298, 0.2298};
    const double y[4] = {0.2298, 0.2298, -0.2298, -0.2298};
    const double d[4] = {-1, 1, -1, 1};
    Square M = Square::Zero();
    for (Eigen::Index k = 0; k < 4; ++k) {
      M(2, k) = static_cast<float>(-c.k_thrust);
      M(3, k) = static_cast<float>(-c.k_thrust * y[k]);
      M(4, k) = static_cast<float>(c.k_thrust * x[k]);
      M(5, k) = static_cast<float>(-c.k_torque * d[k]);
    }
    const MixerGains P = pseudo_inverse(M);
    for (Eigen::Index k = 0; k < 4; ++k) {
      // Yaw being 46 times weaker than thrust, float singular values cost 46 epsilon = 6e-6.
      const auto near = [](float value, double expected) {
        EXPECT_NEAR(double{value}, expected, std::abs(expected) * 1e-5);
      };
      near(P(k, 2), -c.force);
      near(P(k, 3), y[k] > 0 ? -c.tilt : c.tilt);
      near(P(k, 4), x[k] > 0 ? c.tilt : -c.tilt);
      near(P(k, 5), d[k] < 0 ? c.yaw : -c.yaw);
    }
  }
}

}  // namespace
}  // namespace rosflight::core
