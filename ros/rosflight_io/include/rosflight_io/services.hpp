// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/srv/param_file.hpp>
#include <rosflight_msgs/srv/param_get.hpp>
#include <rosflight_msgs/srv/param_set.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <vector>

#include "companion/asio/runner.hpp"
#include "companion/mag_calibration.hpp"

namespace rosflight_io {

/// The services of the node. Each answers when the outcome is known, not when the request is sent;
/// meanwhile the node goes on. Requests are handed to the link's thread, which also answers.
class Services {
 public:
  Services(rclcpp::Node& node, rosflight::companion::Runner& runner);

  /// Calibrations of sensors that are there: made when their first sample has come.
  void offer_baro();
  void offer_airspeed();

 private:
  using Trigger = std_srvs::srv::Trigger;
  using Session = rosflight::companion::Session;

  template <class Service>
  using Reply = std::function<void(typename Service::Response)>;
  /// Runs in the link's thread; calls `reply` once, now or later.
  template <class Service>
  using Handler =
      std::function<void(Session&, const typename Service::Request&, Reply<Service> reply)>;

  template <class Service>
  void offer(const std::string& name, Handler<Service> handler);
  void offer_command(const std::string& name, rosflight::link::Command command);
  void offer_parameters();
  void offer_files();

  rclcpp::Node& node_;
  rosflight::companion::Runner& runner_;
  rosflight::companion::MagCalibration mag_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  bool has_baro_{false};
  bool has_airspeed_{false};
};

}  // namespace rosflight_io
