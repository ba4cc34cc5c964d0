// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_services.hpp"

namespace rclcpp::detail {

template <typename ServiceT>
void ParameterServices::offer(node_interfaces::NodeBaseInterface& base, const std::string& name,
                              Handler<ServiceT> handler) {
  using Request = std::shared_ptr<typename ServiceT::Request>;
  using Response = std::shared_ptr<typename ServiceT::Response>;
  auto service = std::make_shared<Service<ServiceT>>(
      base.get_shared_rcl_node_handle(), "~/" + name,
      [this, handler](const Request& request, const Response& response) {
        (this->*handler)(*request, *response);
      },
      ParametersQoS().get_rmw_qos_profile());
  base.get_default_callback_group()->add(service);
  services_.push_back(std::move(service));
}

ParameterServices::ParameterServices(node_interfaces::NodeBaseInterface& base,
                                     NodeParameters& parameters)
    : parameters_(parameters) {
  offer<Get>(base, "get_parameters", &ParameterServices::get);
  offer<GetTypes>(base, "get_parameter_types", &ParameterServices::get_types);
  offer<Set>(base, "set_parameters", &ParameterServices::set);
  offer<SetAtomically>(base, "set_parameters_atomically", &ParameterServices::set_atomically);
  offer<Describe>(base, "describe_parameters", &ParameterServices::describe);
  offer<List>(base, "list_parameters", &ParameterServices::list);
}

// One unknown name makes the answer of the next three empty, as with rclcpp: there is no field that
// could say which one it is.

void ParameterServices::get(const Get::Request& request, Get::Response& response) {
  for (const auto& name : request.names) {
    Parameter parameter;
    if (!parameters_.find(name, parameter) && !parameters_.allows_undeclared()) {
      response.values.clear();
      return;
    }
    response.values.push_back(parameter.get_value_message());
  }
}

void ParameterServices::get_types(const GetTypes::Request& request, GetTypes::Response& response) {
  for (const auto& name : request.names) {
    Parameter parameter;
    if (!parameters_.find(name, parameter) && !parameters_.allows_undeclared()) {
      response.types.clear();
      return;
    }
    response.types.push_back(parameter.get_type());
  }
}

void ParameterServices::describe(const Describe::Request& request, Describe::Response& response) {
  for (const auto& name : request.names) {
    if (!parameters_.has(name) && !parameters_.allows_undeclared()) {
      response.descriptors.clear();
      return;
    }
    response.descriptors.push_back(parameters_.describe(name));
  }
}

void ParameterServices::set(const Set::Request& request, Set::Response& response) {
  for (const auto& message : request.parameters) {
    NodeParameters::Result result;
    try {
      result = parameters_.set({Parameter::from_parameter_msg(message)});
    } catch (const exceptions::ParameterNotDeclaredException& error) {
      result.reason = error.what();
    } catch (const exceptions::InvalidParametersException& error) {
      result.reason = error.what();
    }  // What a node's own callback throws leaves spin(), as in rclcpp.
    response.results.push_back(result);
  }
}

void ParameterServices::set_atomically(const SetAtomically::Request& request,
                                       SetAtomically::Response& response) {
  std::vector<Parameter> parameters;
  for (const auto& message : request.parameters) {
    parameters.push_back(Parameter::from_parameter_msg(message));
  }
  try {
    response.result = parameters_.set(parameters);
  } catch (const exceptions::ParameterNotDeclaredException& error) {
    response.result.successful = false;
    response.result.reason = error.what();
  }
}

void ParameterServices::list(const List::Request& request, List::Response& response) {
  response.result = parameters_.list(request.prefixes, request.depth);
}

}  // namespace rclcpp::detail
