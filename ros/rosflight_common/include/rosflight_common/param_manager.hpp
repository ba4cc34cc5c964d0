// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <variant>
#include <vector>

#include "rosflight_common/due.hpp"

namespace rosflight_common {

/// Parameters of a node by name: declared once, then read at any rate without a call of rclcpp. The functions have the names
/// of ROSflight 2.x.
///
/// A getter throws std::runtime_error if the name was not declared, or was declared as another type. Compiles as C++17.
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

  /// The setters log an error if the name was not declared.
  void set_double(const std::string& name, double value) { set({name, value}); }
  void set_bool(const std::string& name, bool value) { set({name, value}); }
  void set_int(const std::string& name, std::int64_t value) { set({name, value}); }
  void set_string(const std::string& name, const std::string& value) { set({name, value}); }

  /// Does nothing, because a declared parameter has its value from the start. Kept for code written for ROSflight 2.x.
  void set_parameters() {}

  /// Stores the values of a request; names that were not declared here are skipped.
  /// @returns false if a number is NaN or infinite; nothing is stored then.
  bool set_parameters_callback(const std::vector<rclcpp::Parameter>& parameters);

  /// Stores changes while the node runs and calls `changed` after each. A number that is not finite is refused, and so is a
  /// request for which `changed` throws. Keep the handle.
  Handle watch(std::function<void()> changed);

  /// Declares the rate of `due` as the parameter `name` [Hz], at least `min_Hz`, and follows its changes. Keep the handle.
  Handle declare_rate(const std::string& name, double rate_Hz, double min_Hz, Due& due);

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
    const T* const value = std::get_if<T>(&value_of(name));
    if (value == nullptr) wrong_type(name, type);
    return *value;
  }

  const Value& value_of(const std::string& name) const;
  [[noreturn]] static void wrong_type(const std::string& name, const char* type);
  void set(const rclcpp::Parameter& parameter);

  rclcpp::Node* node_;
  std::map<std::string, Value> values_;
  bool declaring_{false};
};

}  // namespace rosflight_common
