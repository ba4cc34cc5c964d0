// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/registry.hpp"
#include "sim/world_sensors/world_sensor.hpp"

namespace rosflight::sim {

/// Adds the sensors of this folder: "lidar", "depth_camera", "motion_capture".
void register_world_sensors(Registry& registry);

/// The sensors of one vehicle, as the section `world_sensors` of its file names them; empty without it:
///
///     world_sensors:
///       scan: {type: lidar, rays: 180, angle_min_deg: -90, angle_max_deg: 90}
///
/// Each has its own clock, delay and random streams: adding one leaves the readings of all others, and of the instruments
/// of sim/sensors, as they were, bit for bit.
class WorldSensors {
 public:
  struct Entry {
    std::string name;
    std::unique_ptr<WorldSensor> sensor;
  };

  WorldSensors() = default;
  /// @param shapes  must outlive this. @param step  of the simulation.
  /// @throws config::Error  unknown type or key, value out of range, a rate above that of the simulation.
  WorldSensors(const Registry& registry, const Vehicle& vehicle, const world::WorldShapes& shapes,
               const RandomSource& random, Time step);

  bool empty() const { return entries_.empty(); }
  const std::vector<Entry>& entries() const { return entries_; }

  /// Call once per step. `receive(name, sample)` gets each sample that became available at truth.time.
  template <class Receive>
  void step(const Truth& truth, Receive&& receive) {
    for (Entry& entry : entries_) {
      const WorldSample* sample = entry.sensor->step(truth);
      if (sample != nullptr) receive(entry.name, *sample);
    }
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace rosflight::sim
