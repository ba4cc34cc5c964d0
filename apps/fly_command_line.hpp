// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::apps {

struct Viewers;

/// Reads the command line of ./rosflight fly, flies and prints errors as one line.
/// @param viewers  null: --view and --repeat are refused.
/// @returns the exit code: 0, or 2 for bad input, or that of the command.
int fly_command_line(int argc, char** argv, const Viewers* viewers = nullptr);

}  // namespace rosflight::apps
