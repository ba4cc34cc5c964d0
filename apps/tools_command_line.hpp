// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/sil/linux_autopilot.hpp"

namespace rosflight::apps {

/// Reads the command line of ./rosflight replay, sil, mixer and trim, runs the command and prints errors as one line.
/// @param sil_codec  what the firmware of `sil` speaks, in place of --link-protocol; nullptr: the value of the option.
/// @returns the exit code: 0, or 2 for bad input, or that of the command.
int tools_command_line(int argc, char** argv,
                       flight::LinuxAutopilot::MakeCodec sil_codec = nullptr);

}  // namespace rosflight::apps
