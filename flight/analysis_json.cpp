// SPDX-License-Identifier: BSD-3-Clause
// analysis_json() alone: the JSON library takes seconds to compile.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/constants.hpp"
#include "flight/flight_analysis.hpp"
#include "flight/flight_summary.hpp"

namespace rosflight::flight {
namespace {

using Json = nlohmann::ordered_json;

/// Rounded to so many significant digits; null if it is not finite.
Json significant(double value, int digits = 4) {
  if (!std::isfinite(value)) return {};
  if (value == 0.0) return 0;
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

Json numbers(const std::vector<double>& values) {
  Json all = Json::array();
  for (const double value : values) all.push_back(significant(value));
  return all;
}

Json waypoints_json(const FlightSetup& setup) {
  Json all = Json::array();
  for (const ShownWaypoint& waypoint : setup.waypoints) {
    all.push_back({{"position_m", {waypoint.p_W.x(), waypoint.p_W.y(), waypoint.p_W.z()}},
                   {"heading_deg", significant(waypoint.heading_rad / base::kRadPerDeg)},
                   {"hold_s", significant(waypoint.hold_s)}});
  }
  return all;
}

Json changed_parameters_json(const FlightSetup& setup) {
  Json all = Json::array();
  for (const companion::NamedValue& entry : setup.firmware) {
    const double standard = firmware_value({}, entry.name);
    if (entry.value.number() == standard) continue;
    all.push_back({{"name", entry.name}, {"default", standard}, {"value", entry.value.number()}});
  }
  return all;
}

/// Curves that have a value somewhere.
Json curves_json(const std::vector<AnalysisMoment>& moments) {
  using Member = double AnalysisMoment::*;
  constexpr std::array<std::pair<const char*, Member>, 11> kCurves{
      {{"t_s", &AnalysisMoment::t_s},
       {"drift_north_m", &AnalysisMoment::drift_north_m},
       {"drift_east_m", &AnalysisMoment::drift_east_m},
       {"cross_track_m", &AnalysisMoment::cross_track_m},
       {"cross_track_total_m", &AnalysisMoment::cross_track_total_m},
       {"height_error_m", &AnalysisMoment::height_error_m},
       {"airspeed_command_m_s", &AnalysisMoment::airspeed_command_m_s},
       {"course_command_rad", &AnalysisMoment::course_command_rad},
       {"aileron", &AnalysisMoment::aileron},
       {"elevator", &AnalysisMoment::elevator},
       {"rudder", &AnalysisMoment::rudder}}};
  Json all = Json::object();
  for (const auto& [name, member] : kCurves) {
    const auto known = [member = member](const AnalysisMoment& m) {
      return std::isfinite(m.*member);
    };
    if (std::none_of(moments.begin(), moments.end(), known)) continue;
    Json values = Json::array();
    for (const AnalysisMoment& moment : moments) values.push_back(significant(moment.*member));
    all[name] = std::move(values);
  }
  return all;
}

}  // namespace

std::string analysis_json(const FlightSetup& setup, const FlightAnalysis& analysis) {
  const GyroSpectrum& gyro = analysis.gyro;
  const Json json{{"command_line", command_line(setup.choice)},
                  {"waypoints", waypoints_json(setup)},
                  {"changed_parameters", changed_parameters_json(setup)},
                  {"curves", curves_json(analysis.moments)},
                  {"gyro",
                   {{"frequency_Hz", numbers(gyro.frequency_Hz)},
                    {"sensor_rad_s_rtHz", numbers(gyro.before)},
                    {"controller_rad_s_rtHz", numbers(gyro.after)},
                    {"latency_s", significant(gyro.latency_s)}}}};
  // Texts may contain a file name that is no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rosflight::flight
