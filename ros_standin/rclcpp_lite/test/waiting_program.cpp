// SPDX-License-Identifier: BSD-3-Clause
// Waits in the way its first argument names, and says so. What waits for ever a signal must end.
#include <chrono>
#include <future>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/set_bool.hpp>
#include <stdexcept>
#include <string>

namespace {

using namespace std::chrono_literals;  // NOLINT: what nodes do

using std_srvs::srv::SetBool;

/// A call from plain code, without a callback: the answer is waited for.
void call(const std::shared_ptr<rclcpp::Node>& node) {
  const auto client = node->create_client<SetBool>("server_in_python");
  if (!client->wait_for_service(10ms)) std::cout << "not there yet\n" << std::flush;
  client->wait_for_service(30s);
  const auto request = std::make_shared<SetBool::Request>();
  request->data = true;
  auto future = client->async_send_request(request);
  if (rclcpp::spin_until_future_complete(node, future, 30s) == rclcpp::FutureReturnCode::SUCCESS) {
    std::cout << "answer: " << future.get()->message << "\n";
  }
}

/// True when the spinning ended because of the signal. Prints "waiting" after making the executor: rclcpp refuses to make
/// one, or a client, for a context that a signal has ended.
bool spin(const std::shared_ptr<rclcpp::Node>& node, const std::string& how) {
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(),
                                                    how == "threads" ? 4 : 1);
  executor.add_node(node);
  std::cout << "waiting\n" << std::flush;
  if (how == "future") {
    std::promise<int> never;
    return executor.spin_until_future_complete(never.get_future().share()) ==
           rclcpp::FutureReturnCode::INTERRUPTED;
  }
  executor.spin();
  return !rclcpp::ok();
}

/// True when the waiting ended because of the signal.
bool wait(const std::string& how) {
  auto options = rclcpp::NodeOptions();
  if (how.rfind("sim_", 0) == 0) options.append_parameter_override("use_sim_time", true);
  const auto node = std::make_shared<rclcpp::Node>("waiting", options);
  if (how == "future" || how == "threads") return spin(node, how);
  const auto nobody = node->create_client<SetBool>("nobody");
  std::cout << "waiting\n" << std::flush;
  if (how == "sleep") return !rclcpp::sleep_for(1h);
  if (how == "sim_sleep") return !node->get_clock()->sleep_for(1h);
  if (how == "sim_nap") {
    const bool slept = node->get_clock()->sleep_until(rclcpp::Time(100, 0, RCL_ROS_TIME));
    std::cout << "slept: " << slept << " until " << node->now().nanoseconds() << "\n";
    return false;
  }
  if (how == "call") {
    call(node);
    return false;
  }
  if (how == "service") return !nobody->wait_for_service();
  if (how == "rate") return !rclcpp::WallRate(1e-4).sleep();
  throw std::invalid_argument("waits: found '" + how + "'");
}

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  bool interrupted = false;
  try {
    interrupted = wait(argv[1]);
  } catch (const std::runtime_error&) {
    if (rclcpp::ok()) throw;
    interrupted = true;  // the signal came first: no sleep begins in a context that has ended
  }
  if (interrupted) std::cout << "interrupted\n";
  rclcpp::shutdown();
}
