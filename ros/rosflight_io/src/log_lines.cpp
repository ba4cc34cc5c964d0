// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/log_lines.hpp"

#include <string>

#include "companion/status_text.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;

namespace {

/// The firmware's text about a value that it refuses, once for each time the value is sent (firmware/core/firmware_link.cpp).
/// Only this node sends values, and it logs each refusal itself, once, with the value.
constexpr const char* kRefusal = "Out of range, kept: ";

}  // namespace

void LogLines::on_status(const rosflight::link::Status& m, const companion::Stamp& /*stamp*/) {
  const rosflight::link::Status before = last_.value_or(rosflight::link::Status{});
  last_ = m;
  if (m.armed != before.armed) zeros_.set_armed(m.armed);
  if (m.armed != before.armed) RCLCPP_WARN(logger_, m.armed ? "Armed" : "Disarmed");
  if (m.failsafe && !before.failsafe) RCLCPP_ERROR(logger_, "Failsafe");
  if (!m.failsafe && before.failsafe) RCLCPP_WARN(logger_, "Failsafe over");
  const bool overridden = m.rc_override != 0;
  if (overridden != (before.rc_override != 0)) {
    RCLCPP_WARN(logger_, overridden ? "The pilot overrides" : "The pilot has given control back");
  }
  if (m.offboard != before.offboard) {
    RCLCPP_WARN(logger_, m.offboard ? "The computer has control" : "The computer has lost control");
  }
  if (m.control_mode != before.control_mode) {
    RCLCPP_WARN(logger_, "Control mode: %s", companion::control_mode_text(m.control_mode));
  }
  for (int bit = 0; companion::error_text(bit) != nullptr; ++bit) {
    const int mask = 1 << bit;
    const bool on = (m.error_code & mask) != 0;
    if (on == ((before.error_code & mask) != 0)) continue;
    if (on) {
      RCLCPP_ERROR(logger_, "Autopilot error: %s", companion::error_text(bit));
    } else {
      RCLCPP_INFO(logger_, "Autopilot error over: %s", companion::error_text(bit));
    }
  }
}

void LogLines::on_sent(const rosflight::link::Message& message, companion::Time now) {
  const auto* command = std::get_if<rosflight::link::OffboardControl>(&message);
  const int zeros = command != nullptr ? zeros_.take(*command, now) : 0;
  if (zeros > 0)
    RCLCPP_WARN(logger_,
                "pass-through commands in flight that are all zeros, which stops the motors: %d",
                zeros);
}

void LogLines::on_event(const companion::Event& event) {
  if (const auto* connection = std::get_if<companion::ConnectionEvent>(&event)) tell(*connection);
  if (const auto* line = std::get_if<companion::LogEvent>(&event)) tell(*line);
  if (const auto* version = std::get_if<companion::VersionEvent>(&event)) tell(*version);
  if (const auto* schema = std::get_if<companion::SchemaEvent>(&event)) {
    RCLCPP_ERROR(logger_, "%s", companion::schema_text(*schema).c_str());
  }
  if (const auto* jump = std::get_if<companion::ClockJumpEvent>(&event)) {
    RCLCPP_WARN(logger_, "The autopilot's clock jumped by %.3f s",
                companion::to_seconds(jump->new_offset - jump->old_offset));
  }
  if (const auto* list = std::get_if<companion::ParameterListEvent>(&event)) {
    if (list->complete) RCLCPP_INFO(logger_, "All %zu parameters received", list->count);
  }
}

void LogLines::tell(const companion::ConnectionEvent& event) {
  switch (event.change) {
    case companion::ConnectionChange::kConnected:
      RCLCPP_INFO(logger_, "An autopilot is at the other end");
      break;
    case companion::ConnectionChange::kLost:
      RCLCPP_ERROR(logger_, "The autopilot is silent");
      last_.reset();
      break;
    case companion::ConnectionChange::kRestarted:
      RCLCPP_WARN(logger_, "The autopilot has restarted");
      last_.reset();
      break;
    case companion::ConnectionChange::kLinkOpened:
    case companion::ConnectionChange::kLinkClosed:
      break;  // the transport says it better
  }
}

void LogLines::tell(const companion::LogEvent& event) {
  const std::string text{companion::text_of(event.line.text)};
  if (text.rfind(kRefusal, 0) == 0) return;
  switch (event.line.severity) {
    case rosflight::link::Severity::kCritical:
    case rosflight::link::Severity::kError:
      RCLCPP_ERROR(logger_, "[Autopilot]: %s", text.c_str());
      break;
    case rosflight::link::Severity::kWarning:
      RCLCPP_WARN(logger_, "[Autopilot]: %s", text.c_str());
      break;
    case rosflight::link::Severity::kInfo:
      RCLCPP_INFO(logger_, "[Autopilot]: %s", text.c_str());
      break;
  }
}

void LogLines::tell(const companion::VersionEvent& event) {
  const std::string text{companion::text_of(event.version.text)};
  if (event.match == companion::VersionMatch::kSame) {
    RCLCPP_INFO(logger_, "Autopilot version %s fits", text.c_str());
  } else {
    RCLCPP_WARN(logger_, "Autopilot version %s is not the one this node is made for", text.c_str());
  }
}

}  // namespace rosflight_io
