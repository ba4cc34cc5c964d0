// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <map>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

#include "ros/common/node_tools.hpp"

namespace rosflight::ros_common {

/// A parameter over a setting of a configuration, in the unit of its name: the setters convert. A
/// switch is a number that is not 0.
template <class Config>
struct LiveParameter {
  std::string name;
  double least;
  double most;
  std::string text;
  std::function<double(const Config&)> get;
  std::function<void(Config&, double)> set;
  bool is_switch{false};
};

/// Parameters over a configuration, which gives their defaults; changes are taken while the node
/// runs, all of one request or none.
///
/// A value that is not given leaves the configuration as it is, to the bit.
template <class Config>
class LiveParameters {
 public:
  using Parameter = LiveParameter<Config>;
  /// Takes a configuration into use, or says why not, and then nothing may have changed.
  using Apply = std::function<std::string(const Config&)>;

  /// Declares the parameters; `config` has afterwards what was given. Keep this as long as the
  /// node. @throws what rclcpp throws for a value of the wrong type or out of range.
  LiveParameters(rclcpp::Node& node, std::vector<Parameter> parameters, Config& config)
      : parameters_{std::move(parameters)}, config_{config} {
    for (const Parameter& parameter : parameters_) {
      const double usual = parameter.get(config);
      const double value = declare(node, parameter, usual);
      if (value != usual) parameter.set(config, value);
    }
    handle_ = on_change_or_refuse(
        node, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
  }

  /// From now on changes go through `apply`; before, none can come.
  void on_change(Apply apply) { apply_ = std::move(apply); }

 private:
  static double declare(rclcpp::Node& node, const Parameter& parameter, double usual) {
    if (parameter.is_switch) {
      return node.declare_parameter<bool>(parameter.name, usual != 0.0,
                                          described(parameter.text, false))
                 ? 1.0
                 : 0.0;
    }
    return declare_number(node, parameter.name, usual, parameter.least, parameter.most,
                          parameter.text, true);
  }

  std::string change(const std::vector<rclcpp::Parameter>& given) {
    Config wanted = config_;
    bool any = false;
    for (const rclcpp::Parameter& value : given) {
      for (const Parameter& parameter : parameters_) {
        if (parameter.name != value.get_name()) continue;
        parameter.set(wanted,
                      parameter.is_switch ? (value.as_bool() ? 1.0 : 0.0) : value.as_double());
        any = true;
      }
    }
    if (!any) return "";
    if (apply_) {
      std::string why = apply_(wanted);
      if (!why.empty()) return why;
    }
    config_ = std::move(wanted);
    return "";
  }

  std::vector<Parameter> parameters_;
  Config& config_;
  Apply apply_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr handle_;
};

/// kp, ki, kd under `prefix` + "_kp", ... of the gains that `of` finds in a configuration, times
/// `unit` as parameters.
template <class Config, class Of>
void add_gains(std::vector<LiveParameter<Config>>& list, const std::string& prefix,
               const std::string& text, double unit, Of of) {
  constexpr double kMost = 1000.0;
  const auto add = [&](const char* suffix, auto member) {
    list.push_back({prefix + suffix, -kMost, kMost, text,
                    [of, member, unit](const Config& c) { return unit * (of(c).*member); },
                    [of, member, unit](Config& c, double value) { of(c).*member = value / unit; }});
  };
  using Gains = std::remove_cvref_t<decltype(of(std::declval<Config&>()))>;
  add("_kp", &Gains::kp);
  add("_ki", &Gains::ki);
  add("_kd", &Gains::kd);
}

}  // namespace rosflight::ros_common
