// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/phases.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

using P = Conditions;
using T = PhaseTransition<Phase>;

constexpr std::array kTransitions = {
    T{Phase::kDisarmed, P::kReady, P::kPilot, Phase::kTakeoff},

    T{Phase::kTakeoff, P::kPilot | P::kLiftedOff, 0, Phase::kPositionHold},
    T{Phase::kTakeoff, P::kPilot, 0, Phase::kTakeoff},
    T{Phase::kTakeoff, P::kLandAsked | P::kLiftedOff, 0, Phase::kLanding},
    T{Phase::kTakeoff, P::kLandAsked, 0, Phase::kLanded},
    T{Phase::kTakeoff, P::kHeightReached, 0, Phase::kPositionHold},
    T{Phase::kTakeoff, P::kTakeoffLate | P::kLiftedOff, 0, Phase::kLanding},
    T{Phase::kTakeoff, P::kTakeoffLate, 0, Phase::kLanded},

    T{Phase::kPositionHold, P::kTouched, 0, Phase::kLanded},
    T{Phase::kPositionHold, P::kPilot, 0, Phase::kPositionHold},
    T{Phase::kPositionHold, P::kLandAsked, 0, Phase::kLanding},
    T{Phase::kPositionHold, P::kHoldOver | P::kCommandGood, 0, Phase::kOffboard},
    T{Phase::kPositionHold, P::kCommandLost, 0, Phase::kLanding},

    T{Phase::kOffboard, P::kPilot, 0, Phase::kPositionHold},
    T{Phase::kOffboard, P::kLandAsked, 0, Phase::kLanding},
    T{Phase::kOffboard, 0, P::kCommandGood, Phase::kPositionHold},

    T{Phase::kLanding, P::kPilot, 0, Phase::kPositionHold},
    T{Phase::kLanding, P::kTouched, 0, Phase::kLanded},
};

constexpr std::array kNames{"disarmed", "takeoff", "position_hold",
                            "offboard", "landing", "landed"};

}  // namespace

constinit const PhaseTable<Phase> kPhaseTable{kNames, kTransitions};

}  // namespace rosflight::autonomy::multirotor
