// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <rcl_interfaces/msg/parameter_event.hpp>
#include <string>
#include <vector>

#include "rclcpp/node.hpp"

namespace rclcpp::detail {

class ParameterServices;

/// The parameters of one node: values, descriptors, callbacks that may refuse, and the event that is published.
class NodeParameters : public node_interfaces::NodeParametersInterface {
 public:
  using Descriptor = rcl_interfaces::msg::ParameterDescriptor;
  using Result = rcl_interfaces::msg::SetParametersResult;
  using Handle = node_interfaces::OnSetParametersCallbackHandle;

  NodeParameters(node_interfaces::NodeBaseInterface::SharedPtr base, Clock::SharedPtr clock,
                 const NodeOptions& options);
  ~NodeParameters() override;

  const ParameterValue& declare(const std::string& name, const ParameterValue& value,
                                ParameterType type, Descriptor descriptor, bool ignore_override);
  void undeclare(const std::string& name);
  bool has(const std::string& name) const;
  /// All or none. Throws ParameterNotDeclaredException.
  Result set(const std::vector<Parameter>& parameters);
  bool find(const std::string& name, Parameter& parameter) const;
  Parameter get(const std::string& name) const;
  Descriptor describe(const std::string& name) const;
  rcl_interfaces::msg::ListParametersResult list(const std::vector<std::string>& prefixes,
                                                 std::uint64_t depth) const;
  Handle::SharedPtr add_callback(Handle::OnSetParametersCallbackType callback);
  void remove_callback(const Handle* handle);
  const std::map<std::string, ParameterValue>& get_parameter_overrides() const override {
    return overrides_;
  }
  bool allows_undeclared() const { return allow_undeclared_; }
  /// Called with each parameter that has changed, by the thread that changed it.
  void on_change(std::function<void(const Parameter&)> watcher) { watcher_ = std::move(watcher); }

 private:
  struct Declared {
    ParameterValue value;
    Descriptor descriptor;
  };
  class InCallback;
  Result ask_callbacks(const std::vector<Parameter>& parameters);
  void must_not_be_in_callback() const;
  Result acceptable(const Parameter& parameter) const;
  void publish(rcl_interfaces::msg::ParameterEvent& event);

  node_interfaces::NodeBaseInterface::SharedPtr base_;
  Clock::SharedPtr clock_;
  bool allow_undeclared_;
  mutable std::recursive_mutex mutex_;
  bool in_callback_{false};
  std::map<std::string, Declared> declared_;
  std::map<std::string, ParameterValue> overrides_;
  std::list<Handle::WeakPtr> callbacks_;
  std::function<void(const Parameter&)> watcher_;
  Publisher<rcl_interfaces::msg::ParameterEvent>::SharedPtr events_;
  std::unique_ptr<ParameterServices> services_;
};

/// Why a value breaks the range of its descriptor; empty: it does not.
std::string out_of_range(const Parameter& parameter,
                         const rcl_interfaces::msg::ParameterDescriptor& descriptor);

/// What the command line, its files and the node's own arguments give to this node.
std::map<std::string, ParameterValue> parameter_overrides(const rcl_node_t& node,
                                                          const rcl_context_t& context,
                                                          const NodeOptions& options);

}  // namespace rclcpp::detail
