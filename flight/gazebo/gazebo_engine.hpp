// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "flight/engine_process.hpp"
#include "flight/gazebo/engine_block.hpp"
#include "sim/dynamics/physics_engine.hpp"

namespace rosflight::flight {

/// Gazebo's physics engine dartsim as physics engine: the program gazebo_engine, in lock-step over a pipe. Mass,
/// inertia, gravity and equations of motion are dartsim's, the load comes from here. With a world file so do contacts, and the
/// vehicle's own ground is off; without one the ground is part of the load.
///
/// Scheme, once per step: v += h a, then p += h v with the new velocity; likewise rates and attitude. A held load makes the velocity
/// exact; the position leads by h v/2.
///
/// Every function may throw boards::EmulatorError: the program has failed, ended or does not answer, the world file is
/// bad, or the vehicle would be inside a body of the world or have no ground below it.
class GazeboEngine final : public sim::PhysicsEngine {
 public:
  struct Options {
    std::filesystem::path program;
    std::string world_file;  ///< SDF; empty: none.
    /// With a world: how far above the ground the centre of mass may be where a state is set.
    double max_height_m{std::numeric_limits<double>::infinity()};
    std::chrono::milliseconds timeout{60'000};         ///< Longest time that a step may take.
    std::chrono::milliseconds start_timeout{120'000};  ///< Also reads the meshes of the world.

    /// The program that ./rosflight fly --physics gazebo builds. @throws config::Error  it is not there.
    static Options of_project();
    static std::filesystem::path program_of_project();
  };

  /// Starts the program. @param model_sdf  as vehicle_sdf() writes it. @throws boards::EmulatorError
  GazeboEngine(const std::string& model_sdf, double gravity_m_s2, const Options& options);

  void set_state(const sim::BodyState& state) override;
  void step(double h_s, const Load& load) override;
  const sim::BodyState& state() const override { return state_; }
  const Contact* contact() const override { return has_world_ ? &contact_ : nullptr; }
  /// Files that the world is made of: its own, those of included models, meshes. Each one once.
  const std::vector<std::string>& world_files() const { return world_files_; }
  /// SHA-256 of these files one after the other; empty without a world.
  std::string world_sha256() const;
  pid_t process() const { return program_.process(); }

 private:
  void command(char what, std::chrono::milliseconds timeout);
  void read_state();
  void read_contact(const sim::Quaternion& q_WB);

  bool has_world_;
  bool placed_{false};  ///< A state was set.
  std::chrono::milliseconds timeout_;
  EngineProcess program_;
  gazebo::Block* block_;
  std::vector<std::string> world_files_;
  sim::BodyState state_;
  Contact contact_;
};

}  // namespace rosflight::flight
