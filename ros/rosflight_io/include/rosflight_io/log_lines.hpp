// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <rclcpp/rclcpp.hpp>

#include "companion/listener.hpp"
#include "rosflight_io/zero_commands.hpp"

namespace rosflight_io {

/// What happens on the link, told in the node's log: the autopilot's own lines, changes of its
/// status, the connection, the version, commands that stop the motors. Called by the link's thread.
class LogLines final : public rosflight::companion::Listener {
 public:
  explicit LogLines(rclcpp::Logger logger) : logger_{std::move(logger)} {}

  void on_status(const rosflight::link::Status& m, const rosflight::companion::Stamp&) override;
  void on_event(const rosflight::companion::Event& event) override;
  void on_sent(const rosflight::link::Message& message, rosflight::companion::Time now) override;

 private:
  void tell(const rosflight::companion::ConnectionEvent& event);
  void tell(const rosflight::companion::LogEvent& event);
  void tell(const rosflight::companion::VersionEvent& event);

  rclcpp::Logger logger_;
  std::optional<rosflight::link::Status> last_;
  ZeroCommands zeros_;
};

}  // namespace rosflight_io
