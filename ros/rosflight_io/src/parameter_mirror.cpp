// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/parameter_mirror.hpp"

#include <chrono>
#include <cstdlib>
#include <exception>
#include <future>
#include <memory>
#include <utility>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_io/parameter_descriptor.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;
using companion::NamedValue;
using companion::ParameterValue;
using rosflight::link::ParamType;

namespace {

/// A float as the number a person would write: 0.1, not 0.100000001490116.
rclcpp::ParameterValue to_ros(const ParameterValue& value) {
  if (value.type == ParamType::kInt32)
    return rclcpp::ParameterValue(std::int64_t{value.as_int32()});
  return rclcpp::ParameterValue(std::strtod(value.text().c_str(), nullptr));
}

bool same(const rclcpp::Parameter& ros, const ParameterValue& firmware) {
  if (ros.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER) {
    return firmware.type == ParamType::kInt32 && ros.as_int() == firmware.as_int32();
  }
  return ros.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE &&
         firmware.type == ParamType::kFloat &&
         companion::same_value(ParameterValue::of(static_cast<float>(ros.as_double())), firmware);
}

}  // namespace

ParameterMirror::ParameterMirror(rclcpp::Node& node, companion::Runner& runner)
    : node_{node}, runner_{runner} {
  handle_ = node.add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter>& parameters) { return on_set(parameters); });
}

void ParameterMirror::on_event(const companion::Event& event) {
  const auto& client = runner_.session().parameters();
  if (const auto* list = std::get_if<companion::ParameterListEvent>(&event)) {
    if (!list->complete) return;
    const std::lock_guard lock(mutex_);
    news_ = client.table().values();
  } else if (const auto* one = std::get_if<companion::ParameterEvent>(&event)) {
    if (!client.complete()) return;
    const std::lock_guard lock(mutex_);
    news_.push_back({std::string(companion::text_of(one->name)), {one->type, one->value}});
  }
}

void ParameterMirror::update() {
  Set news;
  {
    const std::lock_guard lock(mutex_);
    news = std::exchange(news_, {});
  }
  mirroring_ = true;
  for (const NamedValue& entry : news) mirror(entry);
  mirroring_ = false;
}

void ParameterMirror::mirror(const NamedValue& entry) {
  if (known_.insert(entry.name).second && !node_.has_parameter(entry.name)) {
    const std::string refusal = declare(entry);
    if (refusal.empty()) return;
    RCLCPP_ERROR(node_.get_logger(), "%s", refusal.c_str());
  }
  if (same(node_.get_parameter(entry.name), entry.value)) return;
  const auto result = node_.set_parameter(rclcpp::Parameter(entry.name, to_ros(entry.value)));
  if (!result.successful) {
    RCLCPP_WARN(node_.get_logger(), "%s: the firmware has %s, the ROS parameter does not: %s",
                entry.name.c_str(), entry.value.text().c_str(), result.reason.c_str());
  }
}

std::string ParameterMirror::declare(const NamedValue& entry) {
  const rclcpp::ParameterValue present = to_ros(entry.value);
  const auto descriptor = describe_parameter(entry.name, entry.value);
  try {
    // A value from a file or the command line is a wish: it goes to the firmware, not over it.
    const rclcpp::Parameter wish(entry.name,
                                 node_.declare_parameter(entry.name, present, descriptor));
    return same(wish, entry.value) ? "" : send(wish);
  } catch (const std::exception& why) {  // a wish out of range or of another type
    node_.declare_parameter(entry.name, present, descriptor, true);
    return entry.name + ": " + rosflight_common::one_line(why.what());
  }
}

rcl_interfaces::msg::SetParametersResult ParameterMirror::on_set(
    const std::vector<rclcpp::Parameter>& parameters) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  if (mirroring_) return result;
  for (const rclcpp::Parameter& parameter : parameters) {
    if (known_.count(parameter.get_name()) == 0) continue;
    result.reason = send(parameter);
    result.successful = result.reason.empty();
    if (!result.successful) {
      RCLCPP_ERROR(node_.get_logger(), "%s", result.reason.c_str());
      break;
    }
  }
  return result;
}

std::string ParameterMirror::send(const rclcpp::Parameter& parameter) {
  const std::string& name = parameter.get_name();
  double number = 0.0;
  if (parameter.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER) {
    number = static_cast<double>(parameter.as_int());
  } else if (parameter.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE) {
    number = parameter.as_double();
  } else {
    return name + ": found " + parameter.get_type_name() + ", allowed a number";
  }
  using Result = companion::ParameterResult;
  const auto answer = std::make_shared<std::promise<Result>>();
  auto future = answer->get_future();
  runner_.post([name, number, answer](companion::Session& session) {
    companion::Job<Result> job = session.parameters().set(name, number);
    job.when_finished([job, answer] { answer->set_value(job.result()); });
  });
  constexpr std::chrono::seconds kMaxDelay{5};  // longer than the job's own
  if (future.wait_for(kMaxDelay) != std::future_status::ready) return name + ": no answer";
  const Result result = future.get();
  return result.ok() ? std::string() : result.text;
}

}  // namespace rosflight_io
