// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/executors.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace rclcpp {

namespace executors {

void SingleThreadedExecutor::spin() {
  begin_spin();
  struct End {
    std::atomic_bool& spinning;
    ~End() { spinning = false; }
  } const end{spinning_};
  while (may_spin()) {
    if (auto work = next(std::chrono::nanoseconds(-1))) execute(*work);
  }
}

MultiThreadedExecutor::MultiThreadedExecutor(const ExecutorOptions& options,
                                             std::size_t number_of_threads,
                                             bool yield_before_execute,
                                             std::chrono::nanoseconds timeout)
    : Executor(options),
      threads_(number_of_threads > 0
                   ? number_of_threads
                   : std::max<std::size_t>(std::thread::hardware_concurrency(), 2)),
      yield_(yield_before_execute),
      timeout_(timeout) {}

void MultiThreadedExecutor::work() {
  while (may_spin()) {
    auto work = next(timeout_);
    if (!work) continue;
    if (yield_) std::this_thread::yield();
    execute(*work);
  }
}

void MultiThreadedExecutor::spin() {
  begin_spin();
  std::exception_ptr first_error;
  std::mutex mutex;
  const auto guarded = [&] {
    try {
      work();
    } catch (...) {
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!first_error) first_error = std::current_exception();
      }
      cancel();
    }
  };
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < threads_; ++i) others.emplace_back(guarded);
  guarded();
  for (auto& thread : others) thread.join();
  spinning_ = false;
  if (first_error) std::rethrow_exception(first_error);
}

}  // namespace executors

namespace {

ExecutorOptions options_of(const node_interfaces::NodeBaseInterface::SharedPtr& node) {
  ExecutorOptions options;
  options.context = node->get_context();
  return options;
}
}  // namespace

void spin(node_interfaces::NodeBaseInterface::SharedPtr node) {
  executors::SingleThreadedExecutor executor(options_of(node));
  executor.add_node(node);
  executor.spin();
  executor.remove_node(node);
}
void spin(const std::shared_ptr<Node>& node) {
  spin(node->get_node_base_interface());
}

void spin_some(node_interfaces::NodeBaseInterface::SharedPtr node) {
  executors::SingleThreadedExecutor executor(options_of(node));
  executor.add_node(node);
  executor.spin_some();
  executor.remove_node(node);
}
void spin_some(const std::shared_ptr<Node>& node) {
  spin_some(node->get_node_base_interface());
}

}  // namespace rclcpp
