// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "flight/report/axis.hpp"
#include "flight/report/html.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

constexpr double kWidth = 1140.0;
constexpr double kLeft = 118.0;
constexpr double kRight = 1130.0;
constexpr double kTop = 6.0;
constexpr double kRow = 28.0;
constexpr double kBand = 22.0;
constexpr double kBelow = 24.0;
constexpr double kCharacter = 6.3;  ///< Mean advance of the 11 px font.

void append_attribute(std::string& svg, std::string_view name, double value) {
  svg += ' ';
  svg += name;
  svg += "=\"";
  append_coordinate(svg, value);
  svg += '"';
}

std::size_t letters(std::string_view text) {
  // UTF-8: bytes that are not continuations.
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

void append_name(std::string& svg, std::string name, double y) {
  // Lanes are named by many hands; the rows begin alike.
  if (!name.empty() && name.front() >= 'a' && name.front() <= 'z')
    name.front() = static_cast<char>(name.front() - 'a' + 'A');
  append_tick_text(svg, kLeft - 10.0, y + 0.5 * kBand + 4.0, "end", name);
}

/// One state from..to, with its label if there is room; the full story is in the tooltip.
void append_band(std::string& svg, const Axis& time, const StateChange& state, double to_s,
                 double y) {
  constexpr double kHairline = 1.0;  // A state of one instant must still be seen.
  const double from = time.pixel(std::clamp(state.t_s, time.low, time.high));
  const double width =
      std::max(time.pixel(std::clamp(to_s, time.low, time.high)) - from - kHairline, kHairline);
  svg += "<g class=\"band ";
  svg += tone_class(state.tone);
  svg += "\"><title>" + escape(state.label) + ": " + number(state.t_s, 2) + " to " +
         number(to_s, 2) + " s</title><rect rx=\"3\"";
  append_attribute(svg, "x", from);
  append_attribute(svg, "y", y);
  append_attribute(svg, "width", width);
  append_attribute(svg, "height", kBand);
  svg += "/>";
  if (static_cast<double>(letters(state.label)) * kCharacter + 8.0 < width) {
    svg += "<text";
    append_attribute(svg, "x", from + 6.0);
    append_attribute(svg, "y", y + 0.5 * kBand + 4.0);
    svg += ">" + escape(state.label) + "</text>";
  }
  svg += "</g>";
}

void append_lane(std::string& svg, const Lane& lane, const Axis& time, double y) {
  append_name(svg, lane.name, y);
  double last_drawn_px = -1.0;
  for (std::size_t k = 0; k < lane.changes.size(); ++k) {
    if (lane.changes[k].label.empty()) continue;
    const double to = k + 1 < lane.changes.size() ? lane.changes[k + 1].t_s : time.high;
    // A state that chatters faster than pixels can show is drawn once a pixel.
    const double to_px = std::floor(time.pixel(to));
    if (to_px <= last_drawn_px) continue;
    last_drawn_px = to_px;
    append_band(svg, time, lane.changes[k], to, y);
  }
}

void append_waypoints(std::string& svg, const FlightRecord& record, const Axis& time, double y) {
  constexpr double kRadius = 8.5;
  append_name(svg, "Waypoints", y);
  double last_px = -1.0;
  for (std::size_t k = 0; k < record.waypoints.size(); ++k) {
    const Waypoint& waypoint = record.waypoints[k];
    if (!std::isfinite(waypoint.reached_s)) continue;
    double x = time.pixel(std::clamp(waypoint.reached_s, time.low, time.high));
    // Two that follow each other closely stand side by side.
    if (x < last_px + 2.0 * kRadius + 1.0) x = last_px + 2.0 * kRadius + 1.0;
    last_px = x;
    const std::string name = std::to_string(k + 1);
    svg += "<g class=\"waypoint\"><title>waypoint " + name + " reached at " +
           number(waypoint.reached_s, 2) + " s</title><circle";
    append_attribute(svg, "cx", x);
    append_attribute(svg, "cy", y + 0.5 * kBand);
    append_attribute(svg, "r", kRadius);
    svg += "/><text text-anchor=\"middle\"";
    append_attribute(svg, "x", x);
    append_attribute(svg, "y", y + 0.5 * kBand + 4.0);
    svg += ">" + name + "</text></g>";
  }
}

void append_faults(std::string& svg, const FlightRecord& record, const Axis& time, double y) {
  append_name(svg, "Faults", y);
  for (const Fault& fault : record.faults) {
    if (!(fault.from_s <= time.high)) continue;
    append_band(svg, time, {fault.from_s, fault.what, Tone::kBad}, std::min(fault.to_s, time.high),
                y);
  }
}

void append_events(std::string& svg, const FlightRecord& record, const Axis& time, double y) {
  append_name(svg, "Events", y);
  for (const Event& event :
       std::span(record.events()).first(std::min(record.events().size(), kMostEvents))) {
    const double x = time.pixel(std::clamp(event.t_s, time.low, time.high));
    const bool serious = event.tone == Tone::kBad || event.tone == Tone::kWarning;
    svg += "<path class=\"event ";
    svg += tone_class(event.tone);
    svg += "\" transform=\"translate(";
    append_coordinate(svg, x);
    svg += ' ';
    append_coordinate(svg, y + 0.5 * kBand);
    svg += serious ? ")\" d=\"M-6 5L0 -6L6 5Z\">" : ")\" d=\"M0 -5L4 0L0 5L-4 0Z\">";
    svg += "<title>" + number(event.t_s, 2) + " s, " + escape(event.source) + ": " +
           escape(event.text) + "</title></path>";
  }
}

}  // namespace

std::string_view tone_class(Tone tone) {
  switch (tone) {
    case Tone::kGood:
      return "good";
    case Tone::kNote:
      return "note";
    case Tone::kWarning:
      return "warning";
    case Tone::kBad:
      return "bad";
    case Tone::kNeutral:
      break;
  }
  return "neutral";
}

void append_timeline(std::string& html, const FlightRecord& record) {
  const Axis time = time_axis(record.end_s(), kLeft, kRight);
  std::string rows;
  double y = kTop;
  const auto add_row = [&](const auto& append) {
    append(y);
    y += kRow;
  };
  for (const Lane& lane : record.lanes()) {
    add_row([&](double at) { append_lane(rows, lane, time, at); });
  }
  if (!record.waypoints.empty())
    add_row([&](double at) { append_waypoints(rows, record, time, at); });
  if (!record.faults.empty()) add_row([&](double at) { append_faults(rows, record, time, at); });
  if (!record.events().empty()) add_row([&](double at) { append_events(rows, record, time, at); });

  const double bottom = y;
  html +=
      "<figure class=\"chart wide\"><svg class=\"time\" role=\"img\" aria-label=\"States over "
      "time\" viewBox=\"0 0 ";
  append_coordinate(html, kWidth);
  html += ' ';
  append_coordinate(html, bottom + kBelow);
  html += '"' + time_attributes(time) + " data-y=\"" + number(kTop, 0) + " " + number(bottom, 0) +
          "\">";
  append_time_grid(html, time, kTop, bottom);
  html += rows + "</svg></figure>\n";
}

}  // namespace rosflight::report
