// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/node.hpp"

#include <rcl/graph.h>
#include <rcl/node.h>
#include <rcl/remap.h>

#include "node_parameters.hpp"
#include "rcl_call.hpp"
#include "time_source.hpp"

namespace rclcpp {

Node::Node(const std::string& name, const NodeOptions& options) : Node(name, "", options) {}

Node::Node(const std::string& name, const std::string& name_space, const NodeOptions& options)
    : options_(options),
      base_(std::make_shared<node_interfaces::NodeBaseInterface>(name, name_space, options)),
      name_space_(base_->get_namespace()),
      logger_(rclcpp::get_logger(rcl_node_get_logger_name(base_->get_rcl_node_handle()))),
      clock_(std::make_shared<Clock>(RCL_ROS_TIME)),
      parameters_(std::make_shared<detail::NodeParameters>(base_, clock_, options)),
      time_source_(std::make_unique<detail::TimeSource>(base_, clock_, *parameters_, options)) {}

Node::~Node() = default;

node_interfaces::NodeParametersInterface::SharedPtr Node::get_node_parameters_interface() {
  return parameters_;
}

std::shared_ptr<detail::IntraProcessTopics> Node::within_process(
    IntraProcessSetting setting) const {
  const bool wanted =
      setting == IntraProcessSetting::Enable ||
      (setting == IntraProcessSetting::NodeDefault && options_.use_intra_process_comms());
  return wanted ? base_->get_context()->intra_process_topics() : nullptr;
}

CallbackGroup& Node::group_or_default(const CallbackGroup::SharedPtr& group) const {
  if (!group) return *base_->get_default_callback_group();
  if (!base_->callback_group_in_node(group)) {
    throw std::runtime_error("the callback group is not of this node");
  }
  return *group;
}

CallbackGroup::SharedPtr Node::create_callback_group(CallbackGroupType type,
                                                     bool automatically_add_to_executor) {
  return base_->create_callback_group(type, automatically_add_to_executor);
}

// ---- parameters ---------------------------------------------------------------------------------

const ParameterValue& Node::declare_parameter(const std::string& name, const ParameterValue& value,
                                              const Descriptor& descriptor, bool ignore_override) {
  return parameters_->declare(name, value, value.get_type(), descriptor, ignore_override);
}

const ParameterValue& Node::declare_parameter(const std::string& name, ParameterType type,
                                              const Descriptor& descriptor, bool ignore_override) {
  return parameters_->declare(name, ParameterValue(), type, descriptor, ignore_override);
}

void Node::undeclare_parameter(const std::string& name) {
  parameters_->undeclare(name);
}
bool Node::has_parameter(const std::string& name) const {
  return parameters_->has(name);
}

rcl_interfaces::msg::SetParametersResult Node::set_parameter(const Parameter& parameter) {
  return parameters_->set({parameter});
}

std::vector<rcl_interfaces::msg::SetParametersResult> Node::set_parameters(
    const std::vector<Parameter>& parameters) {
  std::vector<rcl_interfaces::msg::SetParametersResult> results;
  for (const auto& parameter : parameters) results.push_back(parameters_->set({parameter}));
  return results;
}

rcl_interfaces::msg::SetParametersResult Node::set_parameters_atomically(
    const std::vector<Parameter>& parameters) {
  return parameters_->set(parameters);
}

Parameter Node::get_parameter(const std::string& name) const {
  return parameters_->get(name);
}

bool Node::get_parameter(const std::string& name, Parameter& parameter) const {
  return parameters_->find(name, parameter);
}

std::vector<Parameter> Node::get_parameters(const std::vector<std::string>& names) const {
  std::vector<Parameter> found;
  for (const auto& name : names) found.push_back(parameters_->get(name));
  return found;
}

Node::Descriptor Node::describe_parameter(const std::string& name) const {
  return parameters_->describe(name);
}

std::vector<Node::Descriptor> Node::describe_parameters(
    const std::vector<std::string>& names) const {
  std::vector<Descriptor> found;
  for (const auto& name : names) found.push_back(parameters_->describe(name));
  return found;
}

std::vector<std::uint8_t> Node::get_parameter_types(const std::vector<std::string>& names) const {
  std::vector<std::uint8_t> types;
  for (const auto& parameter : get_parameters(names)) types.push_back(parameter.get_type());
  return types;
}

rcl_interfaces::msg::ListParametersResult Node::list_parameters(
    const std::vector<std::string>& prefixes, std::uint64_t depth) const {
  return parameters_->list(prefixes, depth);
}

Node::OnSetParametersCallbackHandle::SharedPtr Node::add_on_set_parameters_callback(
    OnParametersSetCallbackType callback) {
  return parameters_->add_callback(std::move(callback));
}

void Node::remove_on_set_parameters_callback(const OnSetParametersCallbackHandle* handler) {
  parameters_->remove_callback(handler);
}

// ---- graph --------------------------------------------------------------------------------------

std::vector<std::string> Node::get_node_names() const {
  auto names = rcutils_get_zero_initialized_string_array();
  auto spaces = rcutils_get_zero_initialized_string_array();
  detail::check(rcl_get_node_names(base_->get_rcl_node_handle(), rcl_get_default_allocator(),
                                   &names, &spaces),
                "list nodes");
  std::vector<std::string> found;
  for (std::size_t i = 0; i < names.size; ++i) {
    const std::string space = spaces.data[i];
    found.push_back(space + (space.back() == '/' ? "" : "/") + names.data[i]);
  }
  detail::complain(rcutils_string_array_fini(&names), "free names");
  detail::complain(rcutils_string_array_fini(&spaces), "free names");
  return found;
}

namespace {
std::map<std::string, std::vector<std::string>> converted(rcl_names_and_types_t& listed) {
  std::map<std::string, std::vector<std::string>> found;
  for (std::size_t i = 0; i < listed.names.size; ++i) {
    auto& types = found[listed.names.data[i]];
    types.assign(listed.types[i].data, listed.types[i].data + listed.types[i].size);
  }
  detail::complain(rcl_names_and_types_fini(&listed), "free names");
  return found;
}
}  // namespace

std::map<std::string, std::vector<std::string>> Node::get_topic_names_and_types() const {
  auto listed = rcl_get_zero_initialized_names_and_types();
  auto allocator = rcl_get_default_allocator();
  detail::check(
      rcl_get_topic_names_and_types(base_->get_rcl_node_handle(), &allocator, false, &listed),
      "list topics");
  return converted(listed);
}

std::map<std::string, std::vector<std::string>> Node::get_service_names_and_types() const {
  auto listed = rcl_get_zero_initialized_names_and_types();
  auto allocator = rcl_get_default_allocator();
  detail::check(rcl_get_service_names_and_types(base_->get_rcl_node_handle(), &allocator, &listed),
                "list services");
  return converted(listed);
}

std::string Node::resolved_topic(const std::string& name) const {
  char* resolved = nullptr;
  const auto allocator = rcl_get_default_allocator();
  detail::check(rcl_node_resolve_name(base_->get_rcl_node_handle(), name.c_str(), allocator, false,
                                      false, &resolved),
                "resolve topic '" + name + "'");
  std::string copy = resolved;
  allocator.deallocate(resolved, allocator.state);
  return copy;
}

std::size_t Node::count_publishers(const std::string& topic) const {
  std::size_t count = 0;
  detail::check(
      rcl_count_publishers(base_->get_rcl_node_handle(), resolved_topic(topic).c_str(), &count),
      "count publishers of '" + topic + "'");
  return count;
}

std::size_t Node::count_subscribers(const std::string& topic) const {
  std::size_t count = 0;
  detail::check(
      rcl_count_subscribers(base_->get_rcl_node_handle(), resolved_topic(topic).c_str(), &count),
      "count subscribers of '" + topic + "'");
  return count;
}

}  // namespace rclcpp
