// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <filesystem>

#include "flight/engine_process.hpp"
#include "sim/dynamics/physics_engine.hpp"
#include "sim/dynamics/rigid_body.hpp"

namespace rosflight::flight {

/// JSBSim as physics engine: jsbsim_engine.py in a process of its own, in lock-step over a pipe. Mass, inertia,
/// gravity and equations of motion are JSBSim's, the load comes from here. Its planet neither turns nor curves
/// within a flight; gravity is weaker by 2 h/R with R = 1e9 m, 2e-7 of it at 100 m.
///
/// Every function may throw boards::EmulatorError: the process has failed, ended or does not answer. It is
/// ended with this object and with the program, however that ends.
class JsbsimEngine final : public sim::PhysicsEngine {
 public:
  struct Options {
    std::filesystem::path python;  ///< Interpreter of an environment with JSBSim.
    std::filesystem::path script;
    std::chrono::milliseconds timeout{60'000};  ///< Longest time that a step may take.
    /// The same for the start, with JSBSim's imports.
    std::chrono::milliseconds start_timeout{120'000};

    /// Those of the project: .venv-jsbsim, which ./rosflight fly --physics jsbsim makes, else .venv, which tests
    /// use. @throws config::Error  there is neither.
    static Options of_project();
  };

  /// Starts the process. @throws boards::EmulatorError
  JsbsimEngine(const sim::BodyParameters& body, double gravity_m_s2, const Options& options);
  ~JsbsimEngine() override;
  JsbsimEngine(const JsbsimEngine&) = delete;
  JsbsimEngine& operator=(const JsbsimEngine&) = delete;

  void set_state(const sim::BodyState& state) override;
  void step(double h_s, const Load& load) override;
  const sim::BodyState& state() const override { return state_; }
  pid_t process() const { return program_.process(); }

 private:
  struct Block;
  void command(char what, std::chrono::milliseconds timeout);
  void read_state();

  std::chrono::milliseconds timeout_;
  EngineProcess program_;
  Block* block_;
  sim::BodyState state_;
};

}  // namespace rosflight::flight
