// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/phases.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

using P = Conditions;
using T = PhaseTransition<Phase>;

constexpr std::array kTransitions = {
    T{Phase::kDisarmed, P::kReady, P::kPilot, Phase::kTakeoff},

    T{Phase::kTakeoff, P::kPilot | P::kAirborne, 0, Phase::kLoiter},
    T{Phase::kTakeoff, P::kPilot, 0, Phase::kTakeoff},
    T{Phase::kTakeoff, P::kAirborne, 0, Phase::kClimb},
    T{Phase::kTakeoff, P::kTooLate, 0, Phase::kRollout},

    T{Phase::kClimb, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kClimb, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kClimb, P::kHighEnough | P::kPositionKnown, 0, Phase::kMission},
    T{Phase::kClimb, P::kHighEnough, 0, Phase::kLoiter},

    T{Phase::kMission, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kMission, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kMission, 0, P::kPositionKnown, Phase::kLoiter},
    T{Phase::kMission, P::kLandNext, 0, Phase::kApproach},
    T{Phase::kMission, P::kReturnNext, 0, Phase::kReturn},
    T{Phase::kMission, P::kPathDone, 0, Phase::kLoiter},

    T{Phase::kLoiter, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kLoiter, P::kOnGround, 0, Phase::kRollout},
    T{Phase::kLoiter, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kLoiter, P::kComeDown, P::kPositionKnown, Phase::kDescent},
    T{Phase::kLoiter, P::kPositionKnown | P::kLandNext, P::kHolds, Phase::kApproach},
    T{Phase::kLoiter, P::kPositionKnown | P::kReturnNext, P::kHolds, Phase::kReturn},
    T{Phase::kLoiter, P::kPositionKnown, P::kPathDone | P::kHolds, Phase::kMission},

    T{Phase::kReturn, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kReturn, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kReturn, 0, P::kPositionKnown, Phase::kLoiter},
    T{Phase::kReturn, P::kLandNext, 0, Phase::kApproach},
    T{Phase::kReturn, 0, P::kReturnNext, Phase::kMission},

    T{Phase::kApproach, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kApproach, P::kLow, 0, Phase::kFlare},
    T{Phase::kApproach, P::kOnGround, 0, Phase::kRollout},
    T{Phase::kApproach, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kApproach, 0, P::kPositionKnown, Phase::kLoiter},

    T{Phase::kDescent, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kDescent, P::kLow, 0, Phase::kFlare},
    T{Phase::kDescent, P::kOnGround, 0, Phase::kRollout},
    T{Phase::kDescent, P::kMotorOut, 0, Phase::kGlide},
    T{Phase::kDescent, P::kPositionKnown, 0, Phase::kLoiter},

    T{Phase::kGlide, P::kPilot, 0, Phase::kLoiter},
    T{Phase::kGlide, P::kLow, 0, Phase::kFlare},
    T{Phase::kGlide, P::kOnGround, 0, Phase::kRollout},

    T{Phase::kFlare, P::kPilot, P::kOnGround, Phase::kLoiter},
    T{Phase::kFlare, P::kOnGround, 0, Phase::kRollout},

    T{Phase::kRollout, P::kStands | P::kReady, P::kPilot, Phase::kTakeoff},
    T{Phase::kRollout, P::kStands, 0, Phase::kLanded},
};

constexpr std::array kNames{"disarmed", "takeoff", "climb", "mission", "loiter", "return",
                            "approach", "glide",   "flare", "rollout", "landed", "descent"};

}  // namespace

constinit const PhaseTable<Phase> kPhaseTable{kNames, kTransitions};

}  // namespace rosflight::autonomy::fixedwing
