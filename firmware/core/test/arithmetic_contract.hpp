// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

#include "base/crc32.hpp"
#include "firmware/core/math.hpp"
#include "firmware/core/policy/fixed_policy.hpp"

/// The same bits on every processor: include it in a test of each that the firmware runs on.
namespace rosflight::core {

/// Checksum over the bits of results. Arguments come from a generator of integers (Numerical Recipes 3rd ed., sec. 7.1).
class ArithmeticSelfTest {
 public:
  std::uint32_t run() {
    for (int k = 0; k < 2000; ++k) {
      add_elementary();
      add_algebra();
      add_rounding();
    }
    return crc_.value();
  }

 private:
  /// -1 to 1.
  float next() {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<float>(state_ >> 8u) * 0x1p-23f - 1.0f;
  }
  template <class Number>
  void add(Number number) {
    std::uint8_t bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    crc_.add(bytes, sizeof bytes);
  }
  void add_elementary() {
    const float x = next(), y = next();
    add(atan2(y, x));
    add(asin(x));
    add(pow(1.0f + x * 0.9f, 4.0f * y));
    const SinCos turned = sin_cos(1000.0f * x);
    add(turned.sin);
    add(turned.cos);
    add(std::sqrt(std::abs(x)));
  }
  /// Products and sums whose order and fusing would show.
  void add_algebra() {
    const Quaternion first{next(), next(), next(), next()};
    const Quaternion second{next(), next(), next(), next()};
    const Quaternion q = first * second;
    add(q.w), add(q.x), add(q.y), add(q.z);
    Matrix3 a;
    for (int row = 0; row < 3; ++row) a.row(row) << next(), next(), next();
    const Vector3 v{next(), next(), next()};
    const Vector3 solved = a.partialPivLu().solve(v);
    const Matrix3 product = a * a.transpose();
    for (int k = 0; k < 3; ++k) add(solved[k]), add(product(k, 2 - k));
    add(v.normalized().dot(a.col(1)));
  }
  /// Denormal numbers, conversions, double precision.
  void add_rounding() {
    const float x = next();
    add(x * 0x1p-130f);
    add(static_cast<std::int32_t>(x * 2e9f));
    add(static_cast<float>(static_cast<double>(x) / 3.0));
    add(static_cast<double>(x) * 1e-7 + 1.0);
  }

  base::Crc32 crc_;
  std::uint32_t state_{1};
};

/// Outputs of networks of all kinds of layers, for random numbers and random inputs.
class InferenceSelfTest {
 public:
  std::uint32_t run() {
    using Recurrent = Network<Dense<12, 20, Activation::kRelu>, Gru<20, 12, true>,
                              Gru<12, 9, false>, Dense<9, 3, Activation::kSigmoid>>;
    Recurrent::Table table{};
    std::apply([this](auto&... layers) { (fill(layers), ...); }, table);
    std::array<float, Recurrent::kStates> states{};
    Policy::States none{};
    for (int k = 0; k < 100; ++k) {
      Policy::Inputs x{};
      for (float& value : x) value = draw_(1.5f);
      for (const float y : fixed_policy::step(none, x)) add(y);
      Recurrent::Inputs first{};
      std::copy_n(x.begin(), first.size(), first.begin());
      for (const float y : Recurrent::step(table, states.data(), first)) add(y);
    }
    return crc_.value();
  }

 private:
  template <class... Numbers>
  void fill_all(Numbers&... arrays) {
    const auto fill_one = [this](auto& numbers) {
      for (float& number : numbers) number = draw_(0.7f);
    };
    (fill_one(arrays), ...);
  }
  template <class Layer>
  void fill(Layer& layer) {
    if constexpr (has_gates<Layer>(0)) {
      fill_all(layer.input_gains, layer.gate_gains, layer.candidate_gains, layer.bias,
               layer.candidate_bias);
    } else {
      fill_all(layer.gains, layer.bias);
    }
  }
  template <class Layer>
  static constexpr auto has_gates(int) -> decltype(Layer::gate_gains, bool{}) {
    return true;
  }
  template <class Layer>
  static constexpr bool has_gates(long) {
    return false;
  }
  void add(float number) {
    std::uint8_t bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    crc_.add(bytes, sizeof bytes);
  }

  base::Crc32 crc_;
  fixed_policy::Draw draw_;
};

/// As computed on an x86-64.
inline constexpr std::uint32_t kArithmeticChecksum = 0xD717'AE86u;
inline constexpr std::uint32_t kInferenceChecksum = 0xEC00'AFCAu;

TEST(Arithmetic, GivesTheSameBitsOnEveryProcessor) {
  EXPECT_EQ(ArithmeticSelfTest{}.run(), kArithmeticChecksum);
}

TEST(Arithmetic, OfInferencesGivesTheSameBitsOnEveryProcessor) {
  EXPECT_EQ(InferenceSelfTest{}.run(), kInferenceChecksum);
}

}  // namespace rosflight::core
