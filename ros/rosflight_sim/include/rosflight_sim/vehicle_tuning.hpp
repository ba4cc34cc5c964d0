// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_sim/vehicle_parameters.hpp"
#include "rosflight_sim/vehicle_views.hpp"

namespace rosflight_sim {

namespace config = rosflight::config;

/// Parameters of ROSflight 2.x on top of the vehicle file: the file gives their defaults; a value
/// from the command line, a parameter file or a running node makes the vehicle again.
class VehicleTuning {
 public:
  /// Declares the parameters. `parameters.vehicle` has afterwards what was given.
  /// @param changed  called after every change while the node runs; a config::Error it throws refuses the change, and
  ///                 then it has changed nothing. Keep this as long as the node.
  /// @throws config::Error  as a vehicle file with such a value would.
  VehicleTuning(rclcpp::Node& node, VehicleViews views, VehicleParameters& parameters,
                std::function<void()> changed)
      : views_{std::move(views)}, parameters_{parameters}, changed_{std::move(changed)} {
    const auto defaults = parameters_.values_for(node.get_name());
    for (const VehicleView& view : views_.list) {
      const auto from_file = view.get(parameters_.vehicle);
      const bool ask = defaults && !idle_in_rosflight_2(view.name);
      const auto usual =
          ask ? defaults(view.name, given_kind(view, from_file.size())) : std::nullopt;
      values_[view.name] = declare(node, view, usual.value_or(from_file));
      if (values_[view.name] != from_file) differing_.insert(view.name);
    }
    parameters_.log_unused(node);
    if (!differing_.empty()) parameters_.make(views_.assignments(values_, differing_));
    handle_ = rosflight_common::on_change_or_refuse(
        node, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
  }

 private:
  using Kind = VehicleView::Kind;
  using Values = std::vector<double>;

  static rosflight_common::GivenKind given_kind(const VehicleView& view, std::size_t count) {
    using rosflight_common::GivenKind;
    if (view.kind == Kind::kSwitch) return GivenKind::kSwitch;
    const bool one = view.kind == Kind::kNumber || (view.kind == Kind::kWholes && count == 1);
    return one ? GivenKind::kNumber : GivenKind::kNumbers;
  }

  static Values declare(rclcpp::Node& node, const VehicleView& view, const Values& value) {
    if (view.kind == Kind::kNumber)
      return {rosflight_common::declare_number(node, view.name, value[0], view.min, view.max,
                                               view.text, view.live)};
    const auto descriptor = rosflight_common::described(view.text, !view.live);
    if (view.kind == Kind::kSwitch)
      return {node.declare_parameter<bool>(view.name, value[0] != 0.0, descriptor) ? 1.0 : 0.0};
    if (view.kind == Kind::kNumbers)
      return node.declare_parameter<Values>(view.name, value, descriptor);
    if (value.size() == 1)
      return {static_cast<double>(node.declare_parameter<std::int64_t>(
          view.name, static_cast<std::int64_t>(value[0]), descriptor))};
    const auto whole = node.declare_parameter<std::vector<std::int64_t>>(
        view.name, std::vector<std::int64_t>(value.begin(), value.end()), descriptor);
    return Values(whole.begin(), whole.end());
  }

  /// @returns why not, or nothing.
  std::string change(const std::vector<rclcpp::Parameter>& given) {
    ViewValues values = values_;
    std::set<std::string> differing = differing_;
    for (const auto& parameter : given) {
      if (values.count(parameter.get_name()) == 0) continue;
      values[parameter.get_name()] = read(parameter);
      differing.insert(parameter.get_name());
    }
    if (values == values_) return "";
    const sim::Vehicle before = parameters_.vehicle;
    try {
      parameters_.make(views_.assignments(values, differing));
      changed_();
    } catch (const config::Error& why) {
      parameters_.vehicle = before;
      return why.what();
    }
    values_ = std::move(values);
    differing_ = std::move(differing);
    return "";
  }

  static Values read(const rclcpp::Parameter& parameter) {
    switch (parameter.get_type()) {
      case rclcpp::ParameterType::PARAMETER_DOUBLE:
        return {parameter.as_double()};
      case rclcpp::ParameterType::PARAMETER_BOOL:
        return {parameter.as_bool() ? 1.0 : 0.0};
      default:
        return parameter.as_double_array();
    }
  }

  VehicleViews views_;
  VehicleParameters& parameters_;
  std::function<void()> changed_;
  ViewValues values_;
  std::set<std::string> differing_;  ///< Names of values that are not the file's.
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr handle_;
};

}  // namespace rosflight_sim
