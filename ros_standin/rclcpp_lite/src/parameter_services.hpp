// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rcl_interfaces/srv/describe_parameters.hpp>
#include <rcl_interfaces/srv/get_parameter_types.hpp>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rcl_interfaces/srv/list_parameters.hpp>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <rcl_interfaces/srv/set_parameters_atomically.hpp>

#include "node_parameters.hpp"

namespace rclcpp::detail {

/// The six services with which others read and set a node's parameters.
class ParameterServices {
 public:
  ParameterServices(node_interfaces::NodeBaseInterface& base, NodeParameters& parameters);

 private:
  template <typename ServiceT>
  using Handler = void (ParameterServices::*)(const typename ServiceT::Request&,
                                              typename ServiceT::Response&);
  template <typename ServiceT>
  void offer(node_interfaces::NodeBaseInterface& base, const std::string& name,
             Handler<ServiceT> handler);

  using Get = rcl_interfaces::srv::GetParameters;
  using GetTypes = rcl_interfaces::srv::GetParameterTypes;
  using Set = rcl_interfaces::srv::SetParameters;
  using SetAtomically = rcl_interfaces::srv::SetParametersAtomically;
  using Describe = rcl_interfaces::srv::DescribeParameters;
  using List = rcl_interfaces::srv::ListParameters;
  void get(const Get::Request& request, Get::Response& response);
  void get_types(const GetTypes::Request& request, GetTypes::Response& response);
  void set(const Set::Request& request, Set::Response& response);
  void set_atomically(const SetAtomically::Request& request, SetAtomically::Response& response);
  void describe(const Describe::Request& request, Describe::Response& response);
  void list(const List::Request& request, List::Response& response);

  NodeParameters& parameters_;
  std::vector<ServiceBase::SharedPtr> services_;
};

}  // namespace rclcpp::detail
