// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/report/axis.hpp"
#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// How a curve is drawn. Colours are CSS variables, so that light, dark and print have their own.
enum class CurveStyle : std::uint8_t {
  kActual,    ///< What happened: a thin line.
  kCommand,   ///< What was asked for: a broad pale band beneath it. Width, not hue, tells them
              ///< apart.
  kEstimate,  ///< The firmware's estimate: a thin line of a third colour.
  kNumbered   ///< One of several of a kind: colours in turn.
};

/// One chart over the time of flight: HTML figure with title, legend with room for values under the
/// cursor (page.js fills it) and an SVG with the curves. All time charts of a page share width and
/// time axis.
class TimeChart {
 public:
  struct Format {
    std::string title;
    std::string unit;
    double smallest_span{1.0};
    int decimals{2};            ///< Of values under the cursor.
    std::optional<double> low;  ///< A fixed range instead of one that fits; both or none.
    std::optional<double> high;
  };

  TimeChart(Format format, const FlightRecord& record);

  /// Adds a curve; `value(sample)` gives its value at each sample, NaN where there is none.
  template <class Value>
  void add(std::string_view name, CurveStyle style, const Value& value) {
    std::vector<double> values;
    values.reserve(record_.samples().size());
    for (const Sample& sample : record_.samples())
      values.push_back(static_cast<double>(value(sample)));
    add(name, style, std::move(values));
  }
  /// Adds a curve with one value per sample of the record.
  void add(std::string_view name, CurveStyle style, std::vector<double> values);

  /// Adds a shaded band from `low` to `high`, beneath all curves.
  void add_band(std::string_view name, std::vector<double> low, std::vector<double> high);

  /// Appends the figure. A curve without a finite value is left out, legend included; a chart
  /// without a curve says so.
  void append_to(std::string& html) const;

 private:
  struct Curve {
    std::string name;
    std::string css;
    bool beneath{false};
    std::vector<double> values;
  };

  struct Band {
    std::string name;
    std::vector<double> low;
    std::vector<double> high;
  };

  void append_caption(std::string& html) const;
  void append_bands(std::string& html, const Axis& time, const Axis& value) const;
  void append_curves(std::string& html, const Axis& time, const Axis& value) const;

  Format format_;
  const FlightRecord& record_;
  std::vector<Curve> curves_;
  std::vector<Band> bands_;
  Bounds bounds_;
  std::size_t numbered_{0};
};

/// The SVG attributes page.js needs to place the time cursor.
std::string time_attributes(const Axis& time);

/// Vertical grid lines and the times below them; the last one names the unit.
void append_time_grid(std::string& svg, const Axis& time, double top, double bottom);

/// Shaded spans of faults between two heights, clipped to the axis.
void append_fault_shades(std::string& svg, const FlightRecord& record, const Axis& time, double top,
                         double bottom);

/// `<text class="tick" ...>` at a place, anchored at "start", "middle" or "end".
void append_tick_text(std::string& svg, double x, double y, std::string_view anchor,
                      std::string_view text);

}  // namespace rosflight::report
