// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl_interfaces/msg/parameter.hpp>
#include <string>
#include <vector>

#include "rclcpp/exceptions.hpp"
#include "rclcpp/parameter_value.hpp"

namespace rclcpp {

/// A name and a value.
class Parameter {
  // First, since what follows takes its return type.
  template <typename Get>
  decltype(auto) guarded(Get get) const {
    try {
      return get();
    } catch (const ParameterTypeException& error) {
      throw exceptions::InvalidParameterTypeException(name_, error.what());
    }
  }

 public:
  Parameter() = default;
  explicit Parameter(const std::string& name) : name_(name) {}
  Parameter(const std::string& name, const ParameterValue& value) : name_(name), value_(value) {}
  template <typename T>
  Parameter(const std::string& name, T value) : Parameter(name, ParameterValue(value)) {}

  static Parameter from_parameter_msg(const rcl_interfaces::msg::Parameter& message) {
    return {message.name, ParameterValue(message.value)};
  }
  rcl_interfaces::msg::Parameter to_parameter_msg() const;

  const std::string& get_name() const { return name_; }
  ParameterType get_type() const { return value_.get_type(); }
  std::string get_type_name() const { return to_string(get_type()); }
  const ParameterValue& get_parameter_value() const { return value_; }
  rcl_interfaces::msg::ParameterValue get_value_message() const { return value_.to_value_msg(); }
  bool operator==(const Parameter& other) const {
    return name_ == other.name_ && value_ == other.value_;
  }
  bool operator!=(const Parameter& other) const { return !(*this == other); }

  /// Throws exceptions::InvalidParameterTypeException for another type than the value's.
  template <typename T>
  decltype(auto) get_value() const {
    return guarded([this]() -> decltype(auto) { return value_.get<T>(); });
  }
  template <ParameterType kType>
  decltype(auto) get_value() const {
    return guarded([this]() -> decltype(auto) { return value_.get<kType>(); });
  }
  bool as_bool() const { return get_value<PARAMETER_BOOL>(); }
  std::int64_t as_int() const { return get_value<PARAMETER_INTEGER>(); }
  double as_double() const { return get_value<PARAMETER_DOUBLE>(); }
  const std::string& as_string() const { return get_value<PARAMETER_STRING>(); }
  const std::vector<std::uint8_t>& as_byte_array() const {
    return get_value<PARAMETER_BYTE_ARRAY>();
  }
  const std::vector<bool>& as_bool_array() const { return get_value<PARAMETER_BOOL_ARRAY>(); }
  const std::vector<std::int64_t>& as_integer_array() const {
    return get_value<PARAMETER_INTEGER_ARRAY>();
  }
  const std::vector<double>& as_double_array() const { return get_value<PARAMETER_DOUBLE_ARRAY>(); }
  const std::vector<std::string>& as_string_array() const {
    return get_value<PARAMETER_STRING_ARRAY>();
  }
  std::string value_to_string() const { return to_string(value_); }

 private:
  std::string name_;
  ParameterValue value_;
};

std::string to_string(const Parameter& parameter);

}  // namespace rclcpp
