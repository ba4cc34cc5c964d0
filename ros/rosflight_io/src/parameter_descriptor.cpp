// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/parameter_descriptor.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "ground/parameter_info.hpp"

namespace rosflight_io {

namespace ground = rosflight::ground;
using rcl_interfaces::msg::ParameterDescriptor;
using rosflight::link::ParamType;

namespace {

constexpr double kMaxValue = std::numeric_limits<float>::max();  // what the link carries

void add_range(const ground::ParameterInfo& info, ParameterDescriptor& descriptor) {
  const double low = std::max(std::min(info.min, info.sentinel), -kMaxValue);
  const double high = std::min(std::max(info.max, info.sentinel), kMaxValue);
  if (info.type == ParamType::kInt32) {
    rcl_interfaces::msg::IntegerRange range;
    range.from_value = static_cast<std::int64_t>(low);
    range.to_value = static_cast<std::int64_t>(high);
    range.step = 1;
    descriptor.integer_range.push_back(range);
  } else {
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value = low;
    range.to_value = high;
    descriptor.floating_point_range.push_back(range);
  }
}

}  // namespace

ParameterDescriptor describe_parameter(const std::string& name,
                                       const rosflight::companion::ParameterValue& present) {
  ParameterDescriptor descriptor;
  const ground::ParameterInfo* const info = ground::find_parameter_info(name);
  if (info == nullptr || info->type != present.type) {
    descriptor.description = "parameter of a firmware that is not this project's";
    return descriptor;
  }
  descriptor.description = std::string(info->description);
  if (!info->unit.empty()) descriptor.description += " [" + std::string(info->unit) + "]";
  descriptor.additional_constraints = "allowed: " + info->allowed();
  if (info->allows(present.number())) add_range(*info, descriptor);
  return descriptor;
}

}  // namespace rosflight_io
