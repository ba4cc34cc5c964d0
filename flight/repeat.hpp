// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "flight/flight_setup.hpp"

namespace rosflight::flight {

/// Source of the notes of viewers, and of the one that a person ended the flight.
inline constexpr const char* kViewer = "viewer";
inline constexpr const char* kOperator = "operator";

/// What a log says of how its flight came about: enough to fly it again to the bit.
struct RecordedFlight {
  struct Command {
    sim::Time at{};    ///< Time of the step in which it entered.
    std::string text;  ///< As in the log.
  };
  FlightChoice choice;  ///< Without the board: all give the same bits.
  std::string log;      ///< How much was logged: plot or full.
  std::vector<Command> commands;
  std::optional<sim::Time> ended;  ///< By a person, before the step at this time.
  std::string sha256;              ///< SHA-256 of the log.
};

/// @param log  a log, or a flight folder. @throws config::Error  it cannot be read, or is none of `fly`.
RecordedFlight read_recorded_flight(const std::filesystem::path& log);

}  // namespace rosflight::flight
