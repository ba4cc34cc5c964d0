// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the command line and of its files, for one node.
#include <rcl/arguments.h>
#include <rcl/context.h>
#include <rcl/node.h>
#include <rcl/node_options.h>
#include <rcl_yaml_param_parser/parser.h>

#include <string_view>

#include "node_parameters.hpp"
#include "rcl_call.hpp"

namespace rclcpp::detail {

namespace {
/// Does a pattern of a parameter file mean this node? Parts between slashes are compared: * is any
/// one part, ** any number of them.
bool matches(std::string_view pattern, std::string_view name) {
  while (!pattern.empty() && pattern.front() == '/') pattern.remove_prefix(1);
  while (!name.empty() && name.front() == '/') name.remove_prefix(1);
  if (pattern.empty()) return name.empty();
  const auto part = pattern.substr(0, pattern.find('/'));
  const auto rest = pattern.substr(part.size());
  const auto name_part = name.substr(0, name.find('/'));
  const auto name_rest = name.substr(name_part.size());
  if (part == "**") return matches(rest, name) || (!name.empty() && matches(pattern, name_rest));
  return !name.empty() && (part == "*" || part == name_part) && matches(rest, name_rest);
}

template <typename T, typename Array>
ParameterValue vector_of(const Array& array) {
  return ParameterValue(std::vector<T>(array.values, array.values + array.size));
}

ParameterValue value_of(const rcl_variant_t& variant) {
  if (variant.bool_value != nullptr) return ParameterValue(*variant.bool_value);
  if (variant.integer_value != nullptr) return ParameterValue(*variant.integer_value);
  if (variant.double_value != nullptr) return ParameterValue(*variant.double_value);
  if (variant.string_value != nullptr) return ParameterValue(std::string(variant.string_value));
  if (variant.byte_array_value != nullptr) {
    return vector_of<std::uint8_t>(*variant.byte_array_value);
  }
  if (variant.bool_array_value != nullptr) return vector_of<bool>(*variant.bool_array_value);
  if (variant.integer_array_value != nullptr) {
    return vector_of<std::int64_t>(*variant.integer_array_value);
  }
  if (variant.double_array_value != nullptr) return vector_of<double>(*variant.double_array_value);
  if (variant.string_array_value != nullptr) {
    const auto& array = *variant.string_array_value;
    return ParameterValue(std::vector<std::string>(array.data, array.data + array.size));
  }
  return ParameterValue();
}

void add(const rcl_arguments_t& arguments, const std::string& node,
         std::map<std::string, ParameterValue>& found) {
  rcl_params_t* given = nullptr;
  check(rcl_arguments_get_param_overrides(&arguments, &given), "read parameters");
  if (given == nullptr) return;
  const std::unique_ptr<rcl_params_t, void (*)(rcl_params_t*)> owner(given,
                                                                     rcl_yaml_node_struct_fini);
  for (std::size_t i = 0; i < given->num_nodes; ++i) {
    if (!matches(given->node_names[i], node)) continue;
    const auto& parameters = given->params[i];
    for (std::size_t j = 0; j < parameters.num_params; ++j) {
      found[parameters.parameter_names[j]] = value_of(parameters.parameter_values[j]);
    }
  }
}
}  // namespace

std::map<std::string, ParameterValue> parameter_overrides(const rcl_node_t& node,
                                                          const rcl_context_t& context,
                                                          const NodeOptions& options) {
  std::map<std::string, ParameterValue> found;
  const std::string name = rcl_node_get_fully_qualified_name(&node);
  if (options.use_global_arguments()) add(context.global_arguments, name, found);
  add(rcl_node_get_options(&node)->arguments, name, found);
  for (const auto& parameter : options.parameter_overrides()) {
    found[parameter.get_name()] = parameter.get_parameter_value();
  }
  return found;
}

}  // namespace rclcpp::detail
