// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "flight/flight_setup.hpp"
#include "flight/link_state_estimator.hpp"
#include "flight/mission_runner.hpp"

namespace rosflight::flight {

/// How the companion and the pilot of this vehicle go from power-up to the end of a mission.
MissionRunnerConfig runner_config(const FlightSetup& setup);

/// The estimator of this vehicle, on what arrives over the link.
std::unique_ptr<LinkStateEstimator> make_link_estimator(const FlightSetup& setup,
                                                        companion::Session& session);

}  // namespace rosflight::flight
