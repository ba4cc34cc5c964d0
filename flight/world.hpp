// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>

#include "flight/autopilot/autopilot.hpp"
#include "flight/autopilot/cable_link.hpp"
#include "flight/flight_setup.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/faulty_modules.hpp"
#include "sim/rc/pilot.hpp"
#include "sim/world_sensors/world_sensors.hpp"

namespace rosflight::flight {

/// A closed loop without its autopilot, companion and mission: vehicle, instruments, pilot and cable, and
/// what breaks of them.
struct World {
  /// @param flight_setup  must outlive this. @throws config::Error  a module does not accept its configuration.
  /// @throws boards::EmulatorError  the physics engine does not start.
  /// @param given  moves the body; nullptr: what the choice of physics says.
  explicit World(const FlightSetup& flight_setup,
                 std::unique_ptr<sim::PhysicsEngine> given = nullptr);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// At the beginning of each step, before pilot and sensors.
  void apply_faults(sim::Time t, Autopilot& autopilot);

  const FlightSetup& setup;
  sim::RandomSource random;
  std::unique_ptr<sim::ForcesAndMoments> forces;
  sim::RigidBody dynamics;
  std::unique_ptr<sim::PhysicsEngine> engine;  ///< nullptr: none but `dynamics`.
  std::string world_sha256;  ///< SHA-256 over all files of the world; empty: none.
  std::unique_ptr<sim::SensorsModule> healthy_sensors;
  sim::world::WorldShapes shapes;  ///< Empty without sensors of the world.
  sim::WorldSensors world_sensors;
  sim::FaultSchedule faults;
  sim::FaultySensors sensors;
  sim::rc::Pilot pilot;
  sim::FaultyRc rc;
  CableLink cable;
  double link_noise{0.0};
  std::array<bool, 2> broken_down{};  ///< Crash and hang: the fault has happened.

 private:
  void face_the_wind();
  void apply_link_faults(sim::Time t);
};

}  // namespace rosflight::flight
