// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/parameter.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

/// How a node is made.
class NodeOptions {
 public:
  Context::SharedPtr context() const { return context_; }
  NodeOptions& context(Context::SharedPtr context) {
    context_ = std::move(context);
    return *this;
  }
  const std::vector<std::string>& arguments() const { return arguments_; }
  NodeOptions& arguments(const std::vector<std::string>& words) {
    arguments_ = words;
    return *this;
  }
  std::vector<Parameter>& parameter_overrides() { return overrides_; }
  const std::vector<Parameter>& parameter_overrides() const { return overrides_; }
  NodeOptions& parameter_overrides(const std::vector<Parameter>& overrides) {
    overrides_ = overrides;
    return *this;
  }
  template <typename T>
  NodeOptions& append_parameter_override(const std::string& name, const T& value) {
    overrides_.emplace_back(name, ParameterValue(value));
    return *this;
  }

  bool use_global_arguments() const { return use_global_arguments_; }
  NodeOptions& use_global_arguments(bool on) { return set(use_global_arguments_, on); }
  bool enable_rosout() const { return enable_rosout_; }
  NodeOptions& enable_rosout(bool on) { return set(enable_rosout_, on); }
  bool use_intra_process_comms() const { return use_intra_process_comms_; }
  NodeOptions& use_intra_process_comms(bool on) { return set(use_intra_process_comms_, on); }
  bool start_parameter_services() const { return start_parameter_services_; }
  NodeOptions& start_parameter_services(bool on) { return set(start_parameter_services_, on); }
  bool start_parameter_event_publisher() const { return start_parameter_event_publisher_; }
  NodeOptions& start_parameter_event_publisher(bool on) {
    return set(start_parameter_event_publisher_, on);
  }
  bool use_clock_thread() const { return use_clock_thread_; }
  NodeOptions& use_clock_thread(bool on) { return set(use_clock_thread_, on); }
  bool allow_undeclared_parameters() const { return allow_undeclared_parameters_; }
  NodeOptions& allow_undeclared_parameters(bool on) {
    return set(allow_undeclared_parameters_, on);
  }
  bool automatically_declare_parameters_from_overrides() const { return automatically_declare_; }
  NodeOptions& automatically_declare_parameters_from_overrides(bool on) {
    return set(automatically_declare_, on);
  }
  const QoS& clock_qos() const { return clock_qos_; }
  NodeOptions& clock_qos(const QoS& qos) {
    clock_qos_ = qos;
    return *this;
  }
  const QoS& rosout_qos() const { return rosout_qos_; }
  NodeOptions& rosout_qos(const QoS& qos) {
    rosout_qos_ = qos;
    return *this;
  }
  const QoS& parameter_event_qos() const { return parameter_event_qos_; }
  NodeOptions& parameter_event_qos(const QoS& qos) {
    parameter_event_qos_ = qos;
    return *this;
  }

 private:
  NodeOptions& set(bool& option, bool on) {
    option = on;
    return *this;
  }
  Context::SharedPtr context_{contexts::get_global_default_context()};
  std::vector<std::string> arguments_;
  std::vector<Parameter> overrides_;
  bool use_global_arguments_{true};
  bool enable_rosout_{true};
  bool use_intra_process_comms_{false};
  bool start_parameter_services_{true};
  bool start_parameter_event_publisher_{true};
  bool use_clock_thread_{true};
  bool allow_undeclared_parameters_{false};
  bool automatically_declare_{false};
  QoS clock_qos_{ClockQoS()};
  QoS rosout_qos_{RosoutQoS()};
  QoS parameter_event_qos_{ParameterEventsQoS()};
};

}  // namespace rclcpp
