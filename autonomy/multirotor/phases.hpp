// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/phase_table.hpp"

namespace rosflight::autonomy::multirotor {

/// What a flight is doing.
enum class Phase : std::uint8_t {
  kDisarmed,  ///< Or armed, and the caller is not ready to fly.
  kTakeoff,
  kPositionHold,
  kOffboard,  ///< The received command is flown.
  kLanding,
  kLanded  ///< Stands with idle motors and requests to be disarmed.
};

/// The conditions of the table, one bit each.
struct Conditions {
  enum : std::uint16_t {
    kArmed = kArmedCondition,
    kReady = 1U << 1U,  ///< The caller wants to fly.
    kCommandGood = 1U << 2U,
    kPilot = 1U << 3U,  ///< The pilot holds an axis.
    kLandAsked = 1U << 4U,
    kLiftedOff = 1U << 5U,
    kHeightReached = 1U << 6U,
    kTakeoffLate = 1U << 7U,
    kHoldOver = 1U << 8U,
    kCommandLost = 1U << 9U,  ///< No good command for lost_command_land_s.
    kTouched = 1U << 10U      ///< By a landing, or by a failsafe command of the flight controller.
  };
};

/// Every change of phase: the first row that fits decides.
extern const PhaseTable<Phase> kPhaseTable;

/// Name for logs and messages, such as "takeoff".
inline const char* name(Phase phase) {
  return kPhaseTable.name(phase);
}

}  // namespace rosflight::autonomy::multirotor
