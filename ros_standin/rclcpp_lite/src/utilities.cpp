// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/utilities.hpp"

#include <rcl/arguments.h>

#include "rcl_call.hpp"
#include "rclcpp/future_return_code.hpp"
#include "unknown_arguments.hpp"

namespace rclcpp {

namespace {
Context::SharedPtr or_default(Context::SharedPtr context) {
  return context ? context : contexts::get_global_default_context();
}

/// The words of argv whose numbers `get` gives.
template <typename Get>
std::vector<std::string> words_at(int count, Get get, const rcl_arguments_t& arguments,
                                  char const* const* argv) {
  std::vector<std::string> words;
  if (count <= 0) return words;
  int* numbers = nullptr;
  const auto allocator = rcl_get_default_allocator();
  detail::check(get(&arguments, allocator, &numbers), "read arguments");
  for (int i = 0; i < count; ++i) words.emplace_back(argv[numbers[i]]);
  allocator.deallocate(numbers, allocator.state);
  return words;
}
}  // namespace

std::vector<std::string> detail::unknown_ros_arguments(const rcl_arguments_t& arguments,
                                                       char const* const* argv) {
  return words_at(rcl_arguments_get_count_unparsed_ros(&arguments), rcl_arguments_get_unparsed_ros,
                  arguments, argv);
}

void init(int argc, char const* const* argv, const InitOptions& options,
          SignalHandlerOptions signals) {
  contexts::get_global_default_context()->init(argc, argv, options);
  install_signal_handlers(signals);
}

std::vector<std::string> remove_ros_arguments(int argc, char const* const* argv) {
  auto arguments = rcl_get_zero_initialized_arguments();
  detail::check(rcl_parse_arguments(argc, argv, rcl_get_default_allocator(), &arguments),
                "read arguments");
  auto words = words_at(rcl_arguments_get_count_unparsed(&arguments), rcl_arguments_get_unparsed,
                        arguments, argv);
  detail::check(rcl_arguments_fini(&arguments), "end arguments");
  return words;
}

std::vector<std::string> init_and_remove_ros_arguments(int argc, char const* const* argv,
                                                       const InitOptions& options) {
  init(argc, argv, options);
  return remove_ros_arguments(argc, argv);
}

bool ok(Context::SharedPtr context) {
  return or_default(std::move(context))->is_valid();
}

bool shutdown(Context::SharedPtr context, const std::string& reason) {
  const auto ended = or_default(std::move(context));
  const bool was_valid = ended->shutdown(reason);
  if (ended == contexts::get_global_default_context()) uninstall_signal_handlers();
  return was_valid;
}

void on_shutdown(std::function<void()> callback, Context::SharedPtr context) {
  or_default(std::move(context))->on_shutdown(std::move(callback));
}

bool sleep_for(const std::chrono::nanoseconds& span, Context::SharedPtr context) {
  return or_default(std::move(context))->sleep_for(span);
}

std::string to_string(FutureReturnCode code) {
  switch (code) {
    case FutureReturnCode::SUCCESS:
      return "SUCCESS (0)";
    case FutureReturnCode::INTERRUPTED:
      return "INTERRUPTED (1)";
    case FutureReturnCode::TIMEOUT:
      return "TIMEOUT (2)";
  }
  return "UNKNOWN";
}

}  // namespace rclcpp
