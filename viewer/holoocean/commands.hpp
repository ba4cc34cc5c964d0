// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "viewer/holoocean/scenario.hpp"

namespace rosflight::viewer::holoocean {

/// One command of the engine. It takes texts and numbers apart, so only the order within each kind counts.
struct Command {
  std::string type;
  std::vector<std::variant<double, std::string>> values;
};

Command spawn_agent(const Scenario& scenario);
Command add_sensor(const Scenario& scenario, const SensorSetup& sensor);
Command render_viewport(bool on);
Command adjust_frames_per_s(int rate);
Command adjust_ticks_per_s(int rate);

/// What is written to the command buffer: JSON with the key `commands`, in each command `type` before `params`,
/// followed by the character 0, which the engine's parser needs as an end.
std::string command_text(const std::vector<Command>& commands);

}  // namespace rosflight::viewer::holoocean
