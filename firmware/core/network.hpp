// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "base/eigen.hpp"
#include "firmware/core/activation.hpp"

/// Inference of small neural networks whose layers and sizes the compiler knows. A network is made
/// of layers; each has a Table, its numbers as constants, and kStates numbers that it keeps between
/// two steps, zeros at first. Sums are formed input by input, so every compiler and processor gives the same bits. A
/// NaN at an input of a layer reaches its outputs.
namespace rosflight::core {

enum class Activation : std::uint8_t { kNone, kTanh, kRelu, kSigmoid, kClip };

/// Applies the function to each of n numbers. kClip limits to -1..1.
template <Activation kActivation>
void activate(float* values, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    if constexpr (kActivation == Activation::kTanh) values[k] = tanh(values[k]);
    if constexpr (kActivation == Activation::kSigmoid) values[k] = sigmoid(values[k]);
    if constexpr (kActivation == Activation::kRelu) {
      if (values[k] < 0.0f) values[k] = 0.0f;
    }
    if constexpr (kActivation == Activation::kClip) {
      if (values[k] < -1.0f) values[k] = -1.0f;  // a NaN stays one
      if (values[k] > 1.0f) values[k] = 1.0f;
    }
  }
}

/// kRows sums: y <- y + G x, their gains in columns that are `stride` apart.
template <std::size_t kRows>
void add_rows(const float* gains, std::size_t stride, const float* x, std::size_t inputs,
              float* y) {
  using Sums = Eigen::Array<float, static_cast<int>(kRows), 1>;
  Eigen::Map<Sums> out(y);
  Sums sums = out;
  for (std::size_t k = 0; k < inputs; ++k) {
    sums += Eigen::Map<const Sums>(gains + k * stride) * x[k];
  }
  out = sums;
}

/// y <- y + G x, G column by column. As many sums at a time as fit the registers of a Cortex-M7.
template <std::size_t kRows, std::size_t kColumns>
void add_product(const std::array<float, kRows * kColumns>& gains, const float* x, float* y) {
  constexpr std::size_t kAtATime = 16;
  constexpr std::size_t kLeft = kRows % kAtATime;
  for (std::size_t row = 0; row + kAtATime <= kRows; row += kAtATime) {
    add_rows<kAtATime>(gains.data() + row, kRows, x, kColumns, y + row);
  }
  if constexpr (kLeft > 0) {
    add_rows<kLeft>(gains.data() + kRows - kLeft, kRows, x, kColumns, y + kRows - kLeft);
  }
}

/// A fully connected layer:
///
///     y = f(G x + b)                                                                      (1)
template <std::size_t kIn, std::size_t kOut, Activation kActivation>
struct Dense {
  static constexpr std::size_t kInputs = kIn;
  static constexpr std::size_t kOutputs = kOut;
  static constexpr std::size_t kStates = 0;
  struct Table {
    std::array<float, kOut * kIn> gains;  ///< G by columns.
    std::array<float, kOut> bias;
  };

  static std::array<float, kOut> step(const Table& table, float* /*states*/,
                                      const std::array<float, kIn>& x) {
    std::array<float, kOut> y = table.bias;
    add_product<kOut, kIn>(table.gains, x.data(), y.data());
    activate<kActivation>(y.data(), kOut);
    return y;
  }
};

/// A layer of gated recurrent units, with the gates as ONNX has them (operator GRU):
///
///     z = sigmoid(Wz x + Rz h + bz),   r = sigmoid(Wr x + Rr h + br)                      (2)
///     n = tanh(Wn x + bn + Rn (r h))            reset before the product                  (3)
///     n = tanh(Wn x + bn + r (Rn h + cn))       reset after it: linear_before_reset       (4)
///     h <- (1 - z) n + z h,   y = h                                                       (5)
///
/// K. Cho et al.: Learning Phrase Representations using RNN Encoder-Decoder. arXiv:1406.1078, 2014.
template <std::size_t kIn, std::size_t kUnits, bool kResetAfter>
struct Gru {
  static constexpr std::size_t kInputs = kIn;
  static constexpr std::size_t kOutputs = kUnits;
  static constexpr std::size_t kStates = kUnits;
  struct Table {
    std::array<float, 3 * kUnits * kIn> input_gains;  ///< Wz, Wr, Wn above each other, by columns.
    std::array<float, 2 * kUnits * kUnits> gate_gains;   ///< Rz, Rr.
    std::array<float, kUnits * kUnits> candidate_gains;  ///< Rn.
    std::array<float, 3 * kUnits> bias;                  ///< bz, br, bn.
    std::array<float, kUnits> candidate_bias;            ///< cn; zeros for (3).
  };

  /// @param h  the states.
  static std::array<float, kUnits> step(const Table& table, float* h,
                                        const std::array<float, kIn>& x) {
    std::array<float, 3 * kUnits> gates = table.bias;
    float* const z = gates.data();
    float* const r = z + kUnits;
    float* const n = r + kUnits;
    add_product<3 * kUnits, kIn>(table.input_gains, x.data(), gates.data());
    add_product<2 * kUnits, kUnits>(table.gate_gains, h, z);
    activate<Activation::kSigmoid>(z, 2 * kUnits);
    if constexpr (kResetAfter) {
      std::array<float, kUnits> c = table.candidate_bias;
      add_product<kUnits, kUnits>(table.candidate_gains, h, c.data());
      for (std::size_t k = 0; k < kUnits; ++k) n[k] += r[k] * c[k];
    } else {
      for (std::size_t k = 0; k < kUnits; ++k) r[k] *= h[k];
      add_product<kUnits, kUnits>(table.candidate_gains, r, n);
    }
    activate<Activation::kTanh>(n, kUnits);
    for (std::size_t k = 0; k < kUnits; ++k) h[k] = (1.0f - z[k]) * n[k] + z[k] * h[k];
    std::array<float, kUnits> y{};
    std::copy_n(h, kUnits, y.begin());
    return y;
  }
};

/// Layers in a row: the outputs of one are the inputs of the next. The caller keeps the states.
template <class... Layers>
class Network {
 public:
  using Table = std::tuple<typename Layers::Table...>;
  template <std::size_t kIndex>
  using Layer = std::tuple_element_t<kIndex, std::tuple<Layers...>>;
  static constexpr std::size_t kInputs = Layer<0>::kInputs;
  static constexpr std::size_t kOutputs = Layer<sizeof...(Layers) - 1>::kOutputs;
  static constexpr std::size_t kStates = (Layers::kStates + ...);
  using Inputs = std::array<float, kInputs>;
  using Outputs = std::array<float, kOutputs>;

  /// One inference.
  /// @param states  kStates numbers, changed by this; zeros before the first step.
  static Outputs step(const Table& table, float* states, const Inputs& x) {
    return run<0>(table, states, x);
  }

 private:
  template <std::size_t kIndex>
  static Outputs run(const Table& table, float* states,
                     const std::array<float, Layer<kIndex>::kInputs>& x) {
    const auto y = Layer<kIndex>::step(std::get<kIndex>(table), states, x);
    if constexpr (kIndex + 1 == sizeof...(Layers)) {
      return y;
    } else {
      static_assert(Layer<kIndex>::kOutputs == Layer<kIndex + 1>::kInputs);
      return run<kIndex + 1>(table, states + Layer<kIndex>::kStates, y);
    }
  }
};

}  // namespace rosflight::core
