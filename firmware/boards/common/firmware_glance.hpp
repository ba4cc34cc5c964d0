// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

namespace rosflight::boards {

/// What a display may know of the firmware inside a board. Laid out the same on a 64-bit host and on
/// a Cortex-M7.
struct FirmwareGlance {
  std::int64_t imu_stamp_us{};      ///< Stamp of the newest IMU sample, in the time of the board.
  std::array<float, 10> command{};  ///< Combined command.
  std::array<std::uint8_t, 10> command_type{};
  std::uint8_t state{};
  std::uint8_t armed{};
  std::uint8_t failsafe{};
  std::uint8_t reserved{};
  std::uint16_t errors{};
  std::uint16_t primary_axes{};
  std::array<float, 4> q_WB{};  ///< All 0 before the first pass.
  float roll_rad{};
  float pitch_rad{};
  std::array<float, 3> rates_rad_s{};
};
static_assert(sizeof(FirmwareGlance) == 104);

}  // namespace rosflight::boards
