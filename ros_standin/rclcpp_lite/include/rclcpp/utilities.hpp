// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/init_options.hpp"

namespace rclcpp {

enum class SignalHandlerOptions { All, SigInt, SigTerm, None };

/// Starts the global context with the ROS words of the command line (--ros-args ...).
void init(int argc, char const* const* argv, const InitOptions& options = InitOptions(),
          SignalHandlerOptions signals = SignalHandlerOptions::All);

/// Makes SIGINT and SIGTERM shut every context down. False: was installed before.
bool install_signal_handlers(SignalHandlerOptions signals = SignalHandlerOptions::All);
bool signal_handlers_installed();
bool uninstall_signal_handlers();

/// As init; returns the words that were not for ROS.
std::vector<std::string> init_and_remove_ros_arguments(int argc, char const* const* argv,
                                                       const InitOptions& options = InitOptions());
std::vector<std::string> remove_ros_arguments(int argc, char const* const* argv);

bool ok(Context::SharedPtr context = nullptr);
bool shutdown(Context::SharedPtr context = nullptr,
              const std::string& reason = "user called rclcpp::shutdown()");
void on_shutdown(std::function<void()> callback, Context::SharedPtr context = nullptr);

/// False: shut down before the time was over.
bool sleep_for(const std::chrono::nanoseconds& span, Context::SharedPtr context = nullptr);

}  // namespace rclcpp
