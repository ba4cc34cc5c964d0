// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/svg_chart.hpp"

#include <algorithm>
#include <cmath>

#include "flight/report/curve.hpp"
#include "flight/report/html.hpp"

namespace rosflight::report {
namespace {

constexpr double kWidth = 560.0;
constexpr double kHeight = 158.0;
constexpr double kLeft = 48.0;
constexpr double kRight = 552.0;
constexpr double kMargin = 8.0;  // Right of a drawing over time.
constexpr double kTop = 8.0;
constexpr double kBottom = 134.0;
constexpr double kTickGap = 6.0;
constexpr double kTextDrop = 4.0;   // From the middle of a line of text to its base.
constexpr double kTimeDrop = 17.0;  // From the axis to the base of the time labels.

void append_attribute(std::string& out, std::string_view name, double a, double b) {
  out += ' ';
  out += name;
  out += "=\"";
  append_coordinate(out, a);
  out += ' ';
  append_coordinate(out, b);
  out += '"';
}

void append_line(std::string& svg, std::string_view css, double x1, double y1, double x2,
                 double y2) {
  svg += "<path class=\"";
  svg += css;
  svg += "\" d=\"M";
  append_coordinate(svg, x1);
  svg += ' ';
  append_coordinate(svg, y1);
  svg += 'L';
  append_coordinate(svg, x2);
  svg += ' ';
  append_coordinate(svg, y2);
  svg += "\"/>";
}

void append_grid(std::string& svg, const Axis& time, const Axis& value) {
  for (const double tick : value.ticks()) {
    const double y = value.pixel(tick);
    append_line(svg, std::abs(tick) < 1e-9 * value.step ? "axis" : "grid", kLeft, y, kRight, y);
    append_tick_text(svg, kLeft - kTickGap, y + kTextDrop, "end", value.label(tick));
  }
  append_time_grid(svg, time, kTop, kBottom);
}

/// Full precision: page.js turns pixels back into values with these.
std::string exact(double value) {
  constexpr int kDigits = 9;
  return number(value, kDigits);
}

}  // namespace

std::string time_attributes(const Axis& time) {
  std::string out = " data-t=\"" + exact(time.low) + " " + exact(time.high) + "\"";
  append_attribute(out, "data-x", time.pixel_low, time.pixel_high);
  return out;
}

void append_time_grid(std::string& svg, const Axis& time, double top, double bottom) {
  const std::vector<double> ticks = time.ticks();
  for (const double tick : ticks) {
    const double x = time.pixel(tick);
    append_line(svg, "grid", x, top, x, bottom);
    const bool last = tick == ticks.back();
    constexpr double kHalfLabel = 20.0;  // With its unit; it must not leave the drawing.
    const bool at_edge = last && x > time.pixel_high - kHalfLabel + kMargin;
    append_tick_text(svg, at_edge ? time.pixel_high + kMargin : x, bottom + kTimeDrop,
                     at_edge ? "end" : "middle",
                     time_label(tick, time) + std::string(last ? time_unit(time) : ""));
  }
}

void append_fault_shades(std::string& svg, const FlightRecord& record, const Axis& time, double top,
                         double bottom) {
  for (const Fault& fault : record.faults) {
    const double from = time.pixel(std::clamp(fault.from_s, time.low, time.high));
    const double to = time.pixel(std::clamp(fault.to_s, time.low, time.high));
    if (!(to >= from) || fault.from_s > time.high) continue;
    svg += "<rect class=\"fault\" x=\"";
    append_coordinate(svg, from);
    svg += "\" y=\"";
    append_coordinate(svg, top);
    svg += "\" width=\"";
    append_coordinate(svg, std::max(to - from, 1.0));
    svg += "\" height=\"";
    append_coordinate(svg, bottom - top);
    svg += "\"/>";
  }
}

void append_tick_text(std::string& svg, double x, double y, std::string_view anchor,
                      std::string_view text) {
  svg += "<text class=\"tick\" text-anchor=\"";
  svg += anchor;
  svg += "\" x=\"";
  append_coordinate(svg, x);
  svg += "\" y=\"";
  append_coordinate(svg, y);
  svg += "\">";
  svg += escape(text);
  svg += "</text>";
}

TimeChart::TimeChart(Format format, const FlightRecord& record)
    : format_(std::move(format)), record_(record) {}

void TimeChart::add(std::string_view name, CurveStyle style, std::vector<double> values) {
  Curve curve;
  curve.name = name;
  switch (style) {
    case CurveStyle::kActual:
      curve.css = "actual";
      break;
    case CurveStyle::kCommand:
      curve.css = "command";
      break;
    case CurveStyle::kEstimate:
      curve.css = "estimate";
      break;
    case CurveStyle::kNumbered:
      curve.css = "c" + std::to_string(numbered_++ % kMaxMotors);
      break;
  }
  curve.beneath = style == CurveStyle::kCommand;
  Bounds own;
  for (const double value : values) own.include(value);
  if (own.empty()) return;
  bounds_.include(own.low());
  bounds_.include(own.high());
  curve.values = std::move(values);
  curves_.push_back(std::move(curve));
}

void TimeChart::add_band(std::string_view name, std::vector<double> low, std::vector<double> high) {
  // How unsure a filter was as it began must not shrink the rest: the widest part may be cut off.
  constexpr double kShown = 0.95;
  std::vector<double> lowest;
  std::vector<double> highest;
  for (std::size_t k = 0; k < std::min(low.size(), high.size()); ++k) {
    if (!std::isfinite(low[k]) || !std::isfinite(high[k])) continue;
    lowest.push_back(-low[k]);
    highest.push_back(high[k]);
  }
  if (lowest.empty()) return;
  const auto at = static_cast<std::ptrdiff_t>(kShown * static_cast<double>(lowest.size() - 1));
  std::nth_element(lowest.begin(), lowest.begin() + at, lowest.end());
  std::nth_element(highest.begin(), highest.begin() + at, highest.end());
  bounds_.include(-lowest[static_cast<std::size_t>(at)]);
  bounds_.include(highest[static_cast<std::size_t>(at)]);
  bands_.push_back({std::string(name), std::move(low), std::move(high)});
}

void TimeChart::append_caption(std::string& html) const {
  html += "<figcaption><span class=\"name\">" + escape(format_.title) + "</span>";
  if (!format_.unit.empty()) html += "<span class=\"unit\">" + escape(format_.unit) + "</span>";
  html += "<span class=\"keys\">";
  for (const Curve& curve : curves_) {
    html += "<span class=\"key\"><i class=\"swatch " + curve.css + "\"></i>" + escape(curve.name) +
            "<output></output></span>";
  }
  for (const Band& band : bands_) {
    html += "<span class=\"key\"><i class=\"swatch band3\"></i>" + escape(band.name) + "</span>";
  }
  html += "</span></figcaption>";
}

void TimeChart::append_bands(std::string& html, const Axis& time, const Axis& value) const {
  const auto points_of = [&](const std::vector<double>& values) {
    std::vector<Point> points(std::min(record_.samples().size(), values.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double y = value.pixel(values[k]);
      points[k] = {time.pixel(record_.samples()[k].t_s),
                   std::isnan(y) ? y : std::clamp(y, kTop, kBottom)};
    }
    return points;
  };
  for (const Band& band : bands_) {
    html += "<path class=\"shade\" d=\"";
    append_time_band(html, points_of(band.low), points_of(band.high));
    html += "\"/>";
  }
}

void TimeChart::append_curves(std::string& html, const Axis& time, const Axis& value) const {
  std::vector<Point> points(record_.samples().size());
  // Two passes: what lies beneath first. data-k ties each path to its entry in the legend.
  for (const bool beneath : {true, false}) {
    for (std::size_t k = 0; k < curves_.size(); ++k) {
      const Curve& curve = curves_[k];
      if (curve.beneath != beneath) continue;
      const std::size_t count = std::min(points.size(), curve.values.size());
      for (std::size_t i = 0; i < count; ++i) {
        // Past a fixed range the curve runs along its edge; NaN stays NaN.
        const double y = value.pixel(curve.values[i]);
        points[i] = {time.pixel(record_.samples()[i].t_s),
                     std::isnan(y) ? y : std::clamp(y, kTop, kBottom)};
      }
      html += "<path class=\"curve " + curve.css + "\" data-k=\"" + std::to_string(k) + "\" d=\"";
      append_time_curve(html, std::span<const Point>(points).first(count));
      html += "\"/>";
    }
  }
}

void TimeChart::append_to(std::string& html) const {
  const Axis time = time_axis(record_.end_s(), kLeft, kRight);
  Axis value = value_axis(bounds_, format_.smallest_span, kBottom, kTop);
  if (format_.low && format_.high) {
    constexpr int kSteps = 4;
    value.low = *format_.low;
    value.high = *format_.high;
    value.step = round_step(value.high - value.low, kSteps);
  }
  html += "<figure class=\"chart\">";
  append_caption(html);
  html += "<svg class=\"time\" role=\"img\" aria-label=\"" + escape(format_.title) +
          " over time\" viewBox=\"0 0 ";
  append_coordinate(html, kWidth);
  html += ' ';
  append_coordinate(html, kHeight);
  html += '"' + time_attributes(time);
  append_attribute(html, "data-y", kTop, kBottom);
  html += " data-v=\"" + exact(value.high) + " " + exact(value.low) + "\" data-d=\"" +
          std::to_string(format_.decimals) + "\">";
  append_fault_shades(html, record_, time, kTop, kBottom);
  append_grid(html, time, value);
  if (curves_.empty() && bands_.empty()) {
    append_tick_text(html, 0.5 * (kLeft + kRight), 0.5 * (kTop + kBottom), "middle", "no data");
  }
  append_bands(html, time, value);
  append_curves(html, time, value);
  html += "</svg></figure>\n";
}

}  // namespace rosflight::report
