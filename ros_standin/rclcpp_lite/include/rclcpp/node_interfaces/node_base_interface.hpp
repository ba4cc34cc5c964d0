// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/node.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rclcpp/callback_group.hpp"
#include "rclcpp/context.hpp"
#include "rclcpp/node_options.hpp"

namespace rclcpp::node_interfaces {

/// What executors need of a node: its rcl node and its callback groups.
class NodeBaseInterface {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(NodeBaseInterface)
  NodeBaseInterface(const std::string& name, const std::string& name_space,
                    const NodeOptions& options);
  NodeBaseInterface(const NodeBaseInterface&) = delete;
  NodeBaseInterface& operator=(const NodeBaseInterface&) = delete;
  ~NodeBaseInterface();
  const char* get_name() const { return rcl_node_get_name(node_.get()); }
  const char* get_namespace() const { return rcl_node_get_namespace(node_.get()); }
  const char* get_fully_qualified_name() const {
    return rcl_node_get_fully_qualified_name(node_.get());
  }
  Context::SharedPtr get_context() const { return context_; }
  rcl_node_t* get_rcl_node_handle() const { return node_.get(); }
  std::shared_ptr<rcl_node_t> get_shared_rcl_node_handle() const { return node_; }
  CallbackGroup::SharedPtr get_default_callback_group() const { return default_group_; }
  CallbackGroup::SharedPtr create_callback_group(CallbackGroupType type, bool automatically_add);
  bool callback_group_in_node(const CallbackGroup::SharedPtr& group) const;
  std::vector<CallbackGroup::WeakPtr> callback_groups() const;
  void set_wake_up(const std::shared_ptr<detail::WakeUp>& wake_up);
  bool has_executor() const;

 private:
  Context::SharedPtr context_;
  std::shared_ptr<rcl_node_t> node_;
  mutable std::mutex mutex_;
  std::vector<CallbackGroup::WeakPtr> groups_;
  CallbackGroup::SharedPtr default_group_;
  std::weak_ptr<detail::WakeUp> wake_up_;
};

}  // namespace rclcpp::node_interfaces
