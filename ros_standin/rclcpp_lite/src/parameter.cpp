// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/parameter.hpp"

#include <sstream>

namespace rclcpp {

std::string to_string(ParameterType type) {
  switch (type) {
    case PARAMETER_NOT_SET:
      return "not set";
    case PARAMETER_BOOL:
      return "bool";
    case PARAMETER_INTEGER:
      return "integer";
    case PARAMETER_DOUBLE:
      return "double";
    case PARAMETER_STRING:
      return "string";
    case PARAMETER_BYTE_ARRAY:
      return "byte_array";
    case PARAMETER_BOOL_ARRAY:
      return "bool_array";
    case PARAMETER_INTEGER_ARRAY:
      return "integer_array";
    case PARAMETER_DOUBLE_ARRAY:
      return "double_array";
    case PARAMETER_STRING_ARRAY:
      return "string_array";
  }
  return "unknown type";
}

std::ostream& operator<<(std::ostream& out, ParameterType type) {
  return out << to_string(type);
}

namespace {
template <typename Values>
std::string listed(const Values& values) {
  std::ostringstream text;
  text << std::boolalpha << '[';
  const char* separator = "";
  for (const auto& value : values) {
    text << separator;
    if constexpr (std::is_same_v<typename Values::value_type, std::uint8_t>) {
      text << static_cast<int>(value);
    } else {
      text << value;
    }
    separator = ", ";
  }
  text << ']';
  return text.str();
}
}  // namespace

std::string to_string(const ParameterValue& value) {
  const auto& held = value.to_value_msg();
  switch (value.get_type()) {
    case PARAMETER_NOT_SET:
      return "not set";
    case PARAMETER_BOOL:
      return held.bool_value ? "true" : "false";
    case PARAMETER_INTEGER:
      return std::to_string(held.integer_value);
    case PARAMETER_DOUBLE:
      return std::to_string(held.double_value);
    case PARAMETER_STRING:
      return held.string_value;
    case PARAMETER_BYTE_ARRAY:
      return listed(held.byte_array_value);
    case PARAMETER_BOOL_ARRAY:
      return listed(held.bool_array_value);
    case PARAMETER_INTEGER_ARRAY:
      return listed(held.integer_array_value);
    case PARAMETER_DOUBLE_ARRAY:
      return listed(held.double_array_value);
    case PARAMETER_STRING_ARRAY:
      return listed(held.string_array_value);
  }
  return "unknown type";
}

rcl_interfaces::msg::Parameter Parameter::to_parameter_msg() const {
  rcl_interfaces::msg::Parameter message;
  message.name = name_;
  message.value = value_.to_value_msg();
  return message;
}

std::string to_string(const Parameter& parameter) {
  return parameter.get_name() + ": " + parameter.value_to_string();
}

}  // namespace rclcpp
