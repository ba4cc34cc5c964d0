// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/firmware_section.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/constants.hpp"
#include "flight/report/axis.hpp"
#include "flight/report/curve.hpp"
#include "flight/report/html.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

constexpr double kWidth = 560.0;
constexpr double kHeight = 158.0;
constexpr double kLeft = 48.0;
constexpr double kRight = 552.0;
constexpr double kTop = 8.0;
constexpr double kBottom = 134.0;
constexpr double kTickGap = 6.0;
constexpr double kTextDrop = 4.0;
constexpr double kLabelDrop = 17.0;

void append_row(std::string& html, std::string_view name, std::uint64_t value) {
  html += "<tr><th scope=\"row\">" + escape(name) + "</th><td class=\"n\">" +
          std::to_string(value) + "</td></tr>";
}

void append_counters(std::string& html, const link::Counters& c) {
  html += "<div><table><tbody>";
  append_row(html, "Passes of the main loop", c.passes);
  append_row(html, "Longest pass, µs", c.longest_pass_us);
  append_row(html, "Budget of a pass, µs", c.pass_budget_us);
  append_row(html, "Passes over the budget", c.passes_over_budget);
  append_row(html, "Frames received and not understood", c.frames_dropped);
  append_row(html, "Frames not sent for want of room", c.tx_dropped);
  append_row(html, "Texts lost", c.texts_lost);
  html += "</tbody></table></div>\n";
}

std::string name_of(const std::vector<std::string>& names, std::size_t k) {
  return k < names.size() ? names[k] : "cause " + std::to_string(k);
}

/// Bins without a name are not in use; those with one are shown even if they are 0.
void append_bins(std::string& html, std::string_view title, std::span<const std::uint32_t> bins,
                 const std::vector<std::string>& names) {
  html += "<div><table><thead><tr><th>" + escape(title) +
          "</th><th class=\"n\">number</th></tr></thead><tbody>";
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (k >= names.size() && bins[k] == 0) continue;
    append_row(html, name_of(names, k), bins[k]);
  }
  html += "</tbody></table></div>\n";
}

using base::kDegPerRad;

/// Powers of ten of deg/s per root Hz.
std::vector<double> levels(const std::vector<double>& density) {
  std::vector<double> out;
  out.reserve(density.size());
  for (const double d : density) out.push_back(std::log10(kDegPerRad * d));
  return out;
}

std::string power_of_ten(double exponent) {
  constexpr double kMostZeros = 3.0;
  if (std::abs(exponent) > kMostZeros) return "1e" + number(exponent, 0);
  return number(std::pow(10.0, exponent), exponent < 0.0 ? static_cast<int>(-exponent) : 0);
}

/// Decades that show everything, five at most.
Axis decades(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kMost = 5.0;
  Bounds bounds;
  for (const double v : a) bounds.include(v);
  for (const double v : b) bounds.include(v);
  Axis axis{-2.0, 0.0, kBottom, kTop, 1.0};
  if (bounds.empty()) return axis;
  axis.high = std::ceil(bounds.high());
  axis.low = std::clamp(std::floor(bounds.low()), axis.high - kMost, axis.high - 1.0);
  return axis;
}

void append_curve(std::string& html, const char* css, const std::vector<double>& frequency_Hz,
                  const std::vector<double>& level, const Axis& x, const Axis& y) {
  std::vector<Point> points;
  for (std::size_t k = 0; k < std::min(frequency_Hz.size(), level.size()); ++k) {
    // A density of 0 has no level: the curve lies on the floor.
    const double v = std::isnan(level[k]) ? level[k] : std::clamp(level[k], y.low, y.high);
    points.push_back({x.pixel(frequency_Hz[k]), y.pixel(v)});
  }
  html += "<path class=\"curve " + std::string(css) + "\" d=\"";
  append_time_curve(html, points);
  html += "\"/>";
}

void append_line(std::string& html, double x1, double y1, double x2, double y2) {
  html += "<path class=\"grid\" d=\"";
  const std::array<Point, 2> ends{{{x1, y1}, {x2, y2}}};
  append_track(html, ends, 0.0);
  html += "\"/>";
}

void append_spectrum(std::string& html, const GyroSpectrum& gyro) {
  const auto before = levels(gyro.before);
  const auto after = levels(gyro.after);
  Axis x{0.0, gyro.frequency_Hz.back(), kLeft, kRight, 1.0};
  constexpr int kTicks = 8;
  x.step = round_step(x.high, kTicks);
  const Axis y = decades(before, after);
  html +=
      "<figure class=\"chart\"><figcaption><span class=\"name\">Gyro, density by frequency</span>"
      "<span class=\"unit\">°/s per √Hz over Hz</span><span class=\"keys\">"
      "<span class=\"key\"><i class=\"swatch command\"></i>sensor</span>"
      "<span class=\"key\"><i class=\"swatch actual\"></i>to the "
      "controller</span></span></figcaption>"
      "<svg role=\"img\" aria-label=\"Spectrum of the gyro before and after the firmware's "
      "filters\" viewBox=\"0 0 ";
  append_coordinate(html, kWidth);
  html += ' ';
  append_coordinate(html, kHeight);
  html += "\">";
  for (double level = y.low; level <= y.high; level += 1.0) {
    append_line(html, kLeft, y.pixel(level), kRight, y.pixel(level));
    append_tick_text(html, kLeft - kTickGap, y.pixel(level) + kTextDrop, "end",
                     power_of_ten(level));
  }
  for (const double tick : x.ticks()) {
    append_line(html, x.pixel(tick), kTop, x.pixel(tick), kBottom);
    append_tick_text(html, x.pixel(tick), kBottom + kLabelDrop, "middle", x.label(tick));
  }
  append_curve(html, "command", gyro.frequency_Hz, before, x, y);
  append_curve(html, "actual", gyro.frequency_Hz, after, x, y);
  html += "</svg></figure>\n";
}

}  // namespace

void append_firmware_section(std::string& html, const FlightRecord& record) {
  const bool spectrum = !record.gyro.frequency_Hz.empty();
  if (!record.counters && !spectrum) return;
  html += "<h2>Firmware</h2>\n";
  if (spectrum) {
    html +=
        "<p class=\"hint\">In the air, three axes together. The filters delay slow motion by <b>" +
        number(1e3 * record.gyro.latency_s, 2) + " ms</b>.</p>\n<div class=\"charts\">";
    append_spectrum(html, record.gyro);
    html += "</div>\n";
  }
  if (!record.counters) return;
  html += "<div class=\"columns\">";
  append_counters(html, *record.counters);
  append_bins(html, "IMU sample late or early", record.counters->imu_jitter, record.jitter_names);
  append_bins(html, "Rejected samples", record.counters->rejected, record.rejected_names);
  html += "</div>\n";
}

}  // namespace rosflight::report
