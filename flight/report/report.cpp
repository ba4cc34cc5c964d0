// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/constants.hpp"
#include "flight/report/firmware_section.hpp"
#include "flight/report/flight_charts.hpp"
#include "flight/report/html.hpp"
#include "flight/report/page.hpp"
#include "flight/report/path_chart.hpp"
#include "flight/report/timeline.hpp"
#include "log/output_file.hpp"

namespace rosflight::report {
namespace {

using base::kDegPerRad;

void append_cell(std::string& html, std::string_view css, std::string_view text) {
  html += "<td";
  if (!css.empty()) html += " class=\"" + std::string(css) + "\"";
  html += ">" + escape(text) + "</td>";
}

void append_head(std::string& html, const FlightRecord& record) {
  html += "<header><h1>" + escape(record.title) + "</h1><p class=\"about\">";
  auto part = [&, first = true](std::string_view label, const std::string& value) mutable {
    if (value.empty()) return;
    html += std::string(first ? "" : " · ") + std::string(label) + " <b>" + escape(value) + "</b>";
    first = false;
  };
  part("Vehicle", record.vehicle);
  part("mission", record.mission);
  part("seed", record.seed);
  html += "</p></header>\n";
  html += std::string("<p class=\"verdict ") + (record.success ? "good" : "bad") + "\"><strong>" +
          (record.success ? "✓ Success" : "✗ Failed") + "</strong><span>" + escape(record.verdict) +
          "</span></p>\n";
}

void append_summary(std::string& html, const FlightRecord& record) {
  html += "<div class=\"tiles\">";
  for (const Fact& fact : record.facts) {
    if (!fact.headline) continue;
    html += "<div class=\"tile " + std::string(tone_class(fact.tone)) + "\"><div class=\"label\">" +
            escape(fact.label) + "</div><div class=\"value\">" + escape(fact.value);
    if (!fact.unit.empty()) html += "<small>" + escape(fact.unit) + "</small>";
    html += "</div></div>";
  }
  html += "</div>\n<table class=\"facts\"><tbody>";
  for (const Fact& fact : record.facts) {
    if (fact.headline) continue;
    html += "<tr><th scope=\"row\">" + escape(fact.label) + "</th>";
    append_cell(html, "wrap", fact.value + (fact.unit.empty() ? "" : " " + fact.unit));
    html += "</tr>";
  }
  if (!record.command_line.empty()) {
    html += "<tr><th scope=\"row\">To fly it again</th><td class=\"wrap\"><code>" +
            escape(record.command_line) + "</code></td></tr>";
  }
  html += "</tbody></table>\n";
}

void append_paths(std::string& html, const FlightRecord& record) {
  html += "<h2>Path</h2>\n<div class=\"charts\">";
  append_path_figure(html, record, kFromAbove);
  html +=
      "<figure class=\"chart\"><figcaption><span class=\"name\">In space</span><span "
      "class=\"hint\">drag to turn"
      "</span></figcaption><svg id=\"space\" role=\"img\" aria-label=\"Path in space\" viewBox=\"0 "
      "0 560 470\"></svg>"
      "</figure>\n";
  append_path_figure(html, record, kFromSouth);
  append_path_figure(html, record, kFromEast);
  html += "</div>\n";
}

void append_waypoint_table(std::string& html, const FlightRecord& record) {
  if (record.waypoints.empty()) return;
  html +=
      "<div><h2>Waypoints</h2><div class=\"scroll\"><table><thead><tr><th class=\"n\">#</th>"
      "<th class=\"n\">north, m</th><th class=\"n\">east, m</th><th class=\"n\">up, m</th>"
      "<th class=\"n\">heading, °</th><th class=\"n\">hold, s</th><th class=\"n\">reached, s</th>"
      "<th class=\"n\">distance in truth, m</th><th class=\"n\">by the estimate, m</th>"
      "<th>measured to</th></tr></thead><tbody>";
  for (std::size_t k = 0; k < record.waypoints.size(); ++k) {
    const Waypoint& waypoint = record.waypoints[k];
    html += "<tr>";
    append_cell(html, "n", std::to_string(k + 1));
    for (const double value : {waypoint.p_W_m[0], waypoint.p_W_m[1], -waypoint.p_W_m[2]}) {
      append_cell(html, "n", number(value, 1));
    }
    append_cell(html, "n", number(waypoint.heading_rad * kDegPerRad, 0));
    append_cell(html, "n", number(waypoint.hold_s, 1));
    if (std::isfinite(waypoint.reached_s)) {
      append_cell(html, "n", number(waypoint.reached_s, 1));
    } else {
      html += "<td class=\"n\"><span class=\"badge bad\">missed</span></td>";
    }
    append_cell(html, "n", number(waypoint.truth_m, 2));
    append_cell(html, "n", number(waypoint.estimate_m, 2));
    append_cell(html, "", waypoint.measure.empty() ? "point" : waypoint.measure);
    html += "</tr>";
  }
  html += "</tbody></table></div></div>\n";
}

void append_fault_table(std::string& html, const FlightRecord& record) {
  if (record.faults.empty()) return;
  html +=
      "<div><h2>Faults</h2><table><thead><tr><th>what</th><th class=\"n\">from, s</th><th "
      "class=\"n\">to, s</th>"
      "</tr></thead><tbody>";
  for (const Fault& fault : record.faults) {
    html += "<tr>";
    append_cell(html, "wrap", fault.what);
    append_cell(html, "n", number(fault.from_s, 2));
    append_cell(html, "n", std::isfinite(fault.to_s) ? number(fault.to_s, 2) : "end");
    html += "</tr>";
  }
  html += "</tbody></table></div>\n";
}

std::string_view event_word(Tone tone) {
  switch (tone) {
    case Tone::kGood:
      return "ok";
    case Tone::kWarning:
      return "warning";
    case Tone::kBad:
      return "error";
    case Tone::kNote:
    case Tone::kNeutral:
      break;
  }
  return "info";
}

void append_event_table(std::string& html, const FlightRecord& record) {
  if (record.events().empty()) return;
  html +=
      "<h2>Events</h2><div class=\"scroll\"><table><thead><tr><th class=\"n\">time, "
      "s</th><th>kind</th>"
      "<th>from</th><th>text</th></tr></thead><tbody>";
  const std::size_t count = record.events().size();
  for (const Event& event : std::span(record.events()).first(std::min(count, kMostEvents))) {
    html += "<tr>";
    append_cell(html, "n", number(event.t_s, 2));
    html += "<td><span class=\"badge " + std::string(tone_class(event.tone)) + "\">" +
            std::string(event_word(event.tone)) + "</span></td>";
    append_cell(html, "", event.source);
    append_cell(html, "wrap", event.text);
    html += "</tr>";
  }
  html += "</tbody></table></div>\n";
  if (count > kMostEvents) {
    html += "<p class=\"hint\">and " + std::to_string(count - kMostEvents) +
            " more, which the log has.</p>\n";
  }
}

void append_parameters(std::string& html, const FlightRecord& record) {
  if (record.changed_parameters.empty()) return;
  html +=
      "<div><h2>Parameters changed from their defaults</h2><div "
      "class=\"scroll\"><table><thead><tr><th>name</th>"
      "<th class=\"n\">default</th><th class=\"n\">this "
      "flight</th><th>unit</th></tr></thead><tbody>";
  for (const ChangedParameter& parameter : record.changed_parameters) {
    html += "<tr>";
    append_cell(html, "mono", parameter.name);
    append_cell(html, "n", parameter.default_value);
    append_cell(html, "n", parameter.value);
    append_cell(html, "", parameter.unit);
    html += "</tr>";
  }
  html += "</tbody></table></div></div>\n";
}

void append_files(std::string& html, const FlightRecord& record) {
  if (record.files.empty()) return;
  html += "<div><h2>In the same folder</h2><table><tbody>";
  for (const std::string& file : record.files) {
    html += "<tr>";
    append_cell(html, "mono", file);
    html += "</tr>";
  }
  html += "</tbody></table></div>\n";
}

}  // namespace

std::string report_html(const FlightRecord& record) {
  constexpr std::size_t kUsualSize = 1'000'000;
  std::string html;
  html.reserve(kUsualSize);
  html +=
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
      escape(record.title) + "</title>\n<style>\n";
  html += colours_css();
  html += drawing_css();
  html += page_css();
  html += "</style>\n</head>\n<body>\n";
  append_head(html, record);
  append_summary(html, record);
  append_paths(html, record);
  html += "<div class=\"columns\">";
  append_waypoint_table(html, record);
  append_fault_table(html, record);
  html += "</div>\n<h2>States and events</h2>\n";
  append_timeline(html, record);
  append_flight_charts(html, record);
  append_firmware_section(html, record);
  append_event_table(html, record);
  html += "<div class=\"columns\">";
  append_parameters(html, record);
  append_files(html, record);
  html +=
      "</div>\n<footer>Positions are north, east and up of the start. Roll is positive to the "
      "right, pitch nose up, "
      "yaw nose right. Times are simulated seconds since power-up. The full log is the MCAP file "
      "in this folder: "
      "Foxglove, PlotJuggler and rosbag2 open it.</footer>\n"
      "<script type=\"application/json\" id=\"track\">" +
      track_json(record) + "</script>\n<script>\n";
  html += page_js();
  html += "</script>\n</body>\n</html>\n";
  return html;
}

void write_report(const FlightRecord& record, const std::filesystem::path& path) {
  base::write_file(path, report_html(record));
}

}  // namespace rosflight::report
