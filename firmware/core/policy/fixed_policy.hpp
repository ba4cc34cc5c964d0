// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/network.hpp"
#include "firmware/core/policy.hpp"

/// A policy of body rates for tests and measurements, without an ONNX file: two layers of 64 (tanh) whose numbers are
/// computed by the compiler, the same for every processor. Nobody builds it into an image that is meant to fly.
namespace rosflight::core::fixed_policy {

using Layers = Network<Dense<Policy::kRateInputs, 64, Activation::kTanh>,
                       Dense<64, 64, Activation::kTanh>, Dense<64, 3, Activation::kClip>>;

/// Draws from -size to size. Numerical Recipes 3rd ed., sec. 7.1.
class Draw {
 public:
  constexpr float operator()(float size) {
    state_ = state_ * 1664525u + 1013904223u;
    return size * (static_cast<float>(state_ >> 8u) * 0x1p-23f - 1.0f);
  }

 private:
  std::uint32_t state_{1};
};

/// Random numbers everywhere, and in the first three units of each layer a law of attitude control that they hardly change:
///
///     w_c = 7 s^-1 (roll_c - d_y, pitch_c + d_x, yaw_rate_c)                              (1)
///
/// with d the direction of gravity and the yaw rate as it is, over the default limits of the rates.
constexpr Layers::Table make_table() {
  constexpr float kScale = 0.3f;  // keeps these units where tanh is almost a straight line
  constexpr float kDisturbance = 1e-3f;
  constexpr std::array<float, 3> kGain{7.0f / 3.14159f, 7.0f / 3.14159f, 1.0f / 1.507f};
  constexpr std::size_t kUnits = 64;
  Draw draw;
  Layers::Table table{};
  auto& first = std::get<0>(table);
  auto& second = std::get<1>(table);
  auto& last = std::get<2>(table);
  for (float& gain : first.gains) gain = draw(0.5f);
  for (float& bias : first.bias) bias = draw(0.2f);
  for (float& gain : second.gains) gain = draw(0.2f);
  for (float& bias : second.bias) bias = draw(0.2f);
  for (float& gain : last.gains) gain = draw(kDisturbance);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t input = 0; input < Policy::kRateInputs; ++input) {
      first.gains[input * kUnits + k] = 0.0f;
    }
    first.gains[(6 + k) * kUnits + k] = kScale;
    first.bias[k] = second.bias[k] = 0.0f;
    for (std::size_t unit = 0; unit < kUnits; ++unit) {
      second.gains[unit * kUnits + k] *= 5.0f * kDisturbance;
    }
    second.gains[k * kUnits + k] = 1.0f;
    last.gains[k * 3 + k] = kGain[k] / kScale;
    for (std::size_t other = 0; other < 3; ++other) {
      if (other != k) last.gains[k * 3 + other] = 0.0f;
    }
  }
  first.gains[1 * kUnits + 0] = -kScale;
  first.gains[0 * kUnits + 1] = kScale;
  return table;
}

inline constexpr Layers::Table kTable = make_table();

inline Policy::Outputs step(Policy::States& states, const Policy::Inputs& inputs) {
  Layers::Inputs x{};
  std::copy_n(inputs.begin(), x.size(), x.begin());
  const Layers::Outputs y = Layers::step(kTable, states.data(), x);
  return {y[0], y[1], y[2]};
}

}  // namespace rosflight::core::fixed_policy
