// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "config/strict_yaml.hpp"
#include "rosflight_common/given_values.hpp"

namespace rosflight_sim {

namespace config = rosflight::config;

/// A ROS parameter file (NODE: {ros__parameters: {NAME: VALUE}}) in place of a vehicle file, as the simulator of ROSflight 2.x
/// takes one: values by the names of nodes, on top of one of our vehicles.
class ParameterFile {
 public:
  /// Nothing if no key at the top has `ros__parameters` below it: then it may be a vehicle file.
  /// @throws config::Error  it cannot be read or is no YAML.
  static std::optional<ParameterFile> load(const std::string& file);

  /// Type of the vehicle: fixedwing if there is a section fixedwing_forces_and_moments, else multirotor.
  const std::string& type() const { return type_; }

  /// The value of `name` for a node: of the last section that is the node's or for all. Remembers that it was asked for.
  /// @throws config::Error  it is there and of another kind.
  std::optional<std::vector<double>> value(const std::string& node, const std::string& name,
                                           rosflight_common::GivenKind kind);

  /// Names in the node's own sections that nobody asked for.
  std::vector<std::string> unused(const std::string& node) const;

 private:
  explicit ParameterFile(const config::Section& root);
  /// The name without its namespace; "**" and "*" are all nodes.
  struct Part {
    std::string node;
    config::Section parameters;
  };

  std::string type_{"multirotor"};
  std::vector<Part> parts_;
  std::set<std::string> asked_;
};

}  // namespace rosflight_sim
