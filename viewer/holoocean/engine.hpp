// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware/boards/common/host/child_process.hpp"
#include "viewer/holoocean/commands.hpp"
#include "viewer/holoocean/frames.hpp"
#include "viewer/holoocean/package.hpp"
#include "viewer/holoocean/scenario.hpp"
#include "viewer/holoocean/sensor_frame.hpp"
#include "viewer/holoocean/shared_memory.hpp"

namespace rosflight::viewer::holoocean {

/// The engine in a process of its own, in lock-step over shared memory: the client's end of the protocol of
/// HoloOcean 2.3 (the same in 0.5). One tick: commands and state are written, the engine moves by one physics step
/// and measures, its sensors are read. Nothing is written while the engine has the turn.
///
/// Every function may throw EngineError and boards::EmulatorError; the engine is of no use then. Blocks, semaphores
/// and process end with this object. Use it from one thread: the process ends with the thread that made the object.
class Engine {
 public:
  struct Options {
    World world;  ///< Its program; an empty path: attach to a running engine.
    std::string
        name;  ///< Part of the names of blocks and semaphores; empty and a program: unique_name().
    bool window{true};                               ///< false: it draws for its cameras alone.
    std::chrono::milliseconds load_timeout{30'000};  ///< Longest time until the world has loaded.
    std::chrono::milliseconds tick_timeout{60'000};
    std::function<bool()> interrupted;  ///< Asked while it waits; true gives up.
  };

  /// Starts the engine, spawns agent and sensors. Takes seconds with the real one.
  Engine(const Scenario& scenario, Options options);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Loads the level again, with agent and sensors.
  void reset();
  /// Sends the state of the aircraft at time t, advances by one tick and reads the sensors that are due. As the engine
  /// does, it counts the ticks of a sensor's rate from the moment when the sensor was added.
  SensorFrame tick(std::chrono::nanoseconds t, const sim::BodyState& body);
  pid_t process() const { return child_.process(); }
  const std::string& name() const { return options_.name; }

 private:
  struct Shared;  ///< Semaphores and blocks.
  void start_program();
  void wait(Semaphore& semaphore, std::chrono::milliseconds timeout, const char* what);
  void bare_tick();
  void spawn();
  void read(SensorFrame& frame, const SensorSetup& sensor) const;

  Scenario scenario_;
  Options options_;
  boards::ChildProcess child_{"holoocean"};
  std::unique_ptr<Shared> shared_;
  std::vector<Command> queued_;
  std::uint64_t tick_{0};
  std::uint64_t spawn_ticks_{0};  ///< Since the sensors were added, before tick 1.
  int ignored_states_{0};         ///< In a row.
  bool has_turn_{false};
};

/// Looks, before an engine is started or attached to, whether that is possible.
/// @throws EngineError  there is an engine of this name already, none to attach to, or it has another client.
void check_available(const Engine::Options& options);

}  // namespace rosflight::viewer::holoocean
