// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "firmware/core/state_machine.hpp"

namespace rosflight::core {

/// A promise of the firmware that did not hold.
struct Violation {
  std::string invariant;
  std::string detail;
  std::uint64_t seed{};
  int pass{};
};

/// How often random flights came to what the invariants speak about.
struct Coverage {
  std::uint64_t passes{};
  std::uint64_t armed_passes{}, failsafe_passes{}, offboard_passes{};
  std::uint64_t companion_in_failsafe_passes{};  ///< FAILSAFE_OFFBRD: it went on.
  std::uint64_t hold_passes{};                   ///< OFFBOARD_HOLD: level, without a companion.
  std::uint64_t armed_on_ground{}, armed_in_air{}, armed_after_fault{}, disarmed{};
  std::uint64_t imu_lost_armed{}, receiver_lost_armed{}, auxiliary_motor_passes{};
  std::uint64_t calibrations_left{}, saves{}, restarts{}, foreign_messages{}, parameter_changes{};
  std::uint64_t motor_tests{};
  std::uint64_t longest_messages{}, longest_bytes_encoded{}, longest_bytes_read{};
  std::array<std::uint64_t, kStateCount> in_state{};
  std::array<std::array<std::uint64_t, kStateCount>, kStateCount> transitions{};
  std::map<std::string, std::uint64_t> refusals;

  void add(const Coverage& other);
  std::string report() const;
};

}  // namespace rosflight::core
