// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace rosflight::viewer::holoocean {
namespace {

using config::Range;
using config::Section;
using Json = nlohmann::ordered_json;

constexpr int kMaxTicks_per_s = 1000;
constexpr int kMaxSide_px = 8192;
constexpr int kMaxRays = 10'000;
constexpr int kBytesPerPixel = 4;
constexpr double kFarAway_m = 1e6;
const Section::Choices<SensorType> kSensors{
    {"LocationSensor", SensorType::kLocation},
    {"RotationSensor", SensorType::kRotation},
    {"VelocitySensor", SensorType::kVelocity},
    {"CollisionSensor", SensorType::kCollision},
    {"RangeFinderSensor", SensorType::kRangeFinder},
    {"RGBCamera", SensorType::kRgbCamera},
    {"DepthCamera", SensorType::kDepthCamera},
    {"SemanticSegmentationCamera", SensorType::kSegmentationCamera}};
const Section::Choices<AgentType> kAgents{{"UavAgent", AgentType::kUav},
                                          {"FixedWing", AgentType::kFixedWing}};

constexpr const char* kDefaultScenario = R"({
  "name": "ROSflight",
  "package_name": "Land",
  "ticks_per_sec": 30,
  "frames_per_sec": false,
  "agents": [{
    "agent_name": "aircraft",
    "agent_type": "UavAgent",
    "sensors": [
      {"sensor_type": "RGBCamera", "sensor_name": "rgb_camera_sensor",
       "configuration": {"CaptureWidth": 512, "CaptureHeight": 512}},
      {"sensor_type": "RangeFinderSensor", "sensor_name": "range_finder_sensor",
       "configuration": {"LaserMaxDistance": 50, "LaserCount": 6}},
      {"sensor_type": "RangeFinderSensor", "sensor_name": "ground_range_sensor",
       "configuration": {"LaserMaxDistance": 100, "LaserCount": 1, "LaserAngle": -90}},
      {"sensor_type": "CollisionSensor"}
    ]
  }]
})";

std::array<double, 3> triple(const Section& from, std::string_view key) {
  const auto values = from.numbers(key, 3, Range::between(-kFarAway_m, kFarAway_m), {0, 0, 0});
  return {values[0], values[1], values[2]};
}

std::optional<std::array<double, 3>> optional_triple(const Section& from, std::string_view key) {
  if (!from.has(key)) return std::nullopt;
  return triple(from, key);
}

std::optional<double> optional_length(const Section& from, std::string_view key) {
  if (!from.has(key)) return std::nullopt;
  return from.number(key, Range::positive_up_to(kFarAway_m));
}

/// The engine puts names into JSON and into names of files as they are.
std::string name_of(const Section& from, std::string_view key, std::string_view if_absent) {
  constexpr std::size_t kMaxLength = 64;
  std::string name = from.text(key, if_absent);
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (name.empty() || name.size() > kMaxLength || !plain) {
    throw from.error(key, from.raw(key), "1 to 64 letters, digits, _ and -");
  }
  return name;
}

int whole(const Section& from, std::string_view key, int low, int high, int if_absent) {
  return static_cast<int>(from.integer(key, low, high, if_absent));
}

void read_camera(const Section* from, SensorSetup& sensor, Json& json) {
  constexpr int kDefaultSide_px = 256;
  sensor.width_px = sensor.height_px = kDefaultSide_px;
  if (from != nullptr) {
    sensor.width_px = whole(*from, "CaptureWidth", 1, kMaxSide_px, kDefaultSide_px);
    sensor.height_px = whole(*from, "CaptureHeight", 1, kMaxSide_px, kDefaultSide_px);
  }
  json["CaptureWidth"] = sensor.width_px;
  json["CaptureHeight"] = sensor.height_px;
  json["TicksPerCapture"] = sensor.ticks_per_sample;
}

void read_range_finder(const Section* from, SensorSetup& sensor, Json& json) {
  constexpr double kDefaultRange_m = 10.0;
  constexpr double kQuarterTurn_deg = 90.0;
  sensor.max_range_m = kDefaultRange_m;
  sensor.rays = 1;
  if (from != nullptr) {
    sensor.max_range_m =
        from->number("LaserMaxDistance", Range::positive_up_to(kFarAway_m), kDefaultRange_m);
    sensor.rays = whole(*from, "LaserCount", 1, kMaxRays, 1);
    sensor.elevation_deg =
        from->number("LaserAngle", Range::between(-kQuarterTurn_deg, kQuarterTurn_deg), 0.0);
  }
  json["LaserMaxDistance"] = sensor.max_range_m;
  json["LaserCount"] = sensor.rays;
  json["LaserAngle"] = sensor.elevation_deg;
  if (from != nullptr && from->boolean("LaserDebug", false)) json["LaserDebug"] = true;
}

/// Keys of ROSflight 2.x that change nothing here: every sensor is handed out, and no camera has an attitude to report.
void accept_keys_of_rosflight(const Section& from) {
  from.boolean("ros_publish", true);
  from.boolean("UseRPY", true);
}

int ticks_per_sample(const Section& from, int ticks_per_s) {
  const double rate = from.number("Hz", Range::positive_up_to(ticks_per_s), ticks_per_s);
  const double ticks = std::round(ticks_per_s / rate);
  if (std::abs(ticks * rate - ticks_per_s) > 1e-9 * ticks_per_s) {
    throw from.error("Hz", from.raw("Hz"),
                     fmt::format("{0} (ticks_per_sec) divided by a whole number", ticks_per_s));
  }
  return static_cast<int>(ticks);
}

SensorSetup read_sensor(const Section& from, int ticks_per_s) {
  SensorSetup sensor;
  sensor.type = from.choice("sensor_type", kSensors);
  sensor.name = name_of(from, "sensor_name", engine_name(sensor.type));
  sensor.socket = from.text("socket", "");
  if (!sensor.socket.empty()) sensor.socket = name_of(from, "socket", "");
  sensor.location_m = triple(from, "location");
  sensor.rotation_deg = triple(from, "rotation");
  sensor.ticks_per_sample = ticks_per_sample(from, ticks_per_s);
  accept_keys_of_rosflight(from);
  const auto configuration = from.optional_section("configuration");
  const Section* const settings = configuration ? &*configuration : nullptr;
  Json json = Json::object();
  if (is_camera(sensor.type)) read_camera(settings, sensor, json);
  if (sensor.type == SensorType::kRangeFinder) read_range_finder(settings, sensor, json);
  sensor.configuration = json.dump();
  return sensor;
}

void read_sensors(const Section& agent, Scenario& scenario) {
  std::set<std::string> names;
  if (!agent.has("sensors")) return;
  for (const Section& from : agent.sections("sensors")) {
    SensorSetup sensor = read_sensor(from, scenario.ticks_per_s);
    if (!names.insert(sensor.name).second) {
      throw from.error(from.has("sensor_name") ? "sensor_name" : "sensor_type",
                       sensor.name + " again", "each name once");
    }
    scenario.sensors.push_back(std::move(sensor));
  }
}

void read_agent(const Section& root, Scenario& scenario) {
  const auto agents = root.sections("agents");
  if (agents.size() != 1) {
    throw root.error("agents", fmt::format("{} agents", agents.size()), "one, the aircraft");
  }
  const Section& agent = agents.front();
  scenario.agent = name_of(agent, "agent_name", "aircraft");
  scenario.agent_type = agent.choice("agent_type", kAgents);
  // FixedWing 2: accelerations without gravity and damping, so it stays as it is between two states.
  // A UavAgent has two schemes; the engine takes the 2 of ROSflight 2.x as 0.
  const bool wing = scenario.agent_type == AgentType::kFixedWing;
  scenario.control_scheme = whole(agent, "control_scheme", 0, 2, wing ? 2 : 0);
  for (const char* key : {"location_randomization", "rotation_randomization"}) {
    if (triple(agent, key) != std::array<double, 3>{})
      throw agent.error(key, "numbers other than 0", "0, 0, 0: two flights of a seed are the same");
  }
  scenario.location_m = triple(agent, "location");
  scenario.rotation_deg = triple(agent, "rotation");
  const std::string main_agent = root.text("main_agent", scenario.agent);
  if (main_agent != scenario.agent) {
    throw root.error("main_agent", main_agent, scenario.agent + ", the name of the agent");
  }
  read_sensors(agent, scenario);
}

int read_frame_rate(const Section& root, int ticks_per_s) {
  const std::string raw = root.raw("frames_per_sec");
  if (!root.has("frames_per_sec") || raw == "true") return ticks_per_s;
  if (raw == "false") return 0;
  return whole(root, "frames_per_sec", 1, kMaxTicks_per_s, ticks_per_s);
}

}  // namespace

const char* engine_name(SensorType type) {
  for (const auto& [name, value] : kSensors) {
    if (value == type) return name.data();
  }
  return "";
}

bool is_camera(SensorType type) {
  return type == SensorType::kRgbCamera || type == SensorType::kDepthCamera ||
         type == SensorType::kSegmentationCamera;
}

std::size_t SensorSetup::bytes() const {
  constexpr std::size_t kVector = 3 * sizeof(float);
  switch (type) {
    case SensorType::kCollision:
      return 1;
    case SensorType::kRangeFinder:
      return static_cast<std::size_t>(rays) * sizeof(float);
    case SensorType::kRgbCamera:
    case SensorType::kDepthCamera:
    case SensorType::kSegmentationCamera:
      return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) *
             kBytesPerPixel;
    case SensorType::kLocation:
    case SensorType::kRotation:
    case SensorType::kVelocity:
      break;
  }
  return kVector;
}

Scenario read_scenario(const config::Document& document) {
  const Section root = document.root();
  Scenario scenario;
  scenario.name = root.text("name", "");
  scenario.package = name_of(root, "package_name", "Land");
  if (root.has("world")) scenario.world = name_of(root, "world", "");
  scenario.ticks_per_s = whole(root, "ticks_per_sec", 1, kMaxTicks_per_s, scenario.ticks_per_s);
  scenario.frames_per_s = read_frame_rate(root, scenario.ticks_per_s);
  scenario.window_width_px = whole(root, "window_width", 1, kMaxSide_px, scenario.window_width_px);
  scenario.window_height_px =
      whole(root, "window_height", 1, kMaxSide_px, scenario.window_height_px);
  scenario.env_min_m = optional_triple(root, "env_min");
  scenario.env_max_m = optional_triple(root, "env_max");
  scenario.octree_min_m = optional_length(root, "octree_min");
  scenario.octree_max_m = optional_length(root, "octree_max");
  root.boolean("ros_publish", true);
  read_agent(root, scenario);
  root.finish();
  return scenario;
}

Scenario read_scenario_file(const std::filesystem::path& file) {
  return read_scenario(config::Document::from_file(file));
}

Scenario default_scenario(AgentType agent) {
  auto document = config::Document::from_text(kDefaultScenario, "default scenario");
  if (agent == AgentType::kFixedWing) document.set("agents.0.agent_type=FixedWing");
  return read_scenario(document);
}

}  // namespace rosflight::viewer::holoocean
