// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace rosflight::apps {

class FlightWatch;  // apps/fly_command.hpp

/// Starts what --view asks for, on this port. @throws config::Error.
using MakeWatch = std::function<std::unique_ptr<FlightWatch>(std::uint16_t port)>;

/// Reads the command line of ./rosflight fly, flies and prints errors as one line.
/// @param make_watch  none: --view is refused.
/// @returns the exit code: 0, or 2 for bad input, or that of the command.
int fly_command_line(int argc, char** argv, const MakeWatch& make_watch = {});

}  // namespace rosflight::apps
