// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/phases.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using P = Conditions;
using T = PhaseTransition<Phase>;

constexpr std::array kTransitions = {
    T{Phase::kDisarmed, 0, P::kPilot, Phase::kTakeoff},

    T{Phase::kTakeoff, P::kPilot, 0, Phase::kPilot},
    T{Phase::kTakeoff, P::kLandAsked, 0, Phase::kLanding},
    T{Phase::kTakeoff, P::kReturnAsked, 0, Phase::kLanding},
    T{Phase::kTakeoff, P::kUp, 0, Phase::kTransition},

    T{Phase::kTransition, P::kPilot, 0, Phase::kPilot},
    T{Phase::kTransition, P::kBraking, 0, Phase::kBack},
    T{Phase::kTransition, P::kWingborne, 0, Phase::kCruise},

    T{Phase::kCruise, P::kPilot, 0, Phase::kPilot},
    T{Phase::kCruise, P::kBraking, 0, Phase::kBack},

    T{Phase::kBack, P::kPilot, 0, Phase::kPilot},
    T{Phase::kBack, P::kArrived, 0, Phase::kHover},
    T{Phase::kBack, P::kNewPath, P::kBraking, Phase::kTransition},

    T{Phase::kHover, P::kPilot, 0, Phase::kPilot},
    T{Phase::kHover, P::kLandAsked, 0, Phase::kLanding},
    T{Phase::kHover, P::kArrived, 0, Phase::kLanding},

    T{Phase::kLanding, P::kPilot, 0, Phase::kPilot},
    T{Phase::kLanding, P::kTouched, 0, Phase::kLanded},

    T{Phase::kPilot, P::kRests, 0, Phase::kLanded},
    T{Phase::kPilot, P::kLow, P::kPilot, Phase::kLanding},
    T{Phase::kPilot, P::kLandAsked, P::kPilot | P::kBegun, Phase::kLanding},
    T{Phase::kPilot, P::kReturnAsked, P::kPilot | P::kBegun, Phase::kLanding},
    T{Phase::kPilot, 0, P::kPilot | P::kBegun, Phase::kTakeoff},
    T{Phase::kPilot, P::kBraking, P::kPilot, Phase::kBack},
    T{Phase::kPilot, 0, P::kPilot, Phase::kTransition},
};

constexpr std::array kNames{"disarmed", "takeoff", "transition", "cruise", "transition_back",
                            "hover",    "landing", "landed",     "pilot"};

}  // namespace

constinit const PhaseTable<Phase> kPhaseTable{kNames, kTransitions};

}  // namespace rosflight::autonomy::quadplane
