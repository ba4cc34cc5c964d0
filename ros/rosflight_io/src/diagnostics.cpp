// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/diagnostics.hpp"

#include <array>
#include <cstdio>

#include "companion/status_text.hpp"

namespace rosflight_io {
namespace {

namespace companion = rosflight::companion;
using diagnostic_msgs::msg::DiagnosticStatus;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

void add(DiagnosticStatus& status, const std::string& key, const std::string& value) {
  diagnostic_msgs::msg::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

void add(DiagnosticStatus& status, const std::string& key, std::uint64_t value) {
  add(status, key, std::to_string(value));
}

void judge(DiagnosticStatus& status, unsigned char level, const std::string& message) {
  status.level = level;
  status.message = message;
}

void link_status(companion::Session& session, DiagnosticStatus& status) {
  const companion::LinkStatistics& s = session.statistics();
  if (session.connected()) {
    judge(status, DiagnosticStatus::OK, "connected");
  } else {
    judge(status, DiagnosticStatus::ERROR, "no autopilot at the other end");
  }
  add(status, "received bytes/s", number(s.receive_rate_bytes_s));
  add(status, "sent bytes/s", number(s.send_rate_bytes_s));
  add(status, "frames received", s.frames.frames_received);
  add(status, "frames dropped", s.frames.frames_dropped);
  add(status, "sequence gaps", s.frames.sequence_gaps);
  add(status, "send failures", s.send_failures);
  add(status, "connections", s.connections);
  add(status, "restarts of the autopilot", s.restarts);
}

void clock_status(companion::Session& session, DiagnosticStatus& status) {
  const companion::TimeSync::Figures& f = session.time_sync().figures();
  if (session.time_sync().synchronised()) {
    judge(status, DiagnosticStatus::OK, "synchronised");
  } else {
    judge(status, DiagnosticStatus::WARN, "not synchronised: stamps are times of arrival");
  }
  add(status, "round trip [ms]", number(1e3 * companion::to_seconds(f.round_trip)));
  add(status, "error at most [ms]", number(1e3 * companion::to_seconds(f.error_bound)));
  add(status, "jitter [ms]", number(1e3 * companion::to_seconds(f.jitter)));
  add(status, "drift [ppm]", number(f.drift_ppm));
  add(status, "jumps", f.jumps);
}

void parameter_status(companion::Session& session, DiagnosticStatus& status) {
  const companion::ParameterClient& parameters = session.parameters();
  if (!parameters.complete()) {
    judge(status, DiagnosticStatus::WARN, "list not complete");
  } else if (parameters.unsaved()) {
    judge(status, DiagnosticStatus::WARN, "changes are not in non-volatile memory");
  } else {
    judge(status, DiagnosticStatus::OK, "all received");
  }
  add(status, "known", parameters.table().known());
  add(status, "count", parameters.table().count());
}

void vehicle_status(companion::Session& session, DiagnosticStatus& status) {
  const auto& latest = session.streams().status;
  if (latest.count == 0) {
    judge(status, DiagnosticStatus::STALE, "no status yet");
    return;
  }
  const rosflight::link::Status& s = latest.value;
  const std::string errors = companion::error_texts(s.error_code);
  if (s.failsafe) {
    judge(status, DiagnosticStatus::ERROR, "failsafe");
  } else if (!errors.empty()) {
    judge(status, s.armed ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN, errors);
  } else {
    judge(status, DiagnosticStatus::OK, s.armed ? "armed" : "disarmed");
  }
  add(status, "control mode", companion::control_mode_text(s.control_mode));
  add(status, "offboard", s.offboard ? "yes" : "no");
  add(status, "override word", s.rc_override);
  add(status, "loop time [us]", std::to_string(s.loop_time_us));
  add(status, "sensor errors", std::to_string(s.sensor_errors));
}

}  // namespace

diagnostic_msgs::msg::DiagnosticArray diagnostics_of(companion::Session& session,
                                                     const std::string& node,
                                                     const std::string& link_name) {
  struct Part {
    const char* name;
    void (*fill)(companion::Session&, DiagnosticStatus&);
  };
  constexpr std::array<Part, 4> kParts{{{"link", link_status},
                                        {"clock", clock_status},
                                        {"parameters", parameter_status},
                                        {"vehicle", vehicle_status}}};
  diagnostic_msgs::msg::DiagnosticArray array;
  for (const Part& part : kParts) {
    DiagnosticStatus status;
    status.name = node + ": " + part.name;
    status.hardware_id = link_name;
    part.fill(session, status);
    array.status.push_back(status);
  }
  return array;
}

}  // namespace rosflight_io
