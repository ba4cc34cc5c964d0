// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/network.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rosflight::core {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
const float kNan = std::nanf("");

// ---- activation

TEST(Activation, TanhFollowsTheCLibraryInDoublePrecision) {
  for (int k = 0; k <= 200'000; ++k) {
    const auto x = static_cast<float>(std::pow(10.0, -6.0 + 8.0 * k / 200'000));
    const double exact = std::tanh(double{x});
    ASSERT_NEAR(double{tanh(x)}, exact, 3e-7 * exact) << x;
    ASSERT_EQ(tanh(-x), -tanh(x)) << x;
  }
  EXPECT_EQ(tanh(0.0f), 0.0f);
  EXPECT_EQ(tanh(kInf), 1.0f);
  EXPECT_EQ(tanh(-kInf), -1.0f);
  EXPECT_TRUE(std::isnan(tanh(kNan)));
}

TEST(Activation, SigmoidFollowsTheCLibraryInDoublePrecision) {
  for (int k = -50'000; k <= 50'000; ++k) {
    const float x = 1e-3f * static_cast<float>(k);
    ASSERT_NEAR(double{sigmoid(x)}, 1.0 / (1.0 + std::exp(-double{x})), 1.5e-7) << x;
  }
  EXPECT_EQ(sigmoid(0.0f), 0.5f);
  EXPECT_EQ(sigmoid(kInf), 1.0f);
  EXPECT_EQ(sigmoid(-kInf), 0.0f);
  EXPECT_TRUE(std::isnan(sigmoid(kNan)));
}

TEST(Activation, ClipLimitsAndKeepsANan) {
  std::array<float, 7> values{-kInf, -1.5f, -1.0f, 0.25f, 1.0f, 3e38f, kNan};
  activate<Activation::kClip>(values.data(), values.size());
  const std::array<float, 6> expected{-1.0f, -1.0f, -1.0f, 0.25f, 1.0f, 1.0f};
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_EQ(values[k], expected[k]) << k;
  EXPECT_TRUE(std::isnan(values[6]));
}

// ---- the same in double precision, by the equations, row by row

using Doubles = std::vector<double>;

template <class Values>
Doubles doubles(const Values& values) {
  return {values.begin(), values.end()};
}

/// b + G x for `count` rows from `first` of a matrix with `rows` rows, stored by columns.
template <class Gains>
Doubles product(const Gains& gains, std::size_t rows, std::size_t first, std::size_t count,
                const Doubles& x, const Doubles& b) {
  Doubles y(count);
  for (std::size_t row = 0; row < count; ++row) {
    y[row] = b[first + row];
    for (std::size_t k = 0; k < x.size(); ++k) {
      y[row] += double{gains[k * rows + first + row]} * x[k];
    }
  }
  return y;
}

double sigmoid_of(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

template <std::size_t kIn, std::size_t kUnits, bool kResetAfter>
Doubles gru(const typename Gru<kIn, kUnits, kResetAfter>::Table& t, const Doubles& h,
            const Doubles& x) {
  const Doubles bias = doubles(t.bias);
  const Doubles none(2 * kUnits, 0.0);
  const Doubles by_x = product(t.input_gains, 3 * kUnits, 0, 3 * kUnits, x, bias);
  const Doubles by_h = product(t.gate_gains, 2 * kUnits, 0, 2 * kUnits, h, none);
  Doubles z(kUnits);
  Doubles r(kUnits);
  Doubles kept(kUnits);
  for (std::size_t k = 0; k < kUnits; ++k) {
    z[k] = sigmoid_of(by_x[k] + by_h[k]);
    r[k] = sigmoid_of(by_x[kUnits + k] + by_h[kUnits + k]);
    kept[k] = kResetAfter ? h[k] : r[k] * h[k];
  }
  const Doubles c = product(t.candidate_gains, kUnits, 0, kUnits, kept, doubles(t.candidate_bias));
  Doubles next(kUnits);
  for (std::size_t k = 0; k < kUnits; ++k) {
    const double n = std::tanh(by_x[2 * kUnits + k] + (kResetAfter ? r[k] * c[k] : c[k]));
    next[k] = (1.0 - z[k]) * n + z[k] * h[k];
  }
  return next;
}

class Draw {
 public:
  template <std::size_t kSize>
  void fill(std::array<float, kSize>& values, float spread) {
    for (float& value : values) value = spread * normal_(engine_);
  }
  template <std::size_t kIn, std::size_t kUnits, bool kResetAfter>
  typename Gru<kIn, kUnits, kResetAfter>::Table gru_table() {
    typename Gru<kIn, kUnits, kResetAfter>::Table table{};
    fill(table.input_gains, 0.5f);
    fill(table.gate_gains, 0.5f);
    fill(table.candidate_gains, 0.5f);
    fill(table.bias, 0.5f);
    if (kResetAfter) fill(table.candidate_bias, 0.5f);
    return table;
  }

 private:
  std::mt19937 engine_{1};
  std::normal_distribution<float> normal_;
};

// ---- fully connected layers

TEST(Dense, ColumnsOfTheTableBelongToInputs) {
  using Layer = Dense<2, 3, Activation::kNone>;
  static constexpr Layer::Table kTable{{{1, 2, 3, 10, 20, 30}}, {{100, 200, 300}}};
  const auto y = Layer::step(kTable, nullptr, {4.0f, 5.0f});
  EXPECT_EQ(y, (std::array<float, 3>{154.0f, 308.0f, 462.0f}));
}

TEST(Dense, ReluCutsWhatIsNegative) {
  using Layer = Dense<1, 3, Activation::kRelu>;
  static constexpr Layer::Table kTable{{{1, -1, 0}}, {{0, 0, -1}}};
  EXPECT_EQ(Layer::step(kTable, nullptr, {2.0f}), (std::array<float, 3>{2.0f, 0.0f, 0.0f}));
}

template <std::size_t kIn, std::size_t kOut>
void compare_dense() {
  using Layer = Dense<kIn, kOut, Activation::kTanh>;
  Draw draw;
  typename Layer::Table table{};
  draw.fill(table.gains, 1.0f / std::sqrt(static_cast<float>(kIn)));
  draw.fill(table.bias, 0.1f);
  for (int k = 0; k < 100; ++k) {
    std::array<float, kIn> x{};
    draw.fill(x, 1.0f);
    const auto y = Layer::step(table, nullptr, x);
    const Doubles exact = product(table.gains, kOut, 0, kOut, doubles(x), doubles(table.bias));
    for (std::size_t row = 0; row < kOut; ++row) {
      // Rounding of kIn products whose sum is about 1.
      ASSERT_NEAR(double{y[row]}, std::tanh(exact[row]), 2e-6) << row;
    }
  }
}

TEST(Dense, FollowsDoublePrecisionInAnySize) {
  compare_dense<1, 1>();
  compare_dense<3, 15>();
  compare_dense<14, 16>();
  compare_dense<5, 17>();
  compare_dense<64, 64>();
  compare_dense<64, 3>();
}

// ---- recurrent layers

/// Constant gates: h after k steps is n (1 - z^k).
TEST(Gru, WithoutGainsApproachesItsCandidateGeometrically) {
  using Layer = Gru<1, 1, true>;
  Layer::Table table{};
  table.bias = {std::log(3.0f), 0.0f, 0.5f};  // z = 3/4
  std::array<float, Layer::kStates> h{};
  for (int k = 1; k <= 40; ++k) {
    const auto y = Layer::step(table, h.data(), {7.0f});
    ASSERT_NEAR(double{y[0]}, std::tanh(0.5) * (1.0 - std::pow(0.75, k)), 1e-6) << k;
  }
}

template <bool kResetAfter>
void compare_gru() {
  constexpr std::size_t kIn = 7;
  constexpr std::size_t kUnits = 19;
  Draw draw;
  const auto table = draw.gru_table<kIn, kUnits, kResetAfter>();
  std::array<float, kUnits> h{};
  Doubles exact(kUnits, 0.0);
  for (int k = 0; k < 200; ++k) {
    std::array<float, kIn> x{};
    draw.fill(x, 1.0f);
    const auto y = Gru<kIn, kUnits, kResetAfter>::step(table, h.data(), x);
    // From the layer's own state, so that roundings of earlier steps do not add up.
    exact = gru<kIn, kUnits, kResetAfter>(table, exact, doubles(x));
    for (std::size_t row = 0; row < kUnits; ++row) {
      ASSERT_NEAR(double{y[row]}, exact[row], 2e-6) << k;
    }
    exact = doubles(y);
  }
}

TEST(Gru, FollowsDoublePrecisionWithTheResetBeforeTheProduct) {
  compare_gru<false>();
}

TEST(Gru, FollowsDoublePrecisionWithTheResetAfterTheProduct) {
  compare_gru<true>();
}

// ---- networks

using Small = Network<Dense<6, 16, Activation::kRelu>, Gru<16, 8, true>, Gru<8, 8, false>,
                      Dense<8, 3, Activation::kTanh>>;

Small::Table small_table() {
  Draw draw;
  Small::Table table{};
  draw.fill(std::get<0>(table).gains, 0.5f);
  draw.fill(std::get<0>(table).bias, 0.5f);
  std::get<1>(table) = draw.gru_table<16, 8, true>();
  std::get<2>(table) = draw.gru_table<8, 8, false>();
  draw.fill(std::get<3>(table).gains, 0.5f);
  return table;
}

TEST(Network, StepsFromTheStatesOfItsCaller) {
  const Small::Table table = small_table();
  std::array<float, Small::kStates> states{};
  const Small::Inputs x{1, -2, 3, -4, 5, -6};
  const auto first = Small::step(table, states.data(), x);
  EXPECT_NE(Small::step(table, states.data(), x), first) << "the states have moved";
  states.fill(0.0f);
  EXPECT_EQ(Small::step(table, states.data(), x), first);
}

TEST(Network, OutputsAreFiniteForAnyFiniteInput) {
  const Small::Table table = small_table();
  std::array<float, Small::kStates> states{};
  Draw draw;
  for (int k = 0; k < 5000; ++k) {
    Small::Inputs x{};
    draw.fill(x, std::pow(10.0f, static_cast<float>(k % 60 - 30)));
    for (const float y : Small::step(table, states.data(), x)) ASSERT_LE(std::abs(y), 1.0f) << k;
  }
}

TEST(Network, NanReachesTheOutputs) {
  const Small::Table table = small_table();
  for (std::size_t k = 0; k < Small::kInputs; ++k) {
    std::array<float, Small::kStates> states{};
    Small::Inputs x{};
    x[k] = kNan;
    for (const float y : Small::step(table, states.data(), x)) EXPECT_TRUE(std::isnan(y)) << k;
  }
}

TEST(Network, ATableIsAsLargeAsItsNumbers) {
  constexpr std::size_t kDense = 6 * 16 + 16 + 8 * 3 + 3;
  constexpr std::size_t kRecurrent = 3 * 8 * (16 + 8) + 4 * 8 + 3 * 8 * (8 + 8) + 4 * 8;
  EXPECT_EQ(sizeof(Small::Table), sizeof(float) * (kDense + kRecurrent));
  EXPECT_EQ(Small::kStates, 8u + 8u);
}

}  // namespace
}  // namespace rosflight::core
