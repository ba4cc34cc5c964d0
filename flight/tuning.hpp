// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <variant>

#include "flight/flight_setup.hpp"

namespace rosflight::flight {

/// A vehicle file, and what its section `autonomy` says.
struct TunedVehicle {
  std::string text;
  std::variant<autonomy::multirotor::AutonomyConfig, autonomy::fixedwing::AutonomyConfig> autonomy;
};

/// The vehicle of a flight with another value of one key of `autonomy`, all checked as from the file.
/// @param text  the vehicle file as it is in force. @param key  "follower.horizontal.kp"
/// @throws config::Error  no such key, a value that is not allowed, or one that cannot change in flight.
TunedVehicle tuned(const std::string& text, const FlightSetup& setup, const std::string& key,
                   const std::string& value);

}  // namespace rosflight::flight
