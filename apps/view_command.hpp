// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>

#include "web/server/access.hpp"

namespace rosflight::apps {

class FlightWatch;  // apps/fly_command.hpp

struct ViewOptions {
  std::filesystem::path input;  ///< Flight folder, log, or link to a vehicle.
  std::optional<std::filesystem::path>
      folder;  ///< For the log of a link; default: next in flights/.
  web::server::Access access;
};

/// Serves the page with a flight to browsers until Ctrl-C. Prints its address.
/// @returns the exit code, 0.
/// @throws config::Error  no such flight, no page, or it cannot listen there.
int view_command(const ViewOptions& options, std::ostream& out);

/// Serves the page with a flight that is about to run, and after it until Ctrl-C. Prints its address
/// to `err`. What the page shows are the messages of the log. @param hold  the simulated pilot waits with
/// arming for a viewer. @throws as view_command().
std::unique_ptr<FlightWatch> watch_flight(const web::server::Access& access, bool hold,
                                          std::ostream& err);

}  // namespace rosflight::apps
