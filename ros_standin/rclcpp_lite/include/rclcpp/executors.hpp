// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rclcpp/executors/multi_threaded_executor.hpp"
#include "rclcpp/executors/single_threaded_executor.hpp"
#include "rclcpp/node.hpp"

namespace rclcpp {

namespace executors {
using rclcpp::ExecutorOptions;
template <typename FutureT, typename Rep = std::int64_t, typename Period = std::milli>
FutureReturnCode spin_node_until_future_complete(
    Executor& executor, const std::shared_ptr<Node>& node, const FutureT& future,
    std::chrono::duration<Rep, Period> timeout = std::chrono::duration<Rep, Period>(-1)) {
  executor.add_node(node);
  const auto result = executor.spin_until_future_complete(future, timeout);
  executor.remove_node(node);
  return result;
}
}  // namespace executors

/// Each of these uses an executor of its own on this thread.
void spin(const std::shared_ptr<Node>& node);
void spin(node_interfaces::NodeBaseInterface::SharedPtr node);
void spin_some(const std::shared_ptr<Node>& node);
void spin_some(node_interfaces::NodeBaseInterface::SharedPtr node);

template <typename FutureT, typename Rep = std::int64_t, typename Period = std::milli>
FutureReturnCode spin_until_future_complete(
    const std::shared_ptr<Node>& node, const FutureT& future,
    std::chrono::duration<Rep, Period> timeout = std::chrono::duration<Rep, Period>(-1)) {
  ExecutorOptions options;
  options.context = node->get_node_base_interface()->get_context();
  executors::SingleThreadedExecutor executor(options);
  return executors::spin_node_until_future_complete(executor, node, future, timeout);
}

}  // namespace rclcpp
