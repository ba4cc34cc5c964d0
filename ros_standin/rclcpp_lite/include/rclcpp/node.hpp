// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <rcl_interfaces/msg/list_parameters_result.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <string>
#include <vector>

#include "rclcpp/client.hpp"
#include "rclcpp/clock.hpp"
#include "rclcpp/generic_subscription.hpp"
#include "rclcpp/logger.hpp"
#include "rclcpp/node_interfaces/node_base_interface.hpp"
#include "rclcpp/node_interfaces/node_parameters_interface.hpp"
#include "rclcpp/node_options.hpp"
#include "rclcpp/parameter.hpp"
#include "rclcpp/publisher.hpp"
#include "rclcpp/qos.hpp"
#include "rclcpp/service.hpp"
#include "rclcpp/subscription.hpp"
#include "rclcpp/timer.hpp"

namespace rclcpp {

namespace detail {
class NodeParameters;
class TimeSource;
}  // namespace detail

namespace node_interfaces {
/// Refuses or accepts new values; stays in force as long as the node's user keeps it.
struct OnSetParametersCallbackHandle {
  RCLCPP_SMART_PTR_ALIASES_ONLY(OnSetParametersCallbackHandle)
  using OnSetParametersCallbackType =
      std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter>&)>;
  using OnParametersSetCallbackType = OnSetParametersCallbackType;
  OnSetParametersCallbackType callback;
};
}  // namespace node_interfaces

/// One node: publishers, subscriptions, services, clients, timers and parameters under one name.
///
/// Names are relative to the namespace, ~ is the node; remappings of the command line apply.
/// Creating throws exceptions::InvalidTopicNameError, InvalidServiceNameError or RCLError.
class Node : public std::enable_shared_from_this<Node> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Node)
  using OnSetParametersCallbackHandle = node_interfaces::OnSetParametersCallbackHandle;
  using OnParametersSetCallbackType = OnSetParametersCallbackHandle::OnSetParametersCallbackType;
  using OnSetParametersCallbackType = OnParametersSetCallbackType;
  using Descriptor = rcl_interfaces::msg::ParameterDescriptor;

  /// Throws exceptions::InvalidNodeNameError, InvalidNamespaceError, RCLError.
  explicit Node(const std::string& name, const NodeOptions& options = NodeOptions());
  Node(const std::string& name, const std::string& name_space,
       const NodeOptions& options = NodeOptions());
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  virtual ~Node();

  const char* get_name() const { return base_->get_name(); }
  const char* get_namespace() const { return base_->get_namespace(); }
  const char* get_fully_qualified_name() const { return base_->get_fully_qualified_name(); }
  const std::string& get_effective_namespace() const { return name_space_; }
  Logger get_logger() const { return logger_; }
  const NodeOptions& get_node_options() const { return options_; }
  node_interfaces::NodeBaseInterface::SharedPtr get_node_base_interface() { return base_; }
  node_interfaces::NodeParametersInterface::SharedPtr get_node_parameters_interface();

  CallbackGroup::SharedPtr create_callback_group(CallbackGroupType type,
                                                 bool automatically_add_to_executor = true);
  void for_each_callback_group(const std::function<void(CallbackGroup::SharedPtr)>& each) {
    for (const auto& weak : base_->callback_groups()) {
      if (auto group = weak.lock()) each(std::move(group));
    }
  }

  template <typename MessageT, typename AllocatorT = std::allocator<void>>
  std::shared_ptr<Publisher<MessageT>> create_publisher(
      const std::string& topic, const QoS& qos,
      const PublisherOptionsWithAllocator<AllocatorT>& options = {});

  template <typename MessageT, typename CallbackT, typename AllocatorT = std::allocator<void>>
  std::shared_ptr<Subscription<MessageT>> create_subscription(
      const std::string& topic, const QoS& qos, CallbackT&& callback,
      const SubscriptionOptionsWithAllocator<AllocatorT>& options = {});

  /// @param type  "package/msg/Name". Throws std::runtime_error if this machine has no such type.
  template <typename CallbackT, typename AllocatorT = std::allocator<void>>
  std::shared_ptr<GenericSubscription> create_generic_subscription(
      const std::string& topic, const std::string& type, const QoS& qos, CallbackT&& callback,
      const SubscriptionOptionsWithAllocator<AllocatorT>& options = {});

  // Humble takes an rmw_qos_profile_t in place of the QoS of the next two, so common code leaves it
  // to the default, or asks which one there is.
  template <typename ServiceT, typename CallbackT>
  typename Service<ServiceT>::SharedPtr create_service(const std::string& name,
                                                       CallbackT&& callback,
                                                       const QoS& qos = ServicesQoS(),
                                                       CallbackGroup::SharedPtr group = nullptr);

  template <typename ServiceT>
  typename Client<ServiceT>::SharedPtr create_client(const std::string& name,
                                                     const QoS& qos = ServicesQoS(),
                                                     CallbackGroup::SharedPtr group = nullptr);

  template <typename Rep, typename Period, typename CallbackT>
  typename WallTimer<std::decay_t<CallbackT>>::SharedPtr create_wall_timer(
      std::chrono::duration<Rep, Period> period, CallbackT callback,
      CallbackGroup::SharedPtr group = nullptr);

  // ---- parameters ----

  /// The value: of the command line or file, else of the options, else the default. Throws
  /// ParameterAlreadyDeclaredException, InvalidParameterTypeException,
  /// InvalidParameterValueException.
  const ParameterValue& declare_parameter(const std::string& name, const ParameterValue& value,
                                          const Descriptor& descriptor = Descriptor(),
                                          bool ignore_override = false);
  /// Declares a parameter without default: not set unless given.
  const ParameterValue& declare_parameter(const std::string& name, ParameterType type,
                                          const Descriptor& descriptor = Descriptor(),
                                          bool ignore_override = false);
  template <typename ParameterT>
  auto declare_parameter(const std::string& name, const ParameterT& value,
                         const Descriptor& descriptor = Descriptor(), bool ignore_override = false);
  template <typename ParameterT>
  auto declare_parameter(const std::string& name, const Descriptor& descriptor = Descriptor(),
                         bool ignore_override = false);
  template <typename ParameterT>
  std::vector<ParameterT> declare_parameters(const std::string& name_space,
                                             const std::map<std::string, ParameterT>& parameters,
                                             bool ignore_overrides = false);
  void undeclare_parameter(const std::string& name);
  bool has_parameter(const std::string& name) const;
  rcl_interfaces::msg::SetParametersResult set_parameter(const Parameter& parameter);
  std::vector<rcl_interfaces::msg::SetParametersResult> set_parameters(
      const std::vector<Parameter>& parameters);
  rcl_interfaces::msg::SetParametersResult set_parameters_atomically(
      const std::vector<Parameter>& parameters);
  /// Throws ParameterNotDeclaredException, ParameterUninitializedException.
  Parameter get_parameter(const std::string& name) const;
  bool get_parameter(const std::string& name, Parameter& parameter) const;
  template <typename ParameterT>
  bool get_parameter(const std::string& name, ParameterT& value) const;
  template <typename ParameterT>
  bool get_parameter_or(const std::string& name, ParameterT& value,
                        const ParameterT& alternative) const;
  template <typename ParameterT>
  ParameterT get_parameter_or(const std::string& name, const ParameterT& alternative) const;
  std::vector<Parameter> get_parameters(const std::vector<std::string>& names) const;
  template <typename ParameterT>
  bool get_parameters(const std::string& prefix, std::map<std::string, ParameterT>& values) const;
  Descriptor describe_parameter(const std::string& name) const;
  std::vector<Descriptor> describe_parameters(const std::vector<std::string>& names) const;
  std::vector<std::uint8_t> get_parameter_types(const std::vector<std::string>& names) const;
  rcl_interfaces::msg::ListParametersResult list_parameters(
      const std::vector<std::string>& prefixes, std::uint64_t depth) const;
  /// The newest callback is asked first. It ends when the returned handle is dropped.
  [[nodiscard]] OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      OnParametersSetCallbackType callback);
  void remove_on_set_parameters_callback(const OnSetParametersCallbackHandle* handler);

  // ---- graph and time ----

  std::vector<std::string> get_node_names() const;
  std::map<std::string, std::vector<std::string>> get_topic_names_and_types() const;
  std::map<std::string, std::vector<std::string>> get_service_names_and_types() const;
  std::size_t count_publishers(const std::string& topic) const;
  std::size_t count_subscribers(const std::string& topic) const;
  Clock::SharedPtr get_clock() { return clock_; }
  Clock::ConstSharedPtr get_clock() const { return clock_; }
  Time now() const { return clock_->now(); }

 private:
  CallbackGroup& group_or_default(const CallbackGroup::SharedPtr& group) const;
  std::string resolved_topic(const std::string& name) const;
  /// Null: not within the process.
  std::shared_ptr<detail::IntraProcessTopics> within_process(IntraProcessSetting setting) const;

  NodeOptions options_;
  node_interfaces::NodeBaseInterface::SharedPtr base_;
  std::string name_space_;
  Logger logger_;
  Clock::SharedPtr clock_;
  std::shared_ptr<detail::NodeParameters> parameters_;
  std::unique_ptr<detail::TimeSource> time_source_;
};

}  // namespace rclcpp

#include "rclcpp/detail/node_templates.hpp"  // IWYU pragma: export
