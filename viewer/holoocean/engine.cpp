// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/engine.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include "base/constants.hpp"

namespace rosflight::viewer::holoocean {
namespace {

constexpr std::size_t kCommandBytes = 1'048'576;
constexpr std::size_t kUavAction = 4;
constexpr std::size_t kFixedWingAction = 8;
constexpr std::uint8_t kWholeState = 15;  // the twelve numbers of AgentState
constexpr int kResetTicks = 3;
constexpr int kMaxIgnoredStates = 3;
// Those of the client, for scenarios and worlds without them.
constexpr std::array<double, 3> kEnvMin_m{-10.0, -10.0, -10.0};
constexpr std::array<double, 3> kEnvMax_m{10.0, 10.0, 10.0};
constexpr double kOctreeMin_m = 0.02;
constexpr double kOctreeMax_m = 5.0;
constexpr const char* kOldBlocks =
    "the engine reads blocks that a client before this one has removed; restart it";
constexpr std::chrono::milliseconds kSlice{50};  // between two looks at the process

std::string loading_path(const std::string& name) {
  return "/HOLODECK_LOADING_SEM" + name;
}
std::string server_path(const std::string& name) {
  return "/HOLODECK_SEMAPHORE_SERVER" + name;
}
std::string client_path(const std::string& name) {
  return "/HOLODECK_SEMAPHORE_CLIENT" + name;
}

std::string taken(const std::string& name) {
  return "the engine named '" + name + "' is used by another client";
}

std::size_t action_size(AgentType agent) {
  return agent == AgentType::kFixedWing ? kFixedWingAction : kUavAction;
}

void clear(SharedBlock& block) {
  std::memset(block.bytes().data(), 0, block.bytes().size());
}

void append_box(std::vector<std::string>& arguments, const char* name,
                const std::array<double, 3>& corner) {
  constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    arguments.push_back(fmt::format("-{}{}={}", name, kAxes[i], config::number_text(corner[i])));
  }
}

/// As the engine reads them, in its client's order; the client sends all of them.
std::vector<std::string> program_arguments(const Scenario& scenario, const World& world,
                                           const std::string& name, bool window) {
  std::vector<std::string> arguments{
      world.program.string(),
      world.name,
      "-HolodeckOn",
      "-LOG=HolodeckLog.txt",
      "-ForceRes",
      fmt::format("-ResX={}", scenario.window_width_px),
      fmt::format("-ResY={}", scenario.window_height_px),
      "--HolodeckUUID=" + name,
      fmt::format("-TicksPerSec={}", scenario.ticks_per_s),
      fmt::format("-FramesPerSec={}", scenario.frames_per_s),
  };
  append_box(arguments, "EnvMin", scenario.env_min_m.value_or(world.env_min_m.value_or(kEnvMin_m)));
  append_box(arguments, "EnvMax", scenario.env_max_m.value_or(world.env_max_m.value_or(kEnvMax_m)));
  arguments.push_back("-OctreeMin=" +
                      config::number_text(scenario.octree_min_m.value_or(kOctreeMin_m)));
  arguments.push_back("-OctreeMax=" +
                      config::number_text(scenario.octree_max_m.value_or(kOctreeMax_m)));
  if (!window) arguments.emplace_back("-RenderOffScreen");
  return arguments;
}

std::array<float, 3> triple(std::span<const std::byte> bytes) {
  std::array<float, 3> values{};
  std::memcpy(values.data(), bytes.data(), sizeof(values));
  return values;
}

Image image(const SensorSetup& sensor, std::span<const std::byte> bytes) {
  Image image{sensor.name, sensor.type, sensor.width_px, sensor.height_px, {}};
  image.bgra.resize(bytes.size());
  std::memcpy(image.bgra.data(), bytes.data(), bytes.size());
  return image;
}

/// Before version 2.2 a ray that hits nothing has the maximum, since then -1.
Ranges ranges(const SensorSetup& sensor, std::span<const std::byte> bytes) {
  Ranges ranges{sensor.name, sensor.max_range_m, sensor.elevation_deg * base::kRadPerDeg, {}};
  ranges.ranges_m.resize(static_cast<std::size_t>(sensor.rays));
  std::memcpy(ranges.ranges_m.data(), bytes.data(), bytes.size());
  const auto limit = static_cast<float>(sensor.max_range_m);
  for (float& range : ranges.ranges_m) {
    const bool hit = range >= 0.0F && range < limit;
    if (!hit) range = std::numeric_limits<float>::infinity();
  }
  return ranges;
}

}  // namespace

double depth_m(const Image& image, int column, int row) {
  constexpr double kScale_m = 1000.0 / ((1 << 24) - 1);
  const auto at = 4U * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width_px) +
                        static_cast<std::size_t>(column));
  const std::uint8_t* const p = image.bgra.data() + at;  // blue, green, red
  return kScale_m * (p[2] + 256.0 * p[1] + 65536.0 * p[0]);
}

/// Everything by the engine's names, mapped once it has loaded its world.
struct Engine::Shared {
  Shared(const std::string& name, const Scenario& scenario, SharedBlock locked_reset,
         SharedBlock::AtEnd at_end)
      : reset{std::move(locked_reset)},
        server{server_path(name), Semaphore::Open::kExisting},
        client{client_path(name), Semaphore::Open::kExisting},
        command_flag{name, "command_bool", 1, at_end},
        command_buffer{name, "command_buffer", kCommandBytes, at_end},
        action{name, scenario.agent, sizeof(float) * action_size(scenario.agent_type), at_end},
        scheme{name, scenario.agent + "_control_scheme", 1, at_end},
        teleport_flag{name, scenario.agent + "_teleport_flag", 1, at_end},
        teleport{name, scenario.agent + "_teleport_command", sizeof(AgentState), at_end} {
    for (const SensorSetup& sensor : scenario.sensors) {
      const std::string key = scenario.agent + "_" + sensor.name + "_sensor_data";
      sensors.emplace(sensor.name, SharedBlock(name, key, sensor.bytes(), at_end));
    }
    if (at_end == SharedBlock::AtEnd::kKeep) return;
    server.remove_at_end();
    client.remove_at_end();
  }

  SharedBlock reset;
  Semaphore server, client;
  SharedBlock command_flag, command_buffer, action, scheme, teleport_flag, teleport;
  std::map<std::string, SharedBlock> sensors;
};

namespace {

/// The block RESET, which a client has locked as long as it uses the engine.
/// @throws EngineError  another client has. Its name stays then, as the other needs it.
SharedBlock locked_reset(const std::string& name) {
  SharedBlock reset(name, "RESET", 1, SharedBlock::AtEnd::kKeep);
  if (!reset.lock()) throw EngineError(taken(name));
  return reset;
}

}  // namespace

void check_available(const Engine::Options& options) {
  const std::string& name = options.name;
  if (!options.world.program.empty()) {
    if (name.empty()) return;  // a new one is made
    if (Semaphore::exists(server_path(name)) || Semaphore::exists(loading_path(name)))
      throw EngineError(
          fmt::format("there is an engine named '{0}' already; if none runs, remove "
                      "/dev/shm/sem.HOLODECK_*{0} and /dev/shm/HOLODECK_MEM{0}_*",
                      name));
    return;
  }
  if (!Semaphore::exists(client_path(name))) {
    throw EngineError(
        "found no running engine to attach to, allowed one that has loaded its world");
  }
  locked_reset(name);
}

Engine::Engine(const Scenario& scenario, Options options)
    : scenario_{scenario}, options_{std::move(options)} {
  remove_leftovers();
  check_available(options_);
  const bool attach = options_.world.program.empty();
  if (!attach && options_.name.empty()) options_.name = unique_name();
  SharedBlock reset_block = locked_reset(options_.name);
  if (!attach) {
    reset_block.remove_at_end();
    start_program();
  }
  shared_ =
      std::make_unique<Shared>(options_.name, scenario_, std::move(reset_block),
                               attach ? SharedBlock::AtEnd::kKeep : SharedBlock::AtEnd::kRemove);
  wait(shared_->client, options_.tick_timeout, "its first turn");
  has_turn_ = true;
  if (!options_.window) queued_.push_back(render_viewport(false));
  reset();
}

Engine::~Engine() {
  child_.stop();
  // A running engine waits for a client: the turn stays for the next one.
  if (options_.world.program.empty() && has_turn_) shared_->client.post();
}

void Engine::start_program() {
  const std::string& name = options_.name;
  Semaphore loaded(loading_path(name), Semaphore::Open::kNew);
  child_.start(program_arguments(scenario_, options_.world, name, options_.window), {});
  wait(loaded, options_.load_timeout,
       ::geteuid() == 0 ? "its world to load (run by root, which Unreal's programs refuse)"
                        : "its world to load");
}

void Engine::wait(Semaphore& semaphore, std::chrono::milliseconds timeout, const char* what) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!semaphore.wait_for(kSlice)) {
    if (child_.running()) child_.check();
    if (options_.interrupted && options_.interrupted()) throw EngineError("interrupted");
    if (std::chrono::steady_clock::now() < end) continue;
    const std::string why =
        fmt::format("waited {:g} s for {}", 1e-3 * static_cast<double>(timeout.count()), what);
    if (child_.running()) child_.give_up(why);
    throw EngineError(why);
  }
}

void Engine::bare_tick() {
  if (!queued_.empty()) {
    const std::string text = command_text(queued_);
    if (text.size() > shared_->command_buffer.bytes().size())
      throw EngineError("too many commands");
    std::memcpy(shared_->command_buffer.bytes().data(), text.data(), text.size());
    shared_->command_flag.set_flag(1);
    queued_.clear();
  }
  has_turn_ = false;
  shared_->server.post();
  wait(shared_->client, options_.tick_timeout, "a tick");
  has_turn_ = true;
}

void Engine::reset() {
  shared_->teleport_flag.set_flag(0);
  clear(shared_->action);
  shared_->scheme.set_flag(static_cast<std::uint8_t>(scenario_.control_scheme));
  shared_->reset.set_flag(1);
  for (int i = 0; i < kResetTicks; ++i) bare_tick();
  if (shared_->reset.flag() != 0) throw EngineError(kOldBlocks);
  spawn();
}

void Engine::spawn() {
  if (options_.world.program.empty()) {  // an engine that was started has them as arguments
    queued_.push_back(adjust_frames_per_s(scenario_.frames_per_s));
    queued_.push_back(adjust_ticks_per_s(scenario_.ticks_per_s));  // for the ticks after this
  }
  queued_.push_back(spawn_agent(scenario_));
  for (const SensorSetup& sensor : scenario_.sensors)
    queued_.push_back(add_sensor(scenario_, sensor));
  for (int i = 0; i <= options_.world.pre_start_steps; ++i) bare_tick();
  spawn_ticks_ = static_cast<std::uint64_t>(options_.world.pre_start_steps) + 1;
  tick_ = 0;
  ignored_states_ = 0;
}

SensorFrame Engine::tick(std::chrono::nanoseconds t, const sim::BodyState& body) {
  const AgentState state = agent_state(body, scenario_.location_m, 1.0 / scenario_.ticks_per_s);
  std::memcpy(shared_->teleport.bytes().data(), &state, sizeof(state));
  shared_->teleport_flag.set_flag(kWholeState);  // last: the numbers are complete
  bare_tick();
  SensorFrame frame;
  frame.time = t;
  frame.tick = ++tick_;
  if (shared_->teleport_flag.flag() !=
      0) {  // the engine has not taken the state: nothing of it was measured
    if (++ignored_states_ > kMaxIgnoredStates) throw EngineError(kOldBlocks);
    return frame;
  }
  ignored_states_ = 0;
  for (const SensorSetup& sensor : scenario_.sensors) {
    const auto ticks = static_cast<std::uint64_t>(sensor.ticks_per_sample);
    if ((tick_ + spawn_ticks_) % ticks == 0) read(frame, sensor);
  }
  return frame;
}

void Engine::read(SensorFrame& frame, const SensorSetup& sensor) const {
  const std::span<const std::byte> bytes = shared_->sensors.at(sensor.name).bytes();
  switch (sensor.type) {
    case SensorType::kLocation:
      frame.p_W = position_W(triple(bytes), scenario_.location_m);
      break;
    case SensorType::kRotation:
      frame.q_WB = attitude_WB(triple(bytes));
      break;
    case SensorType::kVelocity:
      frame.v_W = velocity_W(triple(bytes));
      break;
    case SensorType::kCollision:
      frame.in_contact = bytes.front() != std::byte{0};
      break;
    case SensorType::kRangeFinder:
      frame.ranges.push_back(ranges(sensor, bytes));
      break;
    case SensorType::kRgbCamera:
    case SensorType::kDepthCamera:
    case SensorType::kSegmentationCamera:
      frame.images.push_back(image(sensor, bytes));
      break;
  }
}

}  // namespace rosflight::viewer::holoocean
