// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/phase_table.hpp"

namespace rosflight::autonomy::quadplane {

/// What a flight is doing.
enum class Phase : std::uint8_t {
  kDisarmed,
  kTakeoff,     ///< Straight up.
  kTransition,  ///< Forward: from the rotors to the wing.
  kCruise,      ///< On the wing alone.
  kBack,        ///< Back: from the wing to the rotors.
  kHover,       ///< Above the landing point.
  kLanding,
  kLanded,  ///< Stands and requests to be disarmed.
  kPilot    ///< The pilot has it, or nobody.
};

/// The conditions of the table, one bit each.
struct Conditions {
  enum : std::uint16_t {
    kArmed = kArmedCondition,
    kPilot = 1U << 1U,      ///< Somebody else flies, or there is no state.
    kLandAsked = 1U << 2U,  ///< To land where it is.
    kUp = 1U << 3U,         ///< At the height of the take-off.
    kWingborne = 1U << 4U,  ///< Fast enough for the wing alone.
    kBraking = 1U << 5U,    ///< The end of the path is near.
    kArrived = 1U << 6U,    ///< At the end of the path, at rest.
    kTouched = 1U << 7U,
    kRests = 1U << 8U,        ///< On the ground after somebody else has flown.
    kReturnAsked = 1U << 9U,  ///< To land at the start.
    kNewPath = 1U << 10U,     ///< The path leads somewhere else from this step on.
    kBegun = 1U << 11U,       ///< The path was begun.
    kLow = 1U << 12U          ///< Too near to the ground to go on from here.
  };
};

/// Every change of phase: the first row that fits decides.
extern const PhaseTable<Phase> kPhaseTable;

/// Name for logs and messages, such as "takeoff".
inline const char* name(Phase phase) {
  return kPhaseTable.name(phase);
}

}  // namespace rosflight::autonomy::quadplane
