// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

#include "web/server/access.hpp"

namespace rosflight::apps {

class FlightWatch;  // apps/fly_command.hpp

/// Starts what --view asks for. @throws config::Error.
/// @param hold  the simulated pilot waits with arming for a viewer.
using MakeWatch =
    std::function<std::unique_ptr<FlightWatch>(const web::server::Access& access, bool hold)>;

/// Reads the command line of ./rosflight fly, flies and prints errors as one line.
/// @param make_watch  none: --view is refused.
/// @returns the exit code: 0, or 2 for bad input, or that of the command.
int fly_command_line(int argc, char** argv, const MakeWatch& make_watch = {});

}  // namespace rosflight::apps
