// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::core {

/// A network that commands body rates or motors. Its numbers are constants of the program, made from an ONNX file
/// at build time by policy/generate.py.
///
/// inputs                                                      columns
/// direction of gravity in body axes, unit vector              0 to 2
/// body rates [rad/s]                                          3 to 5
/// commanded roll and pitch [rad], commanded yaw rate [rad/s]  6 to 8
/// last outputs, zeros at first                                9 to 11, of motors 9 to 12
/// commanded throttle, 0 to 1, for motors only                 13
///
/// Outputs, -1..1: roll, pitch and yaw rate over RC_MAX_ROLLRATE, RC_MAX_PITCHRATE and RC_MAX_YAWRATE; or the outputs of four
/// motors in the order of their channels, -1 off, 1 full. The numbers that a kind does not have are zeros.
struct Policy {
  enum class Kind : std::uint8_t { kBodyRates, kMotorOutputs };
  static constexpr std::size_t kRateInputs = 12;
  static constexpr std::size_t kMotorCount = 4;
  static constexpr std::size_t kInputs = 14;
  static constexpr std::size_t kOutputs = 4;
  static constexpr std::size_t kMaxStates = 64;  ///< Recurrent units of all layers.
  using Inputs = std::array<float, kInputs>;
  using Outputs = std::array<float, kOutputs>;
  using States = std::array<float, kMaxStates>;

  const char* name;  ///< Name of the ONNX file.
  float period_s;    ///< From one inference to the next; 0: one for each IMU sample.
  /// One inference. `states` are zeros before the first.
  Outputs (*step)(States& states, const Inputs& inputs);
  Kind kind{Kind::kBodyRates};
};

/// The policy of this build; nullptr: it has none.
const Policy* built_in_policy();

}  // namespace rosflight::core
