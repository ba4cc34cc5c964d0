// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/estimate_charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "flight/report/flight_charts.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

constexpr float kSigmas = 3.0F;

/// One component of an error over its 3 sigma.
struct ErrorChart {
  const char* title;
  const char* unit;
  double smallest_span;
  int decimals;
  float scale;
  Vec3 Estimate::*error;
  Vec3 Estimate::*sigma;
  std::size_t axis;
};

constexpr std::array<ErrorChart, 9> kErrors{
    {{"Position error, north", "m", 0.5, 2, 1.0F, &Estimate::p_error_m, &Estimate::p_sigma_m, 0},
     {"Velocity error, north", "m/s", 0.2, 3, 1.0F, &Estimate::v_error_m_s, &Estimate::v_sigma_m_s,
      0},
     {"Position error, east", "m", 0.5, 2, 1.0F, &Estimate::p_error_m, &Estimate::p_sigma_m, 1},
     {"Velocity error, east", "m/s", 0.2, 3, 1.0F, &Estimate::v_error_m_s, &Estimate::v_sigma_m_s,
      1},
     {"Position error, down", "m", 0.5, 2, 1.0F, &Estimate::p_error_m, &Estimate::p_sigma_m, 2},
     {"Velocity error, down", "m/s", 0.2, 3, 1.0F, &Estimate::v_error_m_s, &Estimate::v_sigma_m_s,
      2},
     {"Attitude error, about the nose (roll)", "°", 1.0, 2, kDegPerRadF, &Estimate::turn_error_rad,
      &Estimate::turn_sigma_rad, 0},
     {"Attitude error, about the right (pitch)", "°", 1.0, 2, kDegPerRadF,
      &Estimate::turn_error_rad, &Estimate::turn_sigma_rad, 1},
     {"Attitude error, about down (heading)", "°", 1.0, 2, kDegPerRadF, &Estimate::turn_error_rad,
      &Estimate::turn_sigma_rad, 2}}};

void append_error(std::string& html, const FlightRecord& record, const ErrorChart& what) {
  TimeChart chart({what.title, what.unit, what.smallest_span, what.decimals, {}, {}}, record);
  const auto sigma = column(record, [&](const Sample& s) {
    return kSigmas * what.scale * (s.estimate.*what.sigma)[what.axis];
  });
  std::vector<double> low = sigma;
  for (double& value : low) value = -value;
  chart.add_band("±3 σ", std::move(low), sigma);
  chart.add("error", CurveStyle::kActual,
            [&](const Sample& s) { return what.scale * (s.estimate.*what.error)[what.axis]; });
  chart.append_to(html);
}

void append_innovations(std::string& html, const FlightRecord& record) {
  constexpr double kLargestRatio = 6.0;
  TimeChart chart(
      {"Innovations squared over their covariance (1 is right)", "", 1.0, 1, 0.0, kLargestRatio},
      record);
  for (std::size_t k = 0; k < Estimate::kAids; ++k) {
    chart.add(Estimate::kAidNames[k], CurveStyle::kNumbered,
              [k](const Sample& s) { return s.estimate.innovation[k]; });
  }
  chart.append_to(html);
}

void append_wind(std::string& html, const FlightRecord& record) {
  constexpr std::array kNames{"Wind, to the north", "Wind, to the east"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    TimeChart chart({kNames[k], "m/s", 2.0, 1, {}, {}}, record);
    auto low = column(record, [k](const Sample& s) {
      return s.estimate.wind_W_m_s[k] - kSigmas * s.estimate.wind_sigma_m_s[k];
    });
    auto high = column(record, [k](const Sample& s) {
      return s.estimate.wind_W_m_s[k] + kSigmas * s.estimate.wind_sigma_m_s[k];
    });
    chart.add_band("±3 σ", std::move(low), std::move(high));
    chart.add("true", CurveStyle::kActual, [k](const Sample& s) { return s.wing.wind_W_m_s[k]; });
    chart.add("estimate", CurveStyle::kEstimate,
              [k](const Sample& s) { return s.estimate.wind_W_m_s[k]; });
    chart.append_to(html);
  }
}

void append_course(std::string& html, const FlightRecord& record) {
  auto actual = unwrapped(column(record, [](const Sample& s) { return s.wing.course_rad; }));
  auto command =
      unwrapped(column(record, [](const Sample& s) { return s.wing.course_command_rad; }), &actual);
  auto estimate =
      unwrapped(column(record, [](const Sample& s) { return s.estimate.course_rad; }), &actual);
  for (auto* values : {&actual, &command, &estimate}) {
    for (double& value : *values) value *= base::kDegPerRad;
  }
  TimeChart chart({"Course over ground", "°", 10.0, 1, {}, {}}, record);
  chart.add("command", CurveStyle::kCommand, std::move(command));
  chart.add("true", CurveStyle::kActual, std::move(actual));
  chart.add("estimate", CurveStyle::kEstimate, std::move(estimate));
  chart.append_to(html);
}

}  // namespace

void append_estimate_charts(std::string& html, const FlightRecord& record) {
  html +=
      "<h2>Estimate</h2>\n<p class=\"hint\">Estimate less truth. Horizontally the slow error of "
      "the "
      "satellites, which nothing on board can see, is taken out; the band is what the filter says "
      "of itself.</p>\n<div class=\"charts\">";
  for (const ErrorChart& error : kErrors) append_error(html, record, error);
  append_innovations(html, record);
  html += "</div>\n";
}

void append_wing_charts(std::string& html, const FlightRecord& record) {
  html += "<h2>Fixed wing</h2>\n<div class=\"charts\">";
  TimeChart cross({"Cross-track error, right of the path", "m", 2.0, 2, {}, {}}, record);
  cross.add("total", CurveStyle::kEstimate,
            [](const Sample& s) { return s.wing.cross_track_total_m; });
  cross.add("less GNSS drift", CurveStyle::kActual,
            [](const Sample& s) { return s.wing.cross_track_m; });
  cross.append_to(html);
  TimeChart height({"Height above the ramped reference", "m", 2.0, 2, {}, {}}, record);
  height.add("error", CurveStyle::kActual, [](const Sample& s) { return s.wing.height_error_m; });
  height.append_to(html);
  TimeChart airspeed({"Airspeed", "m/s", 4.0, 1, {}, {}}, record);
  airspeed.add("command", CurveStyle::kCommand,
               [](const Sample& s) { return s.wing.airspeed_command_m_s; });
  airspeed.add("true", CurveStyle::kActual, [](const Sample& s) { return s.wing.airspeed_m_s; });
  airspeed.add("estimate", CurveStyle::kEstimate,
               [](const Sample& s) { return s.estimate.airspeed_m_s; });
  airspeed.append_to(html);
  append_course(html, record);
  append_wind(html, record);
  TimeChart surfaces({"Surfaces, by effect", "of full", 0.5, 2, {}, {}}, record);
  constexpr std::array kSurfaces{"aileron", "elevator", "rudder"};
  for (std::size_t k = 0; k < kSurfaces.size(); ++k) {
    surfaces.add(kSurfaces[k], CurveStyle::kNumbered,
                 [k](const Sample& s) { return s.wing.surfaces[k]; });
  }
  surfaces.append_to(html);
  html += "</div>\n";
}

}  // namespace rosflight::report
