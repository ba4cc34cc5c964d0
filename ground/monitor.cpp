// SPDX-License-Identifier: BSD-3-Clause
#include "ground/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "base/constants.hpp"
#include "companion/status_text.hpp"

namespace rosflight::ground {
namespace {

using companion::Latest;
using companion::to_seconds;
using Json = nlohmann::ordered_json;

constexpr double kDegrees = base::kDegPerRad;
constexpr std::array<const char*, 6> kFixes{"no fix", "no fix", "2D", "3D", "DGNSS", "RTK"};

struct Euler {
  double roll_deg{};
  double pitch_deg{};
  double yaw_deg{};
};

double scaled(double factor, float value) {
  return factor * static_cast<double>(value);
}

/// Yaw, pitch and roll in this order (3-2-1), from north-east-down to the body.
Euler euler(const std::array<float, 4>& q_WB) {
  const double w = scaled(1.0, q_WB[0]), x = scaled(1.0, q_WB[1]);
  const double y = scaled(1.0, q_WB[2]), z = scaled(1.0, q_WB[3]);
  const double sine = std::clamp(2.0 * (w * y - z * x), -1.0, 1.0);
  return {kDegrees * std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          kDegrees * std::asin(sine),
          kDegrees * std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

const char* fix_text(std::uint8_t fix) {
  return kFixes[std::min<std::size_t>(fix, kFixes.size() - 1)];
}

/// Share of the vehicle's frames that did not arrive, in percent.
double loss_percent(const link::Codec::Counters& frames) {
  const double all = static_cast<double>(frames.frames_received) + frames.sequence_gaps;
  return all > 0.0 ? 100.0 * frames.sequence_gaps / all : 0.0;
}

const char* severity_text(link::Severity severity) {
  switch (severity) {
    case link::Severity::kCritical:
      return "critical";
    case link::Severity::kError:
      return "error";
    case link::Severity::kWarning:
      return "warning";
    case link::Severity::kInfo:
      break;
  }
  return "info";
}

/// The message as JSON, null if none was received.
template <class T, class F>
Json object(const Latest<T>& latest, F&& fields) {
  if (latest.count == 0) return {};
  Json json = fields(latest.value);
  json["rate_Hz"] = latest.rate_hz;
  return json;
}

template <class T, class F>
std::string row(const char* name, const Latest<T>& latest, F&& text) {
  if (latest.count == 0) return fmt::format("{:<10} not received\n", name);
  return fmt::format("{:<10} {:<58} {:>5.0f} Hz\n", name, text(latest.value), latest.rate_hz);
}

Json json_of(const Monitor::Text& text) {
  return {{"severity", severity_text(text.line.severity)},
          {"text", companion::text_of(text.line.text)}};
}

std::string channels_text(const link::RcChannels& rc) {
  std::string text;
  const auto count = std::min<std::size_t>(rc.count, rc.pulse_us.size());
  for (std::size_t k = 0; k < count; ++k) text += fmt::format("{} ", rc.pulse_us[k]);
  return text;
}

}  // namespace

void Monitor::on_event(const companion::Event& event) {
  const auto* log = std::get_if<companion::LogEvent>(&event);
  if (log == nullptr) return;
  for (auto* list : {&texts_, &new_texts_}) {
    list->push_back({log->time, log->line});
    if (list->size() > kTexts) list->pop_front();
  }
}

std::string Monitor::state_text() const {
  const auto& latest = session_.streams().status;
  if (latest.count == 0) return "state unknown";
  const link::Status& s = latest.value;
  const std::string errors = companion::error_texts(s.error_code);
  return fmt::format("{}{}, {}{}{}; {}", s.armed ? "ARMED" : "disarmed",
                     s.failsafe ? ", FAILSAFE" : "", companion::control_mode_text(s.control_mode),
                     s.offboard ? ", offboard" : "", s.rc_override != 0 ? ", RC override" : "",
                     errors.empty() ? "no error" : "errors: " + errors);
}

std::string Monitor::link_text() {
  if (!session_.connected()) return "NO ANSWER";
  const auto& s = session_.statistics();
  const auto& clock = session_.time_sync().figures();
  return fmt::format(
      "{:.1f} kB/s in, {:.1f} out, loss {:.2f} %, drift {:+.1f} ppm, delay {:.2f} ms",
      1e-3 * s.receive_rate_bytes_s, 1e-3 * s.send_rate_bytes_s, loss_percent(s.frames),
      clock.drift_ppm, 1e3 * to_seconds(clock.round_trip));
}

std::string Monitor::screen() {
  const auto& s = session_.streams();
  std::string text = fmt::format(
      "{:<10} {}\n", "firmware",
      session_.firmware_version().empty() ? "version not received" : session_.firmware_version());
  text += fmt::format("{:<10} {}\n{:<10} {}\n", "link", link_text(), "state", state_text());
  text += row("attitude", s.attitude, [](const link::Attitude& m) {
    const Euler e = euler(m.q_WB);
    return fmt::format("roll {:+7.2f}  pitch {:+7.2f}  yaw {:+7.2f} deg", e.roll_deg, e.pitch_deg,
                       e.yaw_deg);
  });
  text += row("rates", s.attitude, [](const link::Attitude& m) {
    return fmt::format("p {:+7.2f}  q {:+7.2f}  r {:+7.2f} deg/s",
                       scaled(kDegrees, m.rates_rad_s[0]), scaled(kDegrees, m.rates_rad_s[1]),
                       scaled(kDegrees, m.rates_rad_s[2]));
  });
  text += row("IMU", s.imu, [](const link::Imu& m) {
    return fmt::format("accel {:+6.2f} {:+6.2f} {:+6.2f} m/s^2  {:.1f} K", m.accel_m_s2[0],
                       m.accel_m_s2[1], m.accel_m_s2[2], m.temperature_K);
  });
  text += row("mag", s.mag, [](const link::Mag& m) {
    return fmt::format("{:+6.1f} {:+6.1f} {:+6.1f} uT", scaled(1e6, m.field_T[0]),
                       scaled(1e6, m.field_T[1]), scaled(1e6, m.field_T[2]));
  });
  text += row("baro", s.baro, [](const link::Baro& m) {
    return fmt::format("{:.2f} m  {:.0f} Pa", m.altitude_m, m.pressure_Pa);
  });
  text += row("airspeed", s.diff_pressure, [](const link::DiffPressure& m) {
    return fmt::format("{:.1f} m/s  {:.1f} Pa", m.airspeed_m_s, m.pressure_Pa);
  });
  text += row("range", s.range,
              [](const link::Range& m) { return fmt::format("{:.2f} m", m.range_m); });
  text += row("GNSS", s.gnss, [](const link::Gnss& m) {
    return fmt::format("{}, {} satellites, {:.7f} {:.7f} deg, {:.1f} m", fix_text(m.fix),
                       m.satellites, m.latitude_deg, m.longitude_deg, m.height_msl_m);
  });
  text += row("battery", s.battery, [](const link::BatteryStatus& m) {
    return fmt::format("{:.2f} V  {:.1f} A", m.voltage_V, m.current_A);
  });
  text += row("RC", s.rc, channels_text);
  text += row("outputs", s.output, [](const link::OutputRaw& m) {
    std::string values;
    for (std::size_t k = 0; k < 8; ++k) values += fmt::format("{:.3f} ", m.values[k]);
    return values;
  });
  for (const Text& t : texts_) {
    text +=
        fmt::format("{:<10} {}\n", severity_text(t.line.severity), companion::text_of(t.line.text));
  }
  return text;
}

std::string Monitor::line() {
  const auto& s = session_.streams();
  const Euler e = euler(s.attitude.value.q_WB);
  std::string text = s.attitude.count == 0
                         ? "attitude -"
                         : fmt::format("roll {:+.1f} pitch {:+.1f} yaw {:+.1f} deg", e.roll_deg,
                                       e.pitch_deg, e.yaw_deg);
  text +=
      s.battery.count == 0 ? " | battery -" : fmt::format(" | {:.2f} V", s.battery.value.voltage_V);
  text += s.gnss.count == 0
              ? " | GNSS -"
              : fmt::format(" | {}, {} sat", fix_text(s.gnss.value.fix), s.gnss.value.satellites);
  text += s.rc.count == 0 ? " | RC -" : " | RC " + channels_text(s.rc.value);
  while (text.ends_with(' ')) text.pop_back();
  text += " | " + state_text() + " | " + link_text();
  for (const Text& t : new_texts_) {
    text +=
        fmt::format(" | {}: {}", severity_text(t.line.severity), companion::text_of(t.line.text));
  }
  new_texts_.clear();
  return text;
}

std::string Monitor::json() {
  const auto& s = session_.streams();
  const auto& link = session_.statistics();
  const auto& clock = session_.time_sync().figures();
  Json j;
  j["connected"] = session_.connected();
  j["firmware"] = session_.firmware_version();
  j["link"] = {{"receive_bytes_s", link.receive_rate_bytes_s},
               {"send_bytes_s", link.send_rate_bytes_s},
               {"frames_received", link.frames.frames_received},
               {"frames_lost", link.frames.sequence_gaps},
               {"frames_rejected", link.frames.frames_dropped},
               {"loss_percent", loss_percent(link.frames)},
               {"synchronised", session_.time_sync().synchronised()},
               {"drift_ppm", clock.drift_ppm},
               {"round_trip_ms", 1e3 * to_seconds(clock.round_trip)},
               {"jitter_ms", 1e3 * to_seconds(clock.jitter)}};
  j["state"] = object(s.status, [](const link::Status& m) -> Json {
    Json errors = Json::array();
    for (int bit = 0; companion::error_text(bit) != nullptr; ++bit) {
      if ((m.error_code >> bit & 1) != 0) errors.push_back(companion::error_text(bit));
    }
    return {{"armed", m.armed},
            {"failsafe", m.failsafe},
            {"offboard", m.offboard},
            {"control_mode", companion::control_mode_text(m.control_mode)},
            {"rc_override", m.rc_override},
            {"errors", errors},
            {"sensor_errors", m.sensor_errors},
            {"loop_time_us", m.loop_time_us}};
  });
  j["attitude"] = object(s.attitude, [](const link::Attitude& m) -> Json {
    const Euler e = euler(m.q_WB);
    return {{"roll_deg", e.roll_deg},
            {"pitch_deg", e.pitch_deg},
            {"yaw_deg", e.yaw_deg},
            {"rates_rad_s", m.rates_rad_s}};
  });
  j["imu"] = object(s.imu, [](const link::Imu& m) -> Json {
    return {{"accel_m_s2", m.accel_m_s2},
            {"gyro_rad_s", m.gyro_rad_s},
            {"temperature_K", m.temperature_K}};
  });
  j["mag"] = object(s.mag, [](const link::Mag& m) -> Json { return {{"field_T", m.field_T}}; });
  j["baro"] = object(s.baro, [](const link::Baro& m) -> Json {
    return {{"altitude_m", m.altitude_m}, {"pressure_Pa", m.pressure_Pa}};
  });
  j["airspeed"] = object(s.diff_pressure, [](const link::DiffPressure& m) -> Json {
    return {{"airspeed_m_s", m.airspeed_m_s}, {"pressure_Pa", m.pressure_Pa}};
  });
  j["range"] =
      object(s.range, [](const link::Range& m) -> Json { return {{"range_m", m.range_m}}; });
  j["gnss"] = object(s.gnss, [](const link::Gnss& m) -> Json {
    return {{"fix", m.fix},
            {"satellites", m.satellites},
            {"latitude_deg", m.latitude_deg},
            {"longitude_deg", m.longitude_deg},
            {"height_msl_m", m.height_msl_m},
            {"velocity_ned_m_s", m.velocity_ned_m_s}};
  });
  j["battery"] = object(s.battery, [](const link::BatteryStatus& m) -> Json {
    return {{"voltage_V", m.voltage_V}, {"current_A", m.current_A}};
  });
  j["rc"] = object(s.rc, [](const link::RcChannels& m) -> Json {
    const auto count = std::min<std::size_t>(m.count, m.pulse_us.size());
    return {{"pulse_us",
             std::vector<int>(m.pulse_us.begin(), m.pulse_us.begin() + static_cast<long>(count))},
            {"rssi", m.rssi}};
  });
  j["outputs"] =
      object(s.output, [](const link::OutputRaw& m) -> Json { return {{"values", m.values}}; });
  j["texts"] = Json::array();
  for (const Text& t : new_texts_) j["texts"].push_back(json_of(t));
  new_texts_.clear();
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);  // texts may be garbled
}

int monitor(GroundLink& link, const MonitorOptions& options, std::ostream& out) {
  constexpr const char* kHome = "\033[H";
  constexpr const char* kEraseLine = "\033[K\n";
  constexpr const char* kEraseBelow = "\033[J";
  Monitor view(link.session());
  // Rates are counted over a second; before, they would be 0.
  link.run_for(std::chrono::milliseconds{1200});
  const auto period =
      std::chrono::duration_cast<Time>(std::chrono::duration<double>(options.period_s));
  if (options.in_place && !options.once) out << "\033[2J";
  for (;;) {
    if (options.json) {
      out << view.json() << "\n";
    } else if (options.once) {
      out << view.screen();
    } else if (options.in_place) {
      std::string screen = view.screen();
      for (std::size_t at = 0; (at = screen.find('\n', at)) != std::string::npos;) {
        screen.replace(at, 1, kEraseLine);
        at += std::string_view(kEraseLine).size();
      }
      out << kHome << screen << "Ctrl-C ends" << kEraseLine << kEraseBelow;
    } else {
      out << view.line() << "\n";
    }
    out << std::flush;
    if (options.once || !out) return 0;
    try {
      link.run_for(period);
    } catch (const Stopped&) {
      return 0;
    }
  }
}

}  // namespace rosflight::ground
