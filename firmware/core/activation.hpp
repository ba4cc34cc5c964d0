// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Activation functions of networks, from +, -, *, / alone: the same bits on every processor, as in
/// elementary.hpp. A NaN gives a NaN.
namespace rosflight::core {

/// Hyperbolic tangent; relative error at most 3e-7.
float tanh(float x);

/// 1/(1 + e^-x); absolute error at most 1.5e-7.
float sigmoid(float x);

}  // namespace rosflight::core
