// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>

#include "rosflight_sim/vehicle_parameters.hpp"
#include "sim/registry.hpp"
#include "sim/world_sensors/world_sensors.hpp"

namespace rosflight_sim {

/// The sensors of the world of a vehicle file as topics: NAME/scan, NAME/image_raw and NAME/camera_info, NAME/pose,
/// NAME/range, each with the time of its measurement; their frames on /tf_static. Nothing is declared or published without
/// the section `world_sensors`.
class WorldTopics {
 public:
  /// Declares world_file. @throws config::Error  a section or a world file with an error.
  WorldTopics(rclcpp::Node& node, const sim::Registry& registry, const VehicleParameters& vehicle,
              sim::Time step);
  /// @param stamp_ns  ROS time of the truth.
  void step(const sim::Truth& truth, std::int64_t stamp_ns);

 private:
  void publish_frames(const VehicleParameters& vehicle);

  struct Publishers;
  rclcpp::Node& node_;
  std::string prefix_;
  sim::world::WorldShapes shapes_;
  sim::WorldSensors sensors_;
  std::shared_ptr<Publishers> publishers_;
};

}  // namespace rosflight_sim
