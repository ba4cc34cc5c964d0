// SPDX-License-Identifier: BSD-3-Clause
#include "ground/parameter_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace rosflight::ground {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr ParameterInfo kInfos[] = {
#include "ground/parameter_rows.inc"  // made from firmware/core/parameters.csv at build time
};

std::string short_number(double value) {
  return fmt::format("{:g}", value);
}

}  // namespace

companion::ParameterValue ParameterInfo::default_value() const {
  using companion::ParameterValue;
  return type == link::ParamType::kInt32 ? ParameterValue::of(static_cast<std::int32_t>(initial))
                                         : ParameterValue::of(static_cast<float>(initial));
}

std::string ParameterInfo::allowed() const {
  const bool apart = sentinel < min || sentinel > max;
  return (apart ? short_number(sentinel) + ", " : "") + short_number(min) + " .. " +
         short_number(max);
}

std::span<const ParameterInfo> parameter_infos() {
  return kInfos;
}

const ParameterInfo* find_parameter_info(std::string_view name) {
  const auto* const found = std::find_if(std::begin(kInfos), std::end(kInfos),
                                         [name](const ParameterInfo& i) { return i.name == name; });
  return found == std::end(kInfos) ? nullptr : found;
}

}  // namespace rosflight::ground
