// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/phase_table.hpp"

namespace rosflight::autonomy::fixedwing {

/// What a flight is doing.
enum class Phase : std::uint8_t {
  kDisarmed,  ///< Or armed, and the caller is not ready to fly.
  kTakeoff,   ///< On the ground or just above it, full throttle, straight on.
  kClimb,     ///< Straight on to the height of the take-off.
  kMission,   ///< Along the path.
  kLoiter,    ///< Circles where it is, until it can go on.
  kReturn,    ///< To the position of the start, and circles there.
  kApproach,  ///< Along the path that ends on the ground.
  kGlide,     ///< Without a motor: down to a field in reach, at the speed that sinks least.
  kFlare,
  kRollout,  ///< On the ground.
  kLanded,   ///< Stands and requests to be disarmed.
  kDescent   ///< Without a position: circles down at a fixed bank, under power.
};

/// The conditions of the table, one bit each.
struct Conditions {
  enum : std::uint16_t {
    kArmed = kArmedCondition,
    kReady = 1U << 1U,          ///< The caller wants to fly, or to try the take-off again.
    kPilot = 1U << 2U,          ///< The pilot holds an axis.
    kAirborne = 1U << 3U,       ///< Clearly above the ground of the take-off.
    kHighEnough = 1U << 4U,     ///< Height of the take-off reached.
    kTooLate = 1U << 5U,        ///< The take-off takes too long.
    kPathDone = 1U << 6U,       ///< The path has ended, or there is none.
    kLandNext = 1U << 7U,       ///< A landing was asked for, or is what comes after the mission.
    kReturnNext = 1U << 8U,     ///< The same with the return.
    kPositionKnown = 1U << 9U,  ///< Good enough to follow a path.
    kMotorOut = 1U << 10U,
    kLow = 1U << 11U,  ///< Height to flare.
    kOnGround = 1U << 12U,
    kStands = 1U << 13U,
    kComeDown =
        1U << 14U,      ///< Down without a position: it was missing too long, or the battery ends.
    kHolds = 1U << 15U  ///< After a long gap (GapWatch): it goes nowhere yet.
  };
};

/// Every change of phase: the first row that fits decides.
extern const PhaseTable<Phase> kPhaseTable;

/// Name for logs and messages, such as "takeoff".
inline const char* name(Phase phase) {
  return kPhaseTable.name(phase);
}

}  // namespace rosflight::autonomy::fixedwing
