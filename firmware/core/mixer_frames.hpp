// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/mixer.hpp"

namespace rosflight::core {

/// Values of PRIMARY_MIXER and SECONDARY_MIXER.
enum class MixerId : std::uint8_t {
  kEscCalibration = 0,
  kQuadPlus = 1,
  kQuadX = 2,
  kHexPlus = 3,
  kHexX = 4,
  kOctoPlus = 5,
  kOctoX = 6,
  kY6 = 7,
  kX8 = 8,
  kFixedWing = 9,
  kInvertedVTail = 10,
  kCustom = 11,
};
inline constexpr std::int32_t kFirstNoMixer = 12;  ///< This and above: none.

/// The id names a mixer whose gains the firmware computes.
constexpr bool is_predefined(std::int32_t id) {
  return id >= 0 && id < 11;
}

/// Kinds and rates of a predefined mixer (ROSflight 2.0.1 tables).
MixerHeader frame_header(MixerId id);

/// Gains of a predefined mixer: the pseudo-inverse of the geometry for multirotor frames, the table
/// for fixed wings.
MixerGains frame_gains(MixerId id);

/// Moore-Penrose pseudo-inverse by singular values; those below 10 epsilon of the largest count as
/// zero, and elements below 1e-6 become exactly 0. M is input by channel, the result channel by
/// input. Slow: call it disarmed.
MixerGains pseudo_inverse(const Eigen::Matrix<float, kAxes, kChannels>& M);

}  // namespace rosflight::core
