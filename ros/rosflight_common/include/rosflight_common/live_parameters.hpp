// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/table.hpp"
#include "rosflight_common/given_values.hpp"
#include "rosflight_common/node_tools.hpp"

namespace rosflight_common {

namespace config = rosflight::config;

/// Parameters over a configuration, which gives their defaults; changes are taken while the node
/// runs, all of one request or none.
///
/// A value that is not given leaves the configuration as it is, to the bit.
template <class Config>
class LiveParameters {
 public:
  /// Takes a configuration into use, or says why not, and then nothing may have changed.
  using Apply = std::function<std::string(const Config&)>;

  /// Declares the rows of `table` (numbers and switches); `config` has afterwards what was given. Keep this as long as the
  /// node. @throws what rclcpp throws for a value of the wrong type or out of range.
  /// @param defaults  in place of those of the configuration.
  LiveParameters(rclcpp::Node& node, const config::Table<Config>& table, Config& config,
                 const GivenValues& defaults = {})
      : parameters_{table.parameters()}, config_{config} {
    for (const Parameter& parameter : parameters_) {
      const double present = parameter.get(config)[0];
      const double value = declare(node, parameter, usual(parameter, defaults).value_or(present));
      if (value != present) parameter.set(config, {value});
    }
    handle_ = on_change_or_refuse(
        node, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
  }

  /// From now on changes go through `apply`; before, none can come.
  void on_change(Apply apply) { apply_ = std::move(apply); }

 private:
  using Parameter = config::Parameter<Config>;

  static bool is_switch(const Parameter& parameter) {
    return parameter.row.kind == config::detail::Row::Kind::kBoolean;
  }

  static std::optional<double> usual(const Parameter& parameter, const GivenValues& defaults) {
    if (!defaults) return {};
    const auto value = defaults(std::string(parameter.row.key),
                                is_switch(parameter) ? GivenKind::kSwitch : GivenKind::kNumber);
    return value ? std::optional<double>((*value)[0]) : std::nullopt;
  }

  static double declare(rclcpp::Node& node, const Parameter& parameter, double usual) {
    const auto& row = parameter.row;
    std::string text(row.text);
    if (!row.unit.empty()) text += (text.empty() ? "[" : " [") + std::string(row.unit) + "]";
    if (is_switch(parameter)) {
      return node.declare_parameter<bool>(row.key, usual != 0.0, described(text, false)) ? 1.0
                                                                                         : 0.0;
    }
    return declare_number(node, row.key, usual, row.allowed.low, row.allowed.high, text, true);
  }

  std::string change(const std::vector<rclcpp::Parameter>& given) {
    Config wanted = config_;
    bool any = false;
    for (const rclcpp::Parameter& value : given) {
      for (const Parameter& parameter : parameters_) {
        if (parameter.row.key != value.get_name()) continue;
        const double number =
            is_switch(parameter) ? (value.as_bool() ? 1.0 : 0.0) : value.as_double();
        parameter.set(wanted, {number});
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

/// kp, ki, kd under `prefix` + "_kp", ... of the gains that `member` finds in a configuration.
template <class Config, class Member>
config::Row<Config> gains_row(const std::string& prefix, Member member, config::Unit unit,
                              config::Range allowed, std::string_view text) {
  using Gains = typename config::Row<Config>::template MemberOf<Member>;
  return {"", member,
          config::Table<Gains>{{prefix + "_kp", &Gains::kp, unit, allowed, text},
                               {prefix + "_ki", &Gains::ki, unit, allowed, text},
                               {prefix + "_kd", &Gains::kd, unit, allowed, text}}};
}

}  // namespace rosflight_common
