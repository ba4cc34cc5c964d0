// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::apps {

/// Reads the command line of ./rosflight params, calibrate, monitor, preflight and blackbox, runs the command and prints
/// errors as one line.
/// @returns the exit code: 0, or 2 for bad input and no answer, or that of the command.
int ground_command_line(int argc, char** argv);

}  // namespace rosflight::apps
