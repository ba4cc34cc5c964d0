// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "node_parameters.hpp"

namespace rclcpp::detail {

namespace {
template <typename Range, typename Value>
std::string allowed(const Parameter& parameter, const Range& range, Value step) {
  auto text = "parameter '" + parameter.get_name() + "' is " + parameter.value_to_string() +
              ", allowed: " + std::to_string(range.from_value) + " to " +
              std::to_string(range.to_value);
  if (step > Value{}) text += " in steps of " + std::to_string(step);
  return text;
}
}  // namespace

std::string out_of_range(const Parameter& parameter,
                         const rcl_interfaces::msg::ParameterDescriptor& descriptor) {
  if (!descriptor.integer_range.empty() && parameter.get_type() == PARAMETER_INTEGER) {
    const auto& range = descriptor.integer_range.front();
    const auto value = parameter.as_int();
    if (value == range.from_value || value == range.to_value) return {};
    const bool inside = value > range.from_value && value < range.to_value;
    // Unsigned, since the distance of two integers may not fit into a signed one.
    const auto from_start =
        static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(range.from_value);
    if (inside && (range.step == 0 || from_start % range.step == 0)) return {};
    return allowed(parameter, range, range.step);
  }
  if (!descriptor.floating_point_range.empty() && parameter.get_type() == PARAMETER_DOUBLE) {
    const auto& range = descriptor.floating_point_range.front();
    const double value = parameter.as_double();
    if (std::isnan(value) && range.step == 0.0) return {};  // as rclcpp: no comparison rejects it
    // Rounding of the numbers a person writes down, relative to their size.
    constexpr double kRounding = 1e-10;
    const auto near = [](double a, double b) {
      return std::fabs(a - b) <= kRounding * std::fmax(1.0, std::fmax(std::fabs(a), std::fabs(b)));
    };
    if (near(value, range.from_value) || near(value, range.to_value)) return {};
    const bool inside = value > range.from_value && value < range.to_value;
    if (inside && range.step <= 0.0) return {};
    const double steps = std::round((value - range.from_value) / range.step);
    if (inside && near(range.from_value + steps * range.step, value)) return {};
    return allowed(parameter, range, range.step);
  }
  return {};
}

}  // namespace rclcpp::detail
