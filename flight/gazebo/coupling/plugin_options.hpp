// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "flight/gazebo/coupling/whole_loop.hpp"

namespace rosflight::flight::gazebo {

/// What the elements of the plugin in a world file say, as names and texts in their order.
using PluginElements = std::vector<std::pair<std::string, std::string>>;

struct PluginOptions {
  enum class Mode { kDynamicsOnly, kWholeLoop };
  Mode mode{Mode::kDynamicsOnly};
  std::string link{"base_link"};
  /// Vehicle, seed; the rest is of the whole loop: mission, wind, faults.
  FlightChoice choice;
  std::string log_file;         ///< Whole loop: MCAP; empty: none.
  std::optional<Run> at_end;    ///< Whole loop; empty: the simulator runs on.
  std::string name_space{"/"};  ///< Dynamics only: of the ROS node.
  std::chrono::nanoseconds max_gap{std::chrono::milliseconds(100)};
  std::chrono::nanoseconds wait{std::chrono::milliseconds(100)};
};

/// @throws config::Error  one line: a name that is none, one that is of the other mode, a value that is not allowed.
PluginOptions read_plugin_options(const PluginElements& elements);

}  // namespace rosflight::flight::gazebo
