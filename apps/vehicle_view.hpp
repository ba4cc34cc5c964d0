// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string_view>

#include "apps/view_command.hpp"

namespace rosflight::apps {

/// Whether a text names a link to a vehicle, not a file: serial:, pty:, udp:, tcp: or a path in /dev.
bool is_link(std::string_view text);

/// Serves the page with a vehicle on a link to browsers until Ctrl-C, and records what crosses the link, and
/// what viewers command, in a log. Viewers only look until one of them takes control; nothing arms the vehicle.
/// @returns the exit code, 0.
/// @throws config::Error  no page, it cannot listen there, or the folder is not new.
/// @throws base::LinkError  the link cannot be read or opened.
int view_vehicle(const ViewOptions& options, std::ostream& out);

}  // namespace rosflight::apps
