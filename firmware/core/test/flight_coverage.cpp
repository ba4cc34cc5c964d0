// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/flight_coverage.hpp"

#include <algorithm>
#include <sstream>

namespace rosflight::core {

void Coverage::add(const Coverage& o) {
  passes += o.passes;
  armed_passes += o.armed_passes;
  failsafe_passes += o.failsafe_passes;
  offboard_passes += o.offboard_passes;
  companion_in_failsafe_passes += o.companion_in_failsafe_passes;
  hold_passes += o.hold_passes;
  armed_on_ground += o.armed_on_ground;
  armed_in_air += o.armed_in_air;
  armed_after_fault += o.armed_after_fault;
  disarmed += o.disarmed;
  imu_lost_armed += o.imu_lost_armed;
  receiver_lost_armed += o.receiver_lost_armed;
  auxiliary_motor_passes += o.auxiliary_motor_passes;
  calibrations_left += o.calibrations_left;
  saves += o.saves;
  restarts += o.restarts;
  foreign_messages += o.foreign_messages;
  parameter_changes += o.parameter_changes;
  motor_tests += o.motor_tests;
  longest_messages = std::max(longest_messages, o.longest_messages);
  longest_bytes_encoded = std::max(longest_bytes_encoded, o.longest_bytes_encoded);
  longest_bytes_read = std::max(longest_bytes_read, o.longest_bytes_read);
  for (std::size_t k = 0; k < kStateCount; ++k) {
    in_state[k] += o.in_state[k];
    for (std::size_t j = 0; j < kStateCount; ++j) transitions[k][j] += o.transitions[k][j];
  }
  for (const auto& [text, n] : o.refusals) refusals[text] += n;
}

std::string Coverage::report() const {
  std::ostringstream out;
  out << passes << " passes, armed " << armed_passes << ", failsafe " << failsafe_passes
      << ", offboard " << offboard_passes << ", companion in failsafe "
      << companion_in_failsafe_passes << ", held " << hold_passes << "\narmed on the ground "
      << armed_on_ground << ", in the air " << armed_in_air << ", after a fault "
      << armed_after_fault << "; disarmed " << disarmed << ", calibrations left "
      << calibrations_left << ", motor tests " << motor_tests << ", passes that write " << saves
      << ", restarts " << restarts << "\nreceiver lost armed " << receiver_lost_armed
      << ", IMU lost armed " << imu_lost_armed << ", auxiliary motors " << auxiliary_motor_passes
      << ", foreign messages " << foreign_messages << ", parameter messages " << parameter_changes
      << "\nlongest pass: " << longest_messages << " messages, " << longest_bytes_read
      << " B read, " << longest_bytes_encoded << " B encoded\nstates";
  for (const auto n : in_state) out << ' ' << n;
  out << "\ntransitions";
  for (std::size_t k = 0; k < kStateCount; ++k) {
    for (std::size_t j = 0; j < kStateCount; ++j) {
      if (k != j && transitions[k][j] > 0) out << ' ' << k << ">" << j << ':' << transitions[k][j];
    }
  }
  out << '\n';
  for (const auto& [text, n] : refusals) out << n << "  " << text << '\n';
  return out.str();
}

}  // namespace rosflight::core
