// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The bodies of Node's templates; included by node.hpp.
#include <utility>

#include "rclcpp/node.hpp"

namespace rclcpp {

template <typename MessageT, typename AllocatorT>
std::shared_ptr<Publisher<MessageT>> Node::create_publisher(
    const std::string& topic, const QoS& qos,
    const PublisherOptionsWithAllocator<AllocatorT>& options) {
  return std::make_shared<Publisher<MessageT>>(base_->get_shared_rcl_node_handle(), topic, qos,
                                               within_process(options.use_intra_process_comm));
}

template <typename MessageT, typename CallbackT, typename AllocatorT>
std::shared_ptr<Subscription<MessageT>> Node::create_subscription(
    const std::string& topic, const QoS& qos, CallbackT&& callback,
    const SubscriptionOptionsWithAllocator<AllocatorT>& options) {
  auto subscription = std::make_shared<Subscription<MessageT>>(
      base_->get_shared_rcl_node_handle(), topic, qos, std::forward<CallbackT>(callback),
      options.ignore_local_publications, within_process(options.use_intra_process_comm));
  group_or_default(options.callback_group).add(subscription);
  return subscription;
}

template <typename CallbackT, typename AllocatorT>
std::shared_ptr<GenericSubscription> Node::create_generic_subscription(
    const std::string& topic, const std::string& type, const QoS& qos, CallbackT&& callback,
    const SubscriptionOptionsWithAllocator<AllocatorT>& options) {
  auto subscription = std::make_shared<GenericSubscription>(
      base_->get_shared_rcl_node_handle(), topic, type, qos, std::forward<CallbackT>(callback),
      options.ignore_local_publications);
  group_or_default(options.callback_group).add(subscription);
  return subscription;
}

template <typename ServiceT, typename CallbackT>
typename Service<ServiceT>::SharedPtr Node::create_service(const std::string& name,
                                                           CallbackT&& callback, const QoS& qos,
                                                           CallbackGroup::SharedPtr group) {
  auto service = std::make_shared<Service<ServiceT>>(base_->get_shared_rcl_node_handle(), name,
                                                     std::forward<CallbackT>(callback),
                                                     qos.get_rmw_qos_profile());
  group_or_default(group).add(service);
  return service;
}

template <typename ServiceT>
typename Client<ServiceT>::SharedPtr Node::create_client(const std::string& name, const QoS& qos,
                                                         CallbackGroup::SharedPtr group) {
  auto client = std::make_shared<Client<ServiceT>>(
      base_->get_shared_rcl_node_handle(), base_->get_context(), name, qos.get_rmw_qos_profile());
  group_or_default(group).add(client);
  return client;
}

template <typename Rep, typename Period, typename CallbackT>
typename WallTimer<std::decay_t<CallbackT>>::SharedPtr Node::create_wall_timer(
    std::chrono::duration<Rep, Period> period, CallbackT callback, CallbackGroup::SharedPtr group) {
  auto timer = std::make_shared<WallTimer<std::decay_t<CallbackT>>>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(period), std::move(callback),
      base_->get_context());
  group_or_default(group).add(timer);
  return timer;
}

template <typename ParameterT>
auto Node::declare_parameter(const std::string& name, const ParameterT& value,
                             const Descriptor& descriptor, bool ignore_override) {
  try {
    return declare_parameter(name, ParameterValue(value), descriptor, ignore_override)
        .template get<ParameterT>();
  } catch (const ParameterTypeException& error) {
    throw exceptions::InvalidParameterTypeException(name, error.what());
  }
}

template <typename ParameterT>
auto Node::declare_parameter(const std::string& name, const Descriptor& descriptor,
                             bool ignore_override) {
  const auto& value =
      declare_parameter(name, detail::parameter_type_of<ParameterT>(), descriptor, ignore_override);
  if (value.get_type() == PARAMETER_NOT_SET) {
    throw exceptions::ParameterUninitializedException(name);
  }
  return value.template get<ParameterT>();
}

template <typename ParameterT>
std::vector<ParameterT> Node::declare_parameters(
    const std::string& name_space, const std::map<std::string, ParameterT>& parameters,
    bool ignore_overrides) {
  std::vector<ParameterT> values;
  for (const auto& [name, value] : parameters) {
    values.push_back(static_cast<ParameterT>(
        declare_parameter(name_space.empty() ? name : name_space + "." + name, value, Descriptor(),
                          ignore_overrides)));
  }
  return values;
}

template <typename ParameterT>
bool Node::get_parameter(const std::string& name, ParameterT& value) const {
  Parameter parameter;
  const bool found = get_parameter(name, parameter);
  if (found) value = static_cast<ParameterT>(parameter.get_value<ParameterT>());
  return found;
}

template <typename ParameterT>
bool Node::get_parameter_or(const std::string& name, ParameterT& value,
                            const ParameterT& alternative) const {
  const bool found = get_parameter(name, value);
  if (!found) value = alternative;
  return found;
}

template <typename ParameterT>
ParameterT Node::get_parameter_or(const std::string& name, const ParameterT& alternative) const {
  ParameterT value;
  get_parameter_or(name, value, alternative);
  return value;
}

template <typename ParameterT>
bool Node::get_parameters(const std::string& prefix,
                          std::map<std::string, ParameterT>& values) const {
  const auto start = prefix.empty() ? prefix : prefix + ".";
  bool found = false;
  for (const auto& name : list_parameters({}, 0).names) {
    if (name.rfind(start, 0) != 0) continue;
    values[name.substr(start.size())] =
        static_cast<ParameterT>(get_parameter(name).get_value<ParameterT>());
    found = true;
  }
  return found;
}

}  // namespace rclcpp
