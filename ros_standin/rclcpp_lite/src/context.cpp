// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/context.hpp"

#include <rcl/arguments.h>
#include <rcl/init.h>
#include <rcl/init_options.h>
#include <rcl/logging.h>
#include <rcutils/logging_macros.h>

#include <stdexcept>

#include "logging_output.hpp"
#include "rcl_call.hpp"
#include "rclcpp/exceptions.hpp"
#include "unknown_arguments.hpp"

namespace rclcpp {

namespace {
/// Ends rcl when the last user, often a node, is gone.
void end(rcl_context_t* context) {
  if (rcl_context_is_valid(context)) detail::complain(rcl_shutdown(context), "shut down");
  detail::complain(rcl_context_fini(context), "end the context");
  delete context;
}

class RclInitOptions {
 public:
  explicit RclInitOptions(const InitOptions& options) {
    detail::check(rcl_init_options_init(&options_, rcl_get_default_allocator()), "make options");
    detail::check(rcl_init_options_set_domain_id(&options_, options.get_domain_id()),
                  "set the domain");
  }
  RclInitOptions(const RclInitOptions&) = delete;
  RclInitOptions& operator=(const RclInitOptions&) = delete;
  ~RclInitOptions() { detail::complain(rcl_init_options_fini(&options_), "end options"); }
  const rcl_init_options_t* get() const { return &options_; }

 private:
  rcl_init_options_t options_ = rcl_get_zero_initialized_init_options();
};
}  // namespace

Context::Context() = default;
Context::~Context() {
  try {
    Context::shutdown("context destroyed");
  } catch (const std::exception& error) {
    // A callback's trouble; nobody but the log is left to tell.
    RCUTILS_LOG_ERROR_NAMED("rclcpp", "shutdown: %s", error.what());
  }
}

void Context::init(int argc, char const* const* argv, const InitOptions& options) {
  const std::lock_guard<std::recursive_mutex> lock(mutex_);
  if (is_valid()) throw std::runtime_error("the context is initialized already");
  auto fresh = std::make_unique<rcl_context_t>(rcl_get_zero_initialized_context());
  const RclInitOptions rcl_options(options);
  detail::check(rcl_init(argc, argv, rcl_options.get(), fresh.get()), "initialize ROS");
  std::shared_ptr<rcl_context_t> made(fresh.release(), end);
  auto unknown = detail::unknown_ros_arguments(made->global_arguments, argv);
  if (!unknown.empty()) throw exceptions::UnknownROSArgsError(std::move(unknown));
  if (options.auto_initialize_logging()) detail::start_logging(made->global_arguments);
  rcl_context_ = std::move(made);
  options_ = options;
  reason_.clear();
  valid_ = true;
}

bool Context::is_valid() const {
  return valid_;
}

bool Context::shutdown(const std::string& reason) {
  std::map<std::uint64_t, OnShutdownCallback> callbacks;
  {
    const std::lock_guard<std::recursive_mutex> lock(mutex_);
    if (!valid_.exchange(false)) return false;
    detail::check(rcl_shutdown(rcl_context_.get()), "shut down");
    reason_ = reason;
    callbacks = callbacks_;
  }
  { const std::lock_guard<std::mutex> lock(sleep_mutex_); }
  sleepers_.notify_all();
  for (const auto& [id, callback] : callbacks) {
    // Taken back meanwhile: what it used may be gone.
    const std::lock_guard<std::recursive_mutex> lock(mutex_);
    if (callbacks_.count(id) != 0) callback();
  }
  return true;
}

std::string Context::shutdown_reason() const {
  const std::lock_guard<std::recursive_mutex> lock(mutex_);
  return reason_;
}

Context::OnShutdownCallback Context::on_shutdown(OnShutdownCallback callback) {
  add_on_shutdown_callback(callback);
  return callback;
}

OnShutdownCallbackHandle Context::add_on_shutdown_callback(OnShutdownCallback callback) {
  const std::lock_guard<std::recursive_mutex> lock(mutex_);
  const auto id = next_callback_++;
  callbacks_.emplace(id, std::move(callback));
  return {id};
}

bool Context::remove_on_shutdown_callback(const OnShutdownCallbackHandle& handle) {
  const std::lock_guard<std::recursive_mutex> lock(mutex_);
  return callbacks_.erase(handle.id) != 0;
}

bool Context::sleep_for(const std::chrono::nanoseconds& span) {
  const auto until = std::chrono::steady_clock::now() + span;
  std::unique_lock<std::mutex> lock(sleep_mutex_);
  sleepers_.wait_until(lock, until, [this] { return !is_valid(); });
  return is_valid();
}

std::shared_ptr<rcl_context_t> Context::get_rcl_context() const {
  const std::lock_guard<std::recursive_mutex> lock(mutex_);
  return rcl_context_;
}

Context::SharedPtr contexts::get_global_default_context() {
  // The one static of the library: rclcpp::init has no argument that could carry it.
  static const auto context = std::make_shared<Context>();
  return context;
}

}  // namespace rclcpp
