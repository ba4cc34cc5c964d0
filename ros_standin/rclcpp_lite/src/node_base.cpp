// SPDX-License-Identifier: BSD-3-Clause
#include <rcl/logging.h>
#include <rcl/logging_rosout.h>
#include <rcl/node_options.h>

#include <algorithm>
#include <stdexcept>

#include "logging_output.hpp"
#include "rcl_call.hpp"
#include "rclcpp/node_interfaces/node_base_interface.hpp"
#include "unknown_arguments.hpp"

namespace rclcpp::node_interfaces {

namespace {
class RclNodeOptions {
 public:
  explicit RclNodeOptions(const NodeOptions& options) : options_(rcl_node_get_default_options()) {
    options_.use_global_arguments = options.use_global_arguments();
    options_.enable_rosout = options.enable_rosout();
    options_.rosout_qos = options.rosout_qos().get_rmw_qos_profile();
    std::vector<const char*> words;
    for (const auto& word : options.arguments()) words.push_back(word.c_str());
    detail::check(rcl_parse_arguments(static_cast<int>(words.size()), words.data(),
                                      rcl_get_default_allocator(), &options_.arguments),
                  "read the node's arguments");
    auto unknown = detail::unknown_ros_arguments(options_.arguments, words.data());
    if (!unknown.empty()) {
      detail::complain(rcl_node_options_fini(&options_), "end node options");
      throw exceptions::UnknownROSArgsError(std::move(unknown));
    }
  }
  RclNodeOptions(const RclNodeOptions&) = delete;
  RclNodeOptions& operator=(const RclNodeOptions&) = delete;
  ~RclNodeOptions() { detail::complain(rcl_node_options_fini(&options_), "end node options"); }
  const rcl_node_options_t* get() const { return &options_; }

 private:
  rcl_node_options_t options_;
};

std::shared_ptr<rcl_node_t> make(const std::string& name, const std::string& name_space,
                                 const RclNodeOptions& options,
                                 const std::shared_ptr<rcl_context_t>& context, bool rosout) {
  // Publishers, subscriptions and the rest share the node; rcl wants it to end after them.
  const detail::LoggingPause pause;
  auto fresh = std::make_unique<rcl_node_t>(rcl_get_zero_initialized_node());
  detail::check(
      rcl_node_init(fresh.get(), name.c_str(), name_space.c_str(), context.get(), options.get()),
      "make node '" + name + "' in namespace '" + name_space + "'");
  const bool logs = rosout && rcl_logging_rosout_enabled();
  std::shared_ptr<rcl_node_t> node(fresh.release(), [context, logs](rcl_node_t* ended) {
    const detail::LoggingPause pause_at_end;
    if (logs) detail::complain(rcl_logging_rosout_fini_publisher_for_node(ended), "end /rosout");
    detail::complain(rcl_node_fini(ended), "end a node");
    delete ended;
  });
  if (logs) {
    detail::check(rcl_logging_rosout_init_publisher_for_node(node.get()), "publish to /rosout");
  }
  return node;
}
}  // namespace

NodeBaseInterface::NodeBaseInterface(const std::string& name, const std::string& name_space,
                                     const NodeOptions& options)
    : context_(options.context()) {
  const auto rcl_context = context_->get_rcl_context();
  if (!rcl_context) {
    throw std::runtime_error("node '" + name + "': rclcpp::init has not been called");
  }
  node_ = make(name, name_space, RclNodeOptions(options), rcl_context, options.enable_rosout());
  default_group_ = create_callback_group(CallbackGroupType::MutuallyExclusive, true);
}

NodeBaseInterface::~NodeBaseInterface() {
  for (const auto& weak : groups_) {
    if (const auto group = weak.lock()) group->trigger_notify_guard_condition();
  }
}

CallbackGroup::SharedPtr NodeBaseInterface::create_callback_group(CallbackGroupType type,
                                                                  bool automatically_add) {
  auto group = std::make_shared<CallbackGroup>(type, automatically_add);
  const std::lock_guard<std::mutex> lock(mutex_);
  groups_.push_back(group);
  const auto wake_up = wake_up_.lock();
  if (automatically_add && wake_up) {
    group->set_wake_up(wake_up);
    wake_up->set_changed();
  }
  return group;
}

bool NodeBaseInterface::callback_group_in_node(const CallbackGroup::SharedPtr& group) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(groups_.begin(), groups_.end(),
                     [&](const auto& ours) { return ours.lock() == group; });
}

std::vector<CallbackGroup::WeakPtr> NodeBaseInterface::callback_groups() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return groups_;
}

void NodeBaseInterface::set_wake_up(const std::shared_ptr<detail::WakeUp>& wake_up) {
  const std::lock_guard<std::mutex> lock(mutex_);
  wake_up_ = wake_up;
  for (const auto& weak : groups_) {
    const auto group = weak.lock();
    if (group && group->automatically_add_to_executor_with_node()) group->set_wake_up(wake_up);
  }
}

bool NodeBaseInterface::has_executor() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !wake_up_.expired();
}

}  // namespace rclcpp::node_interfaces
