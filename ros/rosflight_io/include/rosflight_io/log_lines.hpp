// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <rclcpp/rclcpp.hpp>

#include "companion/listener.hpp"
#include "rosflight_io/zero_commands.hpp"

namespace rosflight_io {

/// What happens on the link, reported in the node's log: the autopilot's own lines, changes of its
/// status, the connection, the version, commands that stop the motors. Called by the link's thread.
///
/// A healthy start is a few lines: disarmed, errors of the first status and those of parameters are one warning, their end one line;
/// who has control is reported while armed; texts of the firmware about its parameters are DEBUG.
class LogLines final : public rosflight::companion::Listener {
 public:
  explicit LogLines(rclcpp::Logger logger) : logger_{std::move(logger)} {}

  void on_status(const rosflight::link::Status& m, const rosflight::companion::Stamp&) override;
  void on_event(const rosflight::companion::Event& event) override;
  void on_sent(const rosflight::link::Message& message, rosflight::companion::Time now) override;

 private:
  /// What the first status is compared with; its errors are reported here, in one line.
  rosflight::link::Status first(const rosflight::link::Status& m);
  void log_control(const rosflight::link::Status& m, const rosflight::link::Status& before);
  void log_errors(std::uint8_t now, std::uint8_t before, bool armed);
  void log(const rosflight::companion::ConnectionEvent& event);
  void log(const rosflight::companion::LogEvent& event);
  void log(const rosflight::companion::VersionEvent& event);

  rclcpp::Logger logger_;
  std::optional<rosflight::link::Status> last_;
  std::uint8_t not_ready_{0};  ///< Errors that were reported as `not ready` and are not over yet.
  bool met_{false};            ///< There was an autopilot at the other end before.
  ZeroCommands zeros_;
};

}  // namespace rosflight_io
