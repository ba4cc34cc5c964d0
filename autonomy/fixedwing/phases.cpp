// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/phases.hpp"

#include <array>

namespace rosflight::autonomy::fixedwing {
namespace {

using P = Phases;
using T = Phases::Transition;

constexpr std::array kTransitions = {
    T{Phase::kDisarmed, P::kReady, P::kPilot, Phase::kTakeoff},

    T{Phase::kTakeoff, P::kPilot | P::kAirborne, 0, Phase::kLoiter},
    T{Phase::kTakeoff, P::kPilot, 0, Phase::kTakeoff},
    T{Phase::kTakeoff, P::kAirborne, 0, Phase::kClimb},
    T{Phase::kTakeoff, P::kTooLate, 0, Phase::kRollout},

    T{Phase::kClimb, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kClimb, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kClimb, P::kHighEnough | P::kPlaceKnown, 0, Phase::kMission},
    T{Phase::kClimb, P::kHighEnough, 0, Phase::kLoiter},

    T{Phase::kMission, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kMission, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kMission, 0, P::kPlaceKnown, Phase::kLoiter},
    T{Phase::kMission, P::kLandNext, 0, Phase::kApproach},
    T{Phase::kMission, P::kReturnNext, 0, Phase::kReturn},
    T{Phase::kMission, P::kPathDone, 0, Phase::kLoiter},

    T{Phase::kLoiter, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kLoiter, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kLoiter, P::kPlaceKnown | P::kLandNext, 0, Phase::kApproach},
    T{Phase::kLoiter, P::kPlaceKnown | P::kReturnNext, 0, Phase::kReturn},
    T{Phase::kLoiter, P::kPlaceKnown, P::kPathDone, Phase::kMission},

    T{Phase::kReturn, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kReturn, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kReturn, 0, P::kPlaceKnown, Phase::kLoiter},
    T{Phase::kReturn, P::kLandNext, 0, Phase::kApproach},

    T{Phase::kApproach, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kApproach, P::kLow, 0, Phase::kFlare},
    T{Phase::kApproach, P::kOnGround, 0, Phase::kRollout},
    T{Phase::kApproach, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kApproach, 0, P::kPlaceKnown, Phase::kLoiter},

    T{Phase::kGlide, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kGlide, P::kLow, 0, Phase::kFlare},
    T{Phase::kGlide, P::kOnGround, 0, Phase::kRollout},

    T{Phase::kFlare, P::kPilot, P::kOnGround, Phase::kLoiter},
    T{Phase::kFlare, P::kOnGround, 0, Phase::kRollout},

    T{Phase::kRollout, P::kStands, 0, Phase::kLanded},
};

}  // namespace

const char* name(Phase phase) {
  switch (phase) {
    case Phase::kDisarmed:
      return "disarmed";
    case Phase::kTakeoff:
      return "takeoff";
    case Phase::kClimb:
      return "climb";
    case Phase::kMission:
      return "mission";
    case Phase::kLoiter:
      return "loiter";
    case Phase::kReturn:
      return "return";
    case Phase::kApproach:
      return "approach";
    case Phase::kGlide:
      return "glide";
    case Phase::kFlare:
      return "flare";
    case Phase::kRollout:
      return "rollout";
    case Phase::kLanded:
      return "landed";
  }
  return "unknown";
}

std::span<const Phases::Transition> Phases::transitions() {
  return kTransitions;
}

Phase Phases::next(Phase from, std::uint16_t conditions) {
  if ((conditions & kArmed) == 0) return Phase::kDisarmed;
  for (const Transition& row : kTransitions) {
    if (row.from == from && (conditions & row.all) == row.all && (conditions & row.none) == 0) {
      return row.to;
    }
  }
  return from;
}

}  // namespace rosflight::autonomy::fixedwing
