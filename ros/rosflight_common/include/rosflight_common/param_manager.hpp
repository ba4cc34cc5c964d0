// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rosflight_common {

/// Parameters of a node by name: declared once, read as often as wanted without asking rclcpp. The names of its functions are those
/// of the ParamManager of ROSflight 2.x.
///
/// A getter of a name that was not declared, or was declared as another type, throws std::runtime_error with both.
/// Compiles as C++17.
class ParamManager {
 public:
  using Handle = rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr;

  explicit ParamManager(rclcpp::Node* node) : node_{node} {}

  void declare_double(const std::string& name, double value) { declare(name, value); }
  void declare_bool(const std::string& name, bool value) { declare(name, value); }
  void declare_int(const std::string& name, std::int64_t value) { declare(name, value); }
  void declare_string(const std::string& name, const std::string& value) { declare(name, value); }

  double get_double(const std::string& name) const { return get<double>(name, "double"); }
  bool get_bool(const std::string& name) const { return get<bool>(name, "bool"); }
  std::int64_t get_int(const std::string& name) const { return get<std::int64_t>(name, "int"); }
  std::string get_string(const std::string& name) const { return get<std::string>(name, "string"); }

  void set_double(const std::string& name, double value) { set(name, value); }
  void set_bool(const std::string& name, bool value) { set(name, value); }
  void set_int(const std::string& name, std::int64_t value) { set(name, value); }
  void set_string(const std::string& name, const std::string& value) { set(name, value); }

  /// Without effect: a declared parameter has its value from the start. Here for code written for ROSflight 2.x.
  void set_parameters() {}

  /// Takes the values of a request. False: one of them is a double that is not finite, and nothing has changed. Names that were not
  /// declared here are none of its business.
  bool set_parameters_callback(const std::vector<rclcpp::Parameter>& parameters) {
    for (const rclcpp::Parameter& parameter : parameters) {
      if (parameter.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE &&
          !std::isfinite(parameter.as_double()))
        return false;
    }
    for (const rclcpp::Parameter& parameter : parameters) {
      const auto found = values_.find(parameter.get_name());
      if (found != values_.end()) found->second = value_of(parameter);
    }
    return true;
  }

  /// Takes changes of the running node and calls `changed` after each. Keep what is returned.
  Handle watch(std::function<void()> changed) {
    return node_->add_on_set_parameters_callback(
        [this, changed = std::move(changed)](const std::vector<rclcpp::Parameter>& parameters) {
          rcl_interfaces::msg::SetParametersResult result;
          result.successful = set_parameters_callback(parameters);
          if (!result.successful) {
            result.reason = "found nan or infinity, allowed finite numbers";
          } else if (!declaring_) {
            changed();
          }
          return result;
        });
  }

 private:
  using Value = std::variant<double, bool, std::int64_t, std::string>;

  template <class T>
  void declare(const std::string& name, const T& value) {
    declaring_ = true;
    values_[name] = node_->declare_parameter<T>(name, value);
    declaring_ = false;
  }

  template <class T>
  T get(const std::string& name, const char* type) const {
    const auto found = values_.find(name);
    if (found == values_.end())
      throw std::runtime_error("parameter " + name + ": found none, allowed a declared one");
    const T* const value = std::get_if<T>(&found->second);
    if (value == nullptr)
      throw std::runtime_error("parameter " + name + ": found another type, asked for " + type);
    return *value;
  }

  template <class T>
  void set(const std::string& name, const T& value) {
    if (values_.count(name) == 0) {
      RCLCPP_ERROR(node_->get_logger(), "parameter %s: found none, allowed a declared one",
                   name.c_str());
      return;
    }
    node_->set_parameter(rclcpp::Parameter(name, value));
  }

  static Value value_of(const rclcpp::Parameter& parameter) {
    switch (parameter.get_type()) {
      case rclcpp::ParameterType::PARAMETER_DOUBLE:
        return parameter.as_double();
      case rclcpp::ParameterType::PARAMETER_BOOL:
        return parameter.as_bool();
      case rclcpp::ParameterType::PARAMETER_INTEGER:
        return parameter.as_int();
      default:
        return parameter.as_string();
    }
  }

  rclcpp::Node* node_;
  std::map<std::string, Value> values_;
  bool declaring_{false};
};

}  // namespace rosflight_common
