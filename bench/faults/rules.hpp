// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "bench/faults/cases.hpp"

namespace rosflight::bench::faults {

/// How a flight of the campaign ended, from the best to the worst.
enum class Class : unsigned char {
  kMissionDone,
  kLandedElsewhere,
  kNotFlown,  ///< It never left the ground, and its motors are off. Its outcome is kTimeout.
  kTimeout,   ///< In the air at the end, or on the ground with its motors on.
  kHardLanding,
  kCrash,
};
inline constexpr std::size_t kClasses = 6;
/// Short, for cells: "done", "landed", "ground", "timeout", "hard", "crash".
const char* name(Class c);

/// Why an end that is neither "done" nor "landed" is allowed: a hard landing or a crash, and with
/// kTakeOffGivenUp "ground".
enum class Rule : unsigned char {
  kNone,
  kPitchSurface,    ///< R1
  kRotorDead,       ///< R2
  kImuGone,         ///< R3
  kGyroBeyond,      ///< R4
  kPilotHasIt,      ///< R5
  kTakeOffGivenUp,  ///< R6
};
inline constexpr std::size_t kRules = 7;
/// "R1" to "R6"; "" for kNone.
const char* name(Rule rule);
/// One sentence for the page.
const char* text(Rule rule);

/// The rule that allows this flight to end hard; kNone: it has to end softly.
Rule rule_of(const Case& flown);
/// The rule that this end needs and has; kNone: it needs none, or none allows it.
Rule allowed_by(const Case& flown, Class ended);
/// Phases of a fault that begins while the vehicle stands or rolls before its take-off, where the take-off
/// may be given up: R6. Multirotors are in the air in the middle of "take-off".
bool before_lift_off(const std::string& phase);
/// Whether the mission has to be completed: after a single fault of a listed kind that is no larger and
/// no longer than listed.
bool needs_mission(const Case& flown);
/// Whether the end of a flight is what the rules ask for.
bool explained(const Case& flown, Class ended);

/// Largest gyro step that the estimator is meant to learn, on any axis [rad/s]: as
/// docs/autonomy/estimation.md states it.
inline constexpr double kGyroBiasLimit_rad_s = 0.1;

}  // namespace rosflight::bench::faults
