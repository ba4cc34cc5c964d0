// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "flight/report/html.hpp"
#include "flight/report/page.hpp"
#include "flight/report/path_chart.hpp"
#include "flight/report/svg_chart.hpp"

namespace rosflight::report {
namespace {

constexpr double kWidth = 980.0;
constexpr double kPanel = 470.0;
constexpr double kMargin = 16.0;
constexpr double kHead = 56.0;

constexpr PathView kAbove{"From above", Direction::kEast, Direction::kNorth, kPanel, 200.0, 400.0};
constexpr PathView kSouth{"From the south", Direction::kEast, Direction::kUp, kPanel, 80.0, 160.0};
constexpr PathView kEast{"From the east", Direction::kNorth, Direction::kUp, kPanel, 80.0, 160.0};

/// Appends one view with its title; returns the height taken.
double append_panel(std::string& svg, const FlightRecord& record, const PathView& view, double x,
                    double y) {
  constexpr double kTitle = 20.0;
  svg += "<g transform=\"translate(" + number(x, 1) + " " + number(y, 1) +
         ")\"><text class=\"name\" x=\"48\" y=\"10\">" + escape(view.title) +
         "</text><g transform=\"translate(0 " + number(kTitle - 6.0, 0) + ")\">";
  const double height = append_path_svg(svg, record, view);
  svg += "</g></g>";
  return height + kTitle;
}

void append_legend(std::string& svg, double right, double y) {
  svg +=
      "<g transform=\"translate(" + number(right - 276.0, 1) + " " + number(y, 1) +
      ")\"><path class=\"curve command\" d=\"M0 -4H26\"/><text x=\"32\" y=\"0\">setpoint</text>"
      "<path class=\"curve actual\" d=\"M112 -4H138\"/><text x=\"144\" y=\"0\">flown</text>"
      "<g class=\"waypoint\"><rect x=\"196\" y=\"-12\" width=\"17\" height=\"17\" rx=\"8.5\"/></g>"
      "<text x=\"219\" y=\"0\">waypoint</text></g>";
}

}  // namespace

std::string path_svg(const FlightRecord& record) {
  std::string body;
  const double left = append_panel(body, record, kAbove, kMargin, kHead);
  double right = append_panel(body, record, kSouth, kWidth - kMargin - kPanel, kHead);
  right += append_panel(body, record, kEast, kWidth - kMargin - kPanel, kHead + right + kMargin);
  const double height = kHead + std::max(left, right + kMargin) + kMargin;

  constexpr int kMostFacts = 5;  // What fits in one line.
  std::string facts;
  int count = 0;
  for (const Fact& fact : record.facts) {
    if (!fact.headline || ++count > kMostFacts) continue;
    facts += (facts.empty() ? "" : "  ·  ") + fact.label + " " + fact.value +
             (fact.unit.empty() ? "" : " " + fact.unit);
  }
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth, 0) +
                    "\" height=\"" + number(height, 0) + "\" viewBox=\"0 0 " + number(kWidth, 0) +
                    " " + number(height, 0) + "\">\n<style>";
  svg += colours_css();
  svg += drawing_css();
  svg += "</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" rx=\"8\"/>";
  svg += "<text class=\"title\" x=\"" + number(kMargin, 0) + "\" y=\"28\">" + escape(record.title) +
         "</text>";
  svg += "<text class=\"facts\" x=\"" + number(kMargin, 0) + "\" y=\"46\">" + escape(facts) +
         "</text>";
  append_legend(svg, kWidth - kMargin, 28.0);
  return svg + body + "</svg>\n";
}

}  // namespace rosflight::report
