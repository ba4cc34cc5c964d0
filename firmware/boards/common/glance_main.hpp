// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/firmware_glance.hpp"
#include "firmware/core/firmware.hpp"

namespace rosflight::boards {

/// For the main loop of an image: what the firmware's state is now. Command and attitude follow with each
/// sample of the IMU.
inline void glance(const core::Firmware& firmware, FirmwareGlance& out) {
  const core::StateMachine& state = firmware.state();
  out.state = static_cast<std::uint8_t>(state.state());
  out.armed = state.armed() ? 1 : 0;
  out.failsafe = state.failsafe() ? 1 : 0;
  out.errors = state.errors();
  out.primary_axes = firmware.command().primary_axes();
  if (!firmware.sensors().measurements().new_imu) return;
  out.imu_stamp_us = firmware.sensors().measurements().imu.stamp.count();
  const core::CommandVector& combined = firmware.command().combined();
  for (std::size_t k = 0; k < out.command.size(); ++k) {
    out.command[k] = combined.value[k];
    out.command_type[k] = static_cast<std::uint8_t>(combined.type[k]);
  }
  const core::AttitudeEstimate& estimate = firmware.estimator().estimate();
  out.q_WB = {estimate.q_WB.w, estimate.q_WB.x, estimate.q_WB.y, estimate.q_WB.z};
  out.roll_rad = estimate.roll_rad;
  out.pitch_rad = estimate.pitch_rad;
  for (std::size_t k = 0; k < 3; ++k) {
    out.rates_rad_s[k] = estimate.rates_rad_s[static_cast<Eigen::Index>(k)];
  }
}

}  // namespace rosflight::boards
