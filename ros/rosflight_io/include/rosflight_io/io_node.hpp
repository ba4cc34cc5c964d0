// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <thread>

#include "companion/asio/runner.hpp"
#include "link/detect/detecting_codec.hpp"
#include "rosflight_io/clock.hpp"
#include "rosflight_io/log_lines.hpp"
#include "rosflight_io/parameter_mirror.hpp"
#include "rosflight_io/services.hpp"
#include "rosflight_io/stream_publisher.hpp"

namespace rosflight_io {

/// The companion's end of the serial link as a ROS 2 node: streams become topics, setpoints become
/// frames, parameters and commands become ROS parameters and services.
///
/// Two threads: the link's, which runs the companion library and publishes, and the node's, which
/// takes commands and requests and hands them over. Topics, services and parameters are those of
/// ROSflight 2.x; docs/compatibility-ros.md lists what differs.
class IoNode final : public rclcpp::Node {
 public:
  /// Opens the link. @throws rosflight::companion::LinkError for a link that cannot be, rclcpp's
  /// exceptions for parameters of the wrong type.
  explicit IoNode(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());
  ~IoNode() override;
  /// The link ended by itself and took ROS down with it.
  bool link_failed() const { return link_failed_; }

 private:
  rosflight::companion::LinkSpec read_link();
  void subscribe();
  /// Sends what arrives on `topic`. @tparam Message  the type of messages/ beside Ros.
  template <class Message, class Ros>
  void forward(const char* topic, const rclcpp::QoS& qos);
  /// Starts the link's thread, at the first tick of the clock.
  void start_link();
  void run_link();
  void look_after();
  void diagnose();

  Clock clock_;
  rosflight::link::DetectingCodec codec_;
  rosflight::companion::Runner runner_;
  StreamPublisher streams_;
  LogLines log_lines_;
  ParameterMirror parameters_;
  Services services_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr diagnostics_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  rclcpp::TimerBase::SharedPtr look_after_timer_;
  rclcpp::TimerBase::SharedPtr diagnose_timer_;
  std::atomic<bool> has_baro_{false};
  std::atomic<bool> has_airspeed_{false};
  std::atomic<bool> link_failed_{false};
  std::atomic<bool> link_runs_{false};
  std::thread link_;
  rclcpp::CallbackGroup::SharedPtr
      commands_;  ///< A command does not wait for the answer to a parameter.
};

}  // namespace rosflight_io
