// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sim/vehicle.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// A parameter of ROSflight 2.x as a view of the vehicle: one number, or a list of them.
struct VehicleView {
  enum class Kind { kNumber, kNumbers, kSwitch, kWholes };

  std::string name;
  Kind kind{Kind::kNumber};
  double min{};
  double max{};
  std::string text;
  bool live{true};
  std::function<std::vector<double>(const sim::Vehicle&)> get;  ///< What the vehicle file says.
};

using ViewValues = std::map<std::string, std::vector<double>>;

/// Loaded by ROSflight 2.x and without effect there, so its parameter files have values that no aircraft flies with, such as a
/// stall at 3 degrees. They act here, but not from such a file.
inline bool idle_in_rosflight_2(const std::string& name) {
  return name == "wing_M" || name == "wing_alpha0" || name == "wing_epsilon";
}

/// Views of one node, and how values that differ from the file go back: as assignments
/// "section.key=value", which the vehicle checks like the file itself.
struct VehicleViews {
  std::vector<VehicleView> list;
  /// @param all      value of every view. @param changed  names of those that are not the file's.
  std::function<std::vector<std::string>(const ViewValues& all,
                                         const std::set<std::string>& changed)>
      assignments;
};

/// Mass, inertia, gravity, wind and gusts.
VehicleViews dynamics_views();

/// Rotors, motors, propellers and drag of a vehicle of type multirotor.
VehicleViews multirotor_views();

/// Airframe, motor, propeller and servos of a vehicle of type fixedwing.
VehicleViews fixedwing_views();

}  // namespace rosflight_sim
