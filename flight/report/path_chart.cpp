// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/path_chart.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "flight/report/curve.hpp"
#include "flight/report/html.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

constexpr double kLeft = 48.0;
constexpr double kRightMargin = 14.0;
constexpr double kTop = 12.0;
constexpr double kBelow = 38.0;
constexpr double kTolerance_px = 0.15;
constexpr double kSmallestSpan_m = 2.0;

template <class Vector>
double along(const Vector& p_W, Direction direction) {
  switch (direction) {
    case Direction::kNorth:
      return static_cast<double>(p_W[0]);
    case Direction::kEast:
      return static_cast<double>(p_W[1]);
    case Direction::kUp:
      break;
  }
  return -static_cast<double>(p_W[2]);
}

std::string_view name_of(Direction direction) {
  if (direction == Direction::kUp) return "up";
  return direction == Direction::kNorth ? "north" : "east";
}

char letter_of(Direction direction) {
  return name_of(direction).front();
}

/// Both axes of a view, to the same scale.
struct Frame {
  Axis across;
  Axis up;
  double height{};  ///< Of the whole drawing.

  template <class Vector>
  Point place(const Vector& p_W, const PathView& view) const {
    return {across.pixel(along(p_W, view.across)), up.pixel(along(p_W, view.up))};
  }
};

Bounds bounds_along(const FlightRecord& record, Direction direction) {
  Bounds bounds;
  for (const Sample& sample : record.samples()) {
    bounds.include(along(sample.p_W_m, direction));
    bounds.include(along(sample.setpoint_W_m, direction));
  }
  for (const Waypoint& waypoint : record.waypoints)
    bounds.include(along(waypoint.p_W_m, direction));
  for (const auto& p_W_m : record.route) bounds.include(along(p_W_m, direction));
  if (bounds.empty()) bounds.include(0.0);
  return bounds;
}

Frame make_frame(const FlightRecord& record, const PathView& view) {
  constexpr double kRoom_px = 22.0;  // So that markers at the edge stay inside.
  constexpr int kSteps = 6;
  const Bounds across = bounds_along(record, view.across);
  const Bounds up = bounds_along(record, view.up);
  const double width = view.width - kLeft - kRightMargin;
  const double scale =
      std::min((width - 2.0 * kRoom_px) / std::max(across.span(), kSmallestSpan_m),
               (view.largest_height - 2.0 * kRoom_px) / std::max(up.span(), kSmallestSpan_m));
  const double height = std::max(up.span() * scale + 2.0 * kRoom_px, view.smallest_height);
  const double half_across = 0.5 * width / scale;
  const double half_up = 0.5 * height / scale;
  const double step = round_step(2.0 * half_across, kSteps);
  return {
      {across.middle() - half_across, across.middle() + half_across, kLeft, kLeft + width, step},
      {up.middle() - half_up, up.middle() + half_up, kTop + height, kTop, step},
      kTop + height + kBelow};
}

void append_attribute(std::string& svg, std::string_view name, double value) {
  svg += ' ';
  svg += name;
  svg += "=\"";
  append_coordinate(svg, value);
  svg += '"';
}

void append_segment(std::string& svg, std::string_view css, Point from, Point to) {
  svg += "<path class=\"";
  svg += css;
  svg += "\" d=\"M";
  append_coordinate(svg, from.x);
  svg += ' ';
  append_coordinate(svg, from.y);
  svg += 'L';
  append_coordinate(svg, to.x);
  svg += ' ';
  append_coordinate(svg, to.y);
  svg += "\"/>";
}

void append_axes(std::string& svg, const Frame& frame, const PathView& view) {
  const double left = frame.across.pixel_low;
  const double right = frame.across.pixel_high;
  const double top = frame.up.pixel_high;
  const double bottom = frame.up.pixel_low;
  const auto is_zero = [&](double tick) { return std::abs(tick) < 1e-9 * frame.across.step; };
  for (const double tick : frame.across.ticks()) {
    const double x = frame.across.pixel(tick);
    append_segment(svg, is_zero(tick) ? "axis" : "grid", {x, top}, {x, bottom});
    append_tick_text(svg, x, bottom + 16.0, "middle", frame.across.label(tick));
  }
  for (const double tick : frame.up.ticks()) {
    const double y = frame.up.pixel(tick);
    const bool ground = view.up == Direction::kUp && is_zero(tick);
    append_segment(svg, ground ? "ground" : is_zero(tick) ? "axis" : "grid", {left, y}, {right, y});
    append_tick_text(svg, left - 6.0, y + 4.0, "end", frame.up.label(tick));
  }
  append_tick_text(svg, right, bottom + 32.0, "end", std::string(name_of(view.across)) + " in m →");
  append_tick_text(svg, left + 4.0, top + 12.0, "start",
                   "↑ " + std::string(name_of(view.up)) + " in m");
}

template <class Get>
void append_track_of(std::string& svg, const FlightRecord& record, const Frame& frame,
                     const PathView& view, std::string_view css, const Get& get) {
  std::vector<Point> points;
  points.reserve(record.samples().size());
  for (const Sample& sample : record.samples()) points.push_back(frame.place(get(sample), view));
  svg += "<path class=\"curve ";
  svg += css;
  svg += "\" d=\"";
  append_track(svg, points, kTolerance_px);
  svg += "\"/>";
}

void append_route(std::string& svg, const FlightRecord& record, const Frame& frame,
                  const PathView& view) {
  if (record.route.empty()) return;
  std::vector<Point> points;
  points.reserve(record.route.size());
  for (const auto& p_W_m : record.route) points.push_back(frame.place(p_W_m, view));
  svg += "<path class=\"curve route\" d=\"";
  append_track(svg, points, kTolerance_px);
  svg += "\"/>";
}

/// Waypoints that fall on each other in this view share one label.
struct Label {
  Point at;
  std::vector<std::size_t> numbers;
  std::string tip;
  bool missed{false};
};

std::vector<Label> waypoint_labels(const FlightRecord& record, const Frame& frame,
                                   const PathView& view) {
  constexpr double kSamePlace_px = 13.0;
  std::vector<Label> labels;
  for (std::size_t k = 0; k < record.waypoints.size(); ++k) {
    const Waypoint& waypoint = record.waypoints[k];
    const Point at = frame.place(waypoint.p_W_m, view);
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    auto label = std::find_if(labels.begin(), labels.end(), [&](const Label& other) {
      return std::hypot(other.at.x - at.x, other.at.y - at.y) < kSamePlace_px;
    });
    if (label == labels.end()) label = labels.insert(labels.end(), Label{at, {}, {}, false});
    const std::string name = std::to_string(k + 1);
    const bool missed = !std::isfinite(waypoint.reached_s);
    label->numbers.push_back(k + 1);
    label->tip += (label->tip.empty() ? "" : "; ") + std::string("waypoint ") + name +
                  (missed ? " missed" : " reached at " + number(waypoint.reached_s, 1) + " s");
    label->missed = label->missed || missed;
  }
  return labels;
}

/// Of many numbers the first and the last; the tip has them all.
std::string text_of(const Label& label) {
  constexpr std::size_t kMost = 3;
  if (label.numbers.size() > kMost) {
    return std::to_string(label.numbers.front()) + " .. " + std::to_string(label.numbers.back());
  }
  std::string out;
  for (const std::size_t number : label.numbers) {
    out += (out.empty() ? "" : " ") + std::to_string(number);
  }
  return out;
}

void append_waypoints(std::string& svg, const std::vector<Label>& labels) {
  constexpr double kHalfHeight = 8.5;
  constexpr double kCharacter = 6.4;
  for (const Label& label : labels) {
    const std::string text = text_of(label);
    const double half_width =
        std::max(kHalfHeight, 0.5 * kCharacter * static_cast<double>(text.size()) + 4.0);
    svg += "<g class=\"waypoint";
    svg += label.missed ? " missed" : "";
    svg += "\"><title>" + escape(label.tip) + "</title><rect";
    append_attribute(svg, "x", label.at.x - half_width);
    append_attribute(svg, "y", label.at.y - kHalfHeight);
    append_attribute(svg, "width", 2.0 * half_width);
    append_attribute(svg, "height", 2.0 * kHalfHeight);
    append_attribute(svg, "rx", kHalfHeight);
    svg += "/><text text-anchor=\"middle\"";
    append_attribute(svg, "x", label.at.x);
    append_attribute(svg, "y", label.at.y + 4.0);
    svg += ">" + escape(text) + "</text></g>";
  }
}

void append_marker(std::string& svg, std::string_view css, std::string_view tip, Point at,
                   std::string_view shape) {
  svg += "<path class=\"";
  svg += css;
  svg += "\" transform=\"translate(";
  append_coordinate(svg, at.x);
  svg += ' ';
  append_coordinate(svg, at.y);
  svg += ")\" d=\"";
  svg += shape;
  svg += "\"><title>";
  svg += tip;
  svg += "</title></path>";
}

void append_ends(std::string& svg, const FlightRecord& record, const Frame& frame,
                 const PathView& view, const std::vector<Label>& labels) {
  constexpr double kNear_px = 14.0;
  constexpr double kBelow_px = 17.0;
  constexpr double kBeside_px = 7.5;
  const auto& samples = record.samples();
  const auto known = [](const Sample& s) {
    return std::all_of(s.p_W_m.begin(), s.p_W_m.end(), [](float x) { return std::isfinite(x); });
  };
  const auto first = std::find_if(samples.begin(), samples.end(), known);
  const auto last = std::find_if(samples.rbegin(), samples.rend(), known);
  if (first == samples.end()) return;
  Point start = frame.place(first->p_W_m, view);
  Point end = frame.place(last->p_W_m, view);
  const auto near = [](Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y) < kNear_px; };
  // Beside each other where they coincide, below the label of a waypoint where one is in the way.
  const bool together = near(start, end);
  for (Point* const marker : {&start, &end}) {
    const bool covered = std::any_of(labels.begin(), labels.end(),
                                     [&](const Label& label) { return near(label.at, *marker); });
    if (covered) marker->y += kBelow_px;
  }
  if (together) {
    start.x -= kBeside_px;
    end.x += kBeside_px;
  }
  append_marker(svg, "start", "start", start, "M-6 5L0 -6L6 5Z");
  append_marker(svg, "finish", "end", end, "M-4.5 -4.5H4.5V4.5H-4.5Z");
}

}  // namespace

double append_path_svg(std::string& svg, const FlightRecord& record, const PathView& view) {
  constexpr int kDigits = 9;
  const Frame frame = make_frame(record, view);
  svg += "<svg class=\"map\" role=\"img\" aria-label=\"" + escape(view.title) + "\"";
  append_attribute(svg, "width", view.width);
  append_attribute(svg, "height", frame.height);
  svg += " viewBox=\"0 0 ";
  append_coordinate(svg, view.width);
  svg += ' ';
  append_coordinate(svg, frame.height);
  // For the dot that page.js moves along the path: which coordinate, and two values with their
  // pixels.
  for (const auto& [name, direction, axis] :
       {std::tuple{"across", view.across, frame.across}, std::tuple{"up", view.up, frame.up}}) {
    svg += std::string("\" data-") + name + "=\"" + letter_of(direction) + " " +
           number(axis.low, kDigits) + " " + number(axis.high, kDigits) + " " +
           number(axis.pixel_low, 2) + " " + number(axis.pixel_high, 2);
  }
  svg += "\">";
  append_axes(svg, frame, view);
  append_route(svg, record, frame, view);
  append_track_of(svg, record, frame, view, "command",
                  [](const Sample& s) { return s.setpoint_W_m; });
  append_track_of(svg, record, frame, view, "actual", [](const Sample& s) { return s.p_W_m; });
  const std::vector<Label> labels = waypoint_labels(record, frame, view);
  append_waypoints(svg, labels);
  append_ends(svg, record, frame, view, labels);
  svg += "</svg>";
  return frame.height;
}

void append_path_figure(std::string& html, const FlightRecord& record, const PathView& view) {
  html +=
      "<figure class=\"chart\"><figcaption><span class=\"name\">" + escape(view.title) +
      "</span><span class=\"keys\"><span class=\"key\"><i class=\"swatch actual\"></i>flown</span>"
      "<span class=\"key\"><i class=\"swatch command\"></i>setpoint</span>" +
      std::string(record.route.empty()
                      ? ""
                      : "<span class=\"key\"><i class=\"swatch route\"></i>planned</span>") +
      "<span class=\"key\"><i class=\"sign start\">▲</i>start</span>"
      "<span class=\"key\"><i class=\"sign finish\">■</i>end</span></span></figcaption>";
  append_path_svg(html, record, view);
  html += "</figure>\n";
}

std::string track_json(const FlightRecord& record) {
  constexpr std::size_t kMost = 1500;
  constexpr int kDecimals = 2;
  const auto& samples = record.samples();
  const std::size_t stride = samples.size() / kMost + 1;
  const auto column = [&](const auto& get) {
    std::string out = "[";
    for (std::size_t k = 0; k < samples.size(); k += stride) {
      const double value = get(samples[k]);
      out += (k == 0 ? "" : ",") + (std::isfinite(value) ? number(value, kDecimals) : "null");
    }
    return out + "]";
  };
  std::string out = "{\"t\":" + column([](const Sample& s) { return s.t_s; });
  for (const Direction direction : {Direction::kNorth, Direction::kEast, Direction::kUp}) {
    out += std::string(",\"") + letter_of(direction) + "\":";
    out += column([&](const Sample& s) { return along(s.p_W_m, direction); });
  }
  out += ",\"waypoints\":[";
  bool first = true;
  for (const Waypoint& waypoint : record.waypoints) {
    const auto& p = waypoint.p_W_m;
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    out += std::string(first ? "[" : ",[") + number(p[0], kDecimals) + "," +
           number(p[1], kDecimals) + "," + number(-p[2], kDecimals) + "]";
    first = false;
  }
  return out + "]}";
}

}  // namespace rosflight::report
