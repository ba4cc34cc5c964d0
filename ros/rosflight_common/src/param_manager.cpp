// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/param_manager.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_common {
namespace {

bool finite(const rclcpp::Parameter& parameter) {
  return parameter.get_type() != rclcpp::ParameterType::PARAMETER_DOUBLE ||
         std::isfinite(parameter.as_double());
}

}  // namespace

bool ParamManager::set_parameters_callback(const std::vector<rclcpp::Parameter>& parameters) {
  if (!std::all_of(parameters.begin(), parameters.end(), finite)) return false;
  for (const rclcpp::Parameter& parameter : parameters) {
    const auto found = values_.find(parameter.get_name());
    if (found == values_.end()) continue;
    switch (parameter.get_type()) {
      case rclcpp::ParameterType::PARAMETER_DOUBLE:
        found->second = parameter.as_double();
        break;
      case rclcpp::ParameterType::PARAMETER_BOOL:
        found->second = parameter.as_bool();
        break;
      case rclcpp::ParameterType::PARAMETER_INTEGER:
        found->second = parameter.as_int();
        break;
      default:
        found->second = parameter.as_string();
    }
  }
  return true;
}

ParamManager::Handle ParamManager::watch(std::function<void()> changed) {
  return on_change_or_refuse(*node_, [this, changed = std::move(changed)](
                                         const std::vector<rclcpp::Parameter>& parameters) {
    const auto before = values_;
    try {
      set_parameters_callback(parameters);
      if (!declaring_) changed();
    } catch (...) {
      values_ = before;
      throw;
    }
    return std::string{};
  });
}

ParamManager::Handle ParamManager::declare_rate(const std::string& name, double rate_Hz,
                                                double min_Hz, Due& due) {
  declare_double(name, rate_Hz);
  const auto follow = [this, name, min_Hz, &due] {
    due.set_rate(std::max(min_Hz, get_double(name)));
  };
  follow();
  return watch(follow);
}

const ParamManager::Value& ParamManager::value_of(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end())
    throw std::runtime_error("parameter " + name + ": not declared; call declare_*() first");
  return found->second;
}

void ParamManager::wrong_type(const std::string& name, const char* type) {
  throw std::runtime_error("parameter " + name + ": declared as another type, read as " + type);
}

void ParamManager::set(const rclcpp::Parameter& parameter) {
  if (values_.count(parameter.get_name()) == 0) {
    RCLCPP_ERROR(node_->get_logger(), "parameter %s: not declared, nothing set",
                 parameter.get_name().c_str());
    return;
  }
  node_->set_parameter(parameter);
}

}  // namespace rosflight_common
