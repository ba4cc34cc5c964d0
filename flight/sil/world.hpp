// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>

#include "flight/sil/rc_lines.hpp"
#include "flight/sil/sil.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/faults.hpp"
#include "sim/faulty_modules.hpp"
#include "sim/rc/pilot.hpp"
#include "sim/registry.hpp"
#include "sim/sensors/register.hpp"

namespace rosflight::flight {

/// The vehicle around the firmware, its pilot and what breaks.
class SilWorld {
 public:
  /// @throws config::Error  unknown vehicle, fault or key; value out of range.
  SilWorld(const SilOptions& options, sim::Time step);

  sim::RcModule& rc() { return faulty_rc_; }
  sim::SensorsModule& sensors() { return faulty_sensors_; }
  sim::Dynamics& dynamics() { return dynamics_; }
  const sim::FaultSchedule& faults() const { return faults_; }
  /// Motors break at their time, and the pilot does what he reads.
  void before_step(sim::Time t);

 private:
  sim::RandomSource random_;
  sim::FaultSchedule faults_;
  sim::Registry registry_;
  sim::Vehicle vehicle_;
  std::unique_ptr<sim::ForcesAndMoments> forces_;
  sim::RigidBody dynamics_;
  std::unique_ptr<sim::SensorsModule> sensors_;
  sim::rc::Pilot pilot_;
  std::optional<RcLines> rc_lines_;
  sim::FaultySensors faulty_sensors_{*sensors_, faults_};
  sim::FaultyRc faulty_rc_{pilot_, faults_};
};

}  // namespace rosflight::flight
