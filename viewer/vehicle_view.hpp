// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "web/server/access.hpp"

namespace rosflight::viewer {

/// Whether a text names a link to a vehicle, not a file: serial:, pty:, udp:, tcp: or a path in /dev.
bool is_link(std::string_view text);

struct VehicleViewOptions {
  std::string link;
  std::optional<std::filesystem::path> folder;  ///< For the log; default: next in flights/.
  std::string
      compare;  ///< Link to another vehicle, whose parameters are compared with; empty: none.
  web::server::Access access;
};

/// Serves the page with a vehicle on a link to browsers until Ctrl-C, and records what crosses the link, and
/// what viewers command, in a log. Viewers only look until one of them takes control; nothing arms the vehicle.
/// @returns the exit code, 0.
/// @throws config::Error  no page, it cannot listen there, or the folder is not new.
/// @throws base::LinkError  the link cannot be read or opened.
int view_vehicle(const VehicleViewOptions& options, std::ostream& out);

}  // namespace rosflight::viewer
