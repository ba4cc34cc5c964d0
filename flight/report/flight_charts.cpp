// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/flight_charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "flight/report/estimate_charts.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

using base::kDegPerRad;
constexpr std::array kAngles{"Roll", "Pitch", "Yaw"};
constexpr std::array kRates{"Roll rate", "Pitch rate", "Yaw rate"};

void append_position(std::string& html, const FlightRecord& record) {
  constexpr std::array kNames{"North", "East", "Height"};
  for (std::size_t k = 0; k < 3; ++k) {
    const float sign = k == 2 ? -1.0F : 1.0F;
    TimeChart chart({kNames[k], "m", 2.0, 2, {}, {}}, record);
    chart.add("setpoint", CurveStyle::kCommand,
              [&](const Sample& s) { return sign * s.setpoint_W_m[k]; });
    chart.add("flown", CurveStyle::kActual, [&](const Sample& s) { return sign * s.p_W_m[k]; });
    chart.add("estimate", CurveStyle::kEstimate,
              [&](const Sample& s) { return sign * s.estimate.p_W_m[k]; });
    chart.append_to(html);
  }
}

void append_error_and_speed(std::string& html, const FlightRecord& record) {
  TimeChart error({"Distance from setpoint", "m", 0.2, 3, {}, {}}, record);
  error.add("across ground", CurveStyle::kActual, [](const Sample& s) {
    return std::hypot(s.p_W_m[0] - s.setpoint_W_m[0], s.p_W_m[1] - s.setpoint_W_m[1]);
  });
  error.add("in height", CurveStyle::kEstimate,
            [](const Sample& s) { return std::abs(s.p_W_m[2] - s.setpoint_W_m[2]); });
  error.append_to(html);

  TimeChart speed({"Speed over ground", "m/s", 1.0, 2, {}, {}}, record);
  speed.add("flown", CurveStyle::kActual,
            [](const Sample& s) { return std::hypot(s.v_W_m_s[0], s.v_W_m_s[1]); });
  speed.append_to(html);
  TimeChart climb({"Climb", "m/s", 1.0, 2, {}, {}}, record);
  climb.add("flown", CurveStyle::kActual, [](const Sample& s) { return -s.v_W_m_s[2]; });
  climb.append_to(html);
}

void append_angle(std::string& html, const FlightRecord& record, std::size_t k) {
  constexpr std::size_t kYaw = 2;
  auto actual = column(record, [k](const Sample& s) { return s.attitude_rad[k]; });
  auto command = column(record, [k](const Sample& s) { return s.attitude_command_rad[k]; });
  auto firmware = column(record, [k](const Sample& s) { return s.firmware_rad[k]; });
  if (k == kYaw) {
    actual = unwrapped(std::move(actual));
    command = unwrapped(std::move(command), &actual);
    firmware = unwrapped(std::move(firmware), &actual);
  }
  for (auto* values : {&actual, &command, &firmware}) {
    for (double& value : *values) value *= kDegPerRad;
  }
  TimeChart chart({kAngles[k], "°", 4.0, 2, {}, {}}, record);
  chart.add("command", CurveStyle::kCommand, std::move(command));
  chart.add("true", CurveStyle::kActual, std::move(actual));
  chart.add("firmware", CurveStyle::kEstimate, std::move(firmware));
  chart.append_to(html);
}

void append_rate(std::string& html, const FlightRecord& record, std::size_t k) {
  TimeChart chart({kRates[k], "°/s", 10.0, 1, {}, {}}, record);
  chart.add("command", CurveStyle::kCommand,
            [k](const Sample& s) { return s.rate_command_rad_s[k] * kDegPerRadF; });
  chart.add("true", CurveStyle::kActual,
            [k](const Sample& s) { return s.rates_rad_s[k] * kDegPerRadF; });
  chart.append_to(html);
}

void append_motors(std::string& html, const FlightRecord& record) {
  TimeChart outputs({"Motor outputs", "of full", 1.0, 2, 0.0, 1.0}, record);
  TimeChart speeds({"Rotor speeds", "rad/s", 10.0, 0, {}, {}}, record);
  for (std::size_t k = 0; k < std::min(record.motor_count, kMaxMotors); ++k) {
    const std::string name = std::to_string(k + 1);
    outputs.add(name, CurveStyle::kNumbered, [k](const Sample& s) { return s.motors[k]; });
    speeds.add(name, CurveStyle::kNumbered, [k](const Sample& s) { return s.rotors_rad_s[k]; });
  }
  outputs.append_to(html);
  speeds.append_to(html);
}

void append_battery(std::string& html, const FlightRecord& record) {
  TimeChart voltage({"Battery voltage", "V", 1.0, 2, {}, {}}, record);
  voltage.add("voltage", CurveStyle::kActual, [](const Sample& s) { return s.battery_V; });
  voltage.append_to(html);
  TimeChart current({"Battery current", "A", 2.0, 2, {}, {}}, record);
  current.add("current", CurveStyle::kActual, [](const Sample& s) { return s.battery_A; });
  current.append_to(html);
}

}  // namespace

std::vector<double> unwrapped(std::vector<double> angles, const std::vector<double>* follow) {
  constexpr double kTurn = 2.0 * base::kPi;
  double reference = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < angles.size(); ++k) {
    if (!std::isfinite(angles[k])) continue;
    if (follow != nullptr && k < follow->size() && std::isfinite((*follow)[k]))
      reference = (*follow)[k];
    if (std::isfinite(reference)) angles[k] += kTurn * std::round((reference - angles[k]) / kTurn);
    reference = angles[k];
  }
  return angles;
}

void append_flight_charts(std::string& html, const FlightRecord& record) {
  html +=
      "<h2>Position</h2>\n<p class=\"hint\">Move over a chart: all charts, and the dot on the "
      "path, show that "
      "moment. Broad pale lines are commands, shaded spans are faults.</p>\n<div class=\"charts\">";
  append_position(html, record);
  append_error_and_speed(html, record);
  html += "</div>\n";
  if (record.fixed_wing) append_wing_charts(html, record);
  if (record.estimated) append_estimate_charts(html, record);
  html += "<h2>Attitude and rates</h2>\n<div class=\"charts\">";
  for (std::size_t k = 0; k < 3; ++k) {
    append_angle(html, record, k);
    append_rate(html, record, k);
  }
  html += "</div>\n<h2>Motors and battery</h2>\n<div class=\"charts\">";
  append_motors(html, record);
  append_battery(html, record);
  html += "</div>\n";
}

}  // namespace rosflight::report
