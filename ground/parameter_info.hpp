// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "companion/parameter.hpp"

namespace rosflight::ground {

/// What this project's firmware says about one of its parameters (firmware/core/parameters.csv). Other
/// firmwares may have other parameters.
struct ParameterInfo {
  std::string_view name;
  link::ParamType type{};
  double initial{};  ///< Default value.
  double min{};
  double max{};
  double sentinel{};  ///< One value outside the range that is allowed too; else the default.
  std::string_view unit;
  std::string_view description;

  companion::ParameterValue default_value() const;
  bool allows(double value) const { return (value >= min && value <= max) || value == sentinel; }
  /// "0 .. 1" or "-1, 4 .. 7".
  std::string allowed() const;
};

/// All parameters in the order of the link.
std::span<const ParameterInfo> parameter_infos();
/// Nothing if this project's firmware has no such parameter.
const ParameterInfo* find_parameter_info(std::string_view name);

}  // namespace rosflight::ground
