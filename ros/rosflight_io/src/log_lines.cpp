// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/log_lines.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "companion/status_text.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;

namespace {

/// The firmware's text about a value that it refuses, once for each time the value is sent (firmware/core/firmware_link.cpp).
/// Only this node sends values, and it logs each refusal itself, once, with the value.
constexpr const char* kRefusal = "Out of range, kept: ";

/// How the firmware begins what it says at each start and each load of parameters: of its mixers and switches, whose faults are
/// errors in its status, and of calibrations, whose callers get the same words as an answer. Logged as DEBUG.
constexpr const char* kSetUp[] = {"No mixer: set PRIMARY_MIXER",
                                  "No secondary mixer",
                                  "Primary mixer ",
                                  "Secondary mixer ",
                                  "arm switch ",
                                  "attitude override switch ",
                                  "throttle override switch ",
                                  "attitude type switch ",
                                  "Unable to load parameters, using defaults",
                                  "Longest period: ",
                                  "IMU offsets captured",
                                  "Gyro calibration complete",
                                  "Baro Cal successful!",
                                  "Airspeed Cal Successful!"};

/// Errors of parameters that were not set yet: invalid mixer, IMU uncalibrated, invalid failsafe throttle.
constexpr std::uint8_t kSetUpErrors = 0x01 | 0x20 | 0x80;

bool begins_with(const std::string& text, const char* words) {
  return text.rfind(words, 0) == 0;
}

bool about_set_up(const std::string& text) {
  return std::any_of(std::begin(kSetUp), std::end(kSetUp),
                     [&](const char* words) { return begins_with(text, words); });
}

}  // namespace

void LogLines::on_status(const rosflight::link::Status& m, const companion::Stamp& /*stamp*/) {
  const rosflight::link::Status before = last_ ? *last_ : first(m);
  last_ = m;
  if (m.armed != before.armed) zeros_.set_armed(m.armed);
  if (m.armed != before.armed) RCLCPP_WARN(logger_, m.armed ? "Armed" : "Disarmed");
  if (m.failsafe && !before.failsafe) RCLCPP_ERROR(logger_, "Failsafe");
  if (!m.failsafe && before.failsafe) RCLCPP_WARN(logger_, "Failsafe over");
  if (m.armed) log_control(m, before);
  log_errors(m.error_code, before.error_code, m.armed);
}

rosflight::link::Status LogLines::first(const rosflight::link::Status& m) {
  rosflight::link::Status before{};
  before.rc_override = m.rc_override;
  before.offboard = m.offboard;
  before.control_mode = m.control_mode;
  not_ready_ = m.armed ? std::uint8_t{0} : m.error_code;
  before.error_code = not_ready_;
  if (not_ready_ != 0)
    RCLCPP_WARN(logger_, "Not ready to be armed: %s", companion::error_texts(not_ready_).c_str());
  return before;
}

void LogLines::log_control(const rosflight::link::Status& m,
                           const rosflight::link::Status& before) {
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
}

void LogLines::log_errors(std::uint8_t now, std::uint8_t before, bool armed) {
  const auto over = static_cast<std::uint8_t>(not_ready_ & ~now);
  const auto set_up = static_cast<std::uint8_t>(armed ? 0 : now & ~before & kSetUpErrors);
  if (set_up != 0)
    RCLCPP_WARN(logger_, "Not ready to be armed: %s", companion::error_texts(set_up).c_str());
  not_ready_ = static_cast<std::uint8_t>((not_ready_ & now) | set_up);
  if (over != 0 && not_ready_ == 0)
    RCLCPP_INFO(logger_, "%sthese errors are over", now == 0 ? "Ready to be armed: " : "");
  for (int bit = 0; companion::error_text(bit) != nullptr; ++bit) {
    const int mask = 1 << bit;
    const bool on = (now & mask) != 0;
    if (on == ((before & mask) != 0) || ((over | set_up) & mask) != 0) continue;
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
  if (const auto* connection = std::get_if<companion::ConnectionEvent>(&event)) log(*connection);
  if (const auto* line = std::get_if<companion::LogEvent>(&event)) log(*line);
  if (const auto* version = std::get_if<companion::VersionEvent>(&event)) log(*version);
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

void LogLines::log(const companion::ConnectionEvent& event) {
  switch (event.change) {
    case companion::ConnectionChange::kConnected:
      if (std::exchange(met_, true)) RCLCPP_INFO(logger_, "The autopilot is back");
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

void LogLines::log(const companion::LogEvent& event) {
  const std::string text{companion::text_of(event.line.text)};
  if (begins_with(text, kRefusal)) return;
  if (about_set_up(text)) {
    RCLCPP_DEBUG(logger_, "[Autopilot]: %s", text.c_str());
    return;
  }
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

void LogLines::log(const companion::VersionEvent& event) {
  const std::string text{companion::text_of(event.version.text)};
  if (event.match == companion::VersionMatch::kSame) {
    RCLCPP_INFO(logger_, "Autopilot version %s fits", text.c_str());
  } else {
    RCLCPP_WARN(logger_, "Autopilot version %s is not the one this node is made for", text.c_str());
  }
}

}  // namespace rosflight_io
