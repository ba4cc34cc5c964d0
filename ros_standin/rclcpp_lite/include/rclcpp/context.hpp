// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/context.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rclcpp/detail/intra_process.hpp"
#include "rclcpp/init_options.hpp"
#include "rclcpp/macros.hpp"

namespace rclcpp {

/// Names a callback so that it can be taken back.
struct OnShutdownCallbackHandle {
  std::uint64_t id{0};
};
using ShutdownCallbackHandle = OnShutdownCallbackHandle;

/// One connection to the middleware, from init to shutdown. Safe to use from several threads.
class Context : public std::enable_shared_from_this<Context> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Context)
  Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  virtual ~Context();

  /// Throws RCLError, UnknownROSArgsError; std::runtime_error if it is initialized already.
  virtual void init(int argc, char const* const* argv, const InitOptions& options = InitOptions());
  bool is_valid() const;
  /// Ends all waiting and calls the callbacks. False: it was not valid.
  virtual bool shutdown(const std::string& reason);
  std::string shutdown_reason() const;
  const InitOptions& get_init_options() const { return options_; }

  using OnShutdownCallback = std::function<void()>;
  OnShutdownCallback on_shutdown(OnShutdownCallback callback);
  OnShutdownCallbackHandle add_on_shutdown_callback(OnShutdownCallback callback);
  bool remove_on_shutdown_callback(const OnShutdownCallbackHandle& handle);

  /// False: shut down before the time was over.
  bool sleep_for(const std::chrono::nanoseconds& span);

  /// Nodes and executors keep it, so that the middleware outlives them.
  std::shared_ptr<rcl_context_t> get_rcl_context() const;

  // ---- for nodes, not for users ----
  const std::shared_ptr<detail::IntraProcessTopics>& intra_process_topics() const {
    return intra_process_topics_;
  }

 private:
  mutable std::recursive_mutex mutex_;
  std::atomic_bool valid_{
      false};  ///< Read without the lock: sleepers ask under locks of their own.
  std::shared_ptr<rcl_context_t> rcl_context_;
  InitOptions options_;
  std::string reason_;
  std::map<std::uint64_t, OnShutdownCallback> callbacks_;
  std::uint64_t next_callback_{1};
  std::mutex sleep_mutex_;
  std::condition_variable sleepers_;
  const std::shared_ptr<detail::IntraProcessTopics> intra_process_topics_{
      std::make_shared<detail::IntraProcessTopics>()};
};

namespace contexts {
/// The one that rclcpp::init and every node without another use.
Context::SharedPtr get_global_default_context();
}  // namespace contexts

}  // namespace rclcpp
