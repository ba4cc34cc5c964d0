// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/commands.hpp"

#include <nlohmann/json.hpp>

namespace rosflight::viewer::holoocean {
namespace {

using Json = nlohmann::ordered_json;  // the order of the keys matters

void append(Command& command, const std::array<double, 3>& numbers) {
  for (const double number : numbers) command.values.emplace_back(number);
}

}  // namespace

Command spawn_agent(const Scenario& scenario) {
  const bool wing = scenario.agent_type == AgentType::kFixedWing;
  Command command{"SpawnAgent", {std::string(wing ? "FixedWing" : "UAV"), scenario.agent}};
  append(command, scenario.location_m);
  append(command, scenario.rotation_deg);
  command.values.emplace_back(1.0);  // the main agent
  return command;
}

Command add_sensor(const Scenario& scenario, const SensorSetup& sensor) {
  Command command{"AddSensor",
                  {scenario.agent, sensor.name, std::string(engine_name(sensor.type)),
                   sensor.configuration, sensor.socket}};
  append(command, sensor.location_m);
  append(command, sensor.rotation_deg);
  return command;
}

Command render_viewport(bool on) {
  return {"RenderViewport", {on ? 1.0 : 0.0}};
}

Command adjust_frames_per_s(int rate) {
  return {"AdjustFPS", {static_cast<double>(rate)}};
}

Command adjust_ticks_per_s(int rate) {
  return {"AdjustTPS", {static_cast<double>(rate)}};
}

std::string command_text(const std::vector<Command>& commands) {
  Json list = Json::array();
  for (const Command& command : commands) {
    Json params = Json::array();
    for (const auto& value : command.values) {
      Json one;
      std::visit([&one](const auto& v) { one["value"] = v; }, value);
      params.push_back(std::move(one));
    }
    Json entry;
    entry["type"] = command.type;
    entry["params"] = std::move(params);
    list.push_back(std::move(entry));
  }
  Json text;
  text["commands"] = std::move(list);
  return text.dump() + "0";
}

}  // namespace rosflight::viewer::holoocean
