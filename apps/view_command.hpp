// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>

namespace rosflight::apps {

class FlightWatch;  // apps/fly_command.hpp

struct ViewOptions {
  std::filesystem::path input;  ///< Flight folder or log.
  std::uint16_t port{0};        ///< 0: a free one.
};

/// Serves the page with a flight to browsers on this computer until Ctrl-C. Prints its address.
/// @returns the exit code, 0.
/// @throws config::Error  no such flight, no page, or the port is taken.
int view_command(const ViewOptions& options, std::ostream& out);

/// Serves the page with a flight that is about to run, and after it until Ctrl-C. Prints its address
/// to `err`. What the page shows are the messages of the log. @throws as view_command().
std::unique_ptr<FlightWatch> watch_flight(std::uint16_t port, std::ostream& err);

}  // namespace rosflight::apps
