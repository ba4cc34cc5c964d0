// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "sim/modules.hpp"
#include "viewer/holoocean/engine.hpp"

namespace rosflight::viewer::holoocean {

/// Shows a flight in HoloOcean and hands out what its cameras and range finders measure.
///
/// The engine runs in a thread of its own. It receives the state of the vehicle `ticks_per_s` times per simulated second
/// and returns nothing to the flight, which is therefore the same with and without it, whether the engine is slow,
/// silent or dead. After a failure the flight goes on without the engine.
class Visualiser final : public sim::Visualiser {
 public:
  enum class Pace {
    kWait,  ///< The simulation waits for each tick: the same frames in each flight of a seed.
    kSkip,  ///< The simulation never waits; states that the engine is too slow for are skipped.
  };
  /// Both are called in the thread of the engine.
  struct Receivers {
    std::function<void(SensorFrame&&)> frame;
    /// The engine started, or it failed: one line.
    std::function<void(const std::string&)> note;
  };
  struct Counts {
    std::uint64_t ticks{}, skipped{}, images{}, contacts{};
    bool failed{};
  };

  Visualiser(const Scenario& scenario, Engine::Options options, Pace pace, Receivers receivers);
  ~Visualiser() override;

  void step(const sim::Truth& truth, const hal::OutputValues& outputs) override;
  /// The same for a state whose time is finer than that of the simulation.
  void show(const sim::BodyState& body, std::chrono::nanoseconds time);
  /// The level is loaded again before the next tick.
  void reset();
  /// Ends the engine; no receiver is called from then on.
  Counts close();
  Counts counts() const;
  /// The engine has loaded the level, or failed to.
  bool started() const;
  void wait_until_started();
  /// Why the engine is of no use, one line; empty: nothing has failed.
  std::string failure() const;

 private:
  struct State {
    std::chrono::nanoseconds time;
    sim::BodyState body;
  };
  void run();
  void serve(Engine& engine);
  void fail(const std::string& why);
  bool interrupted() const;

  const Scenario scenario_;
  Engine::Options options_;
  const Pace pace_;
  const Receivers receivers_;
  std::int64_t next_tick_{0};  ///< Used by the flight's thread alone, like the next.
  sim::Time last_{};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<State> pending_;
  bool busy_{false}, reset_{false}, closing_{false}, started_{false};
  std::string failure_;
  Counts counts_;
  std::thread thread_;  ///< Last: it uses the others.
};

}  // namespace rosflight::viewer::holoocean
