// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

#include "flight/report/axis.hpp"
#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Directions in space a drawing can show along an axis.
enum class Direction : std::uint8_t { kNorth, kEast, kUp };

/// The path seen along one axis: one metre is as long across as it is high.
struct PathView {
  std::string_view title;
  Direction across{Direction::kEast};
  Direction up{Direction::kNorth};
  double width{560.0};
  double smallest_height{110.0};  ///< Of the plot; it grows with the path up to the largest.
  double largest_height{470.0};
};

inline constexpr PathView kFromAbove{"From above", Direction::kEast, Direction::kNorth};
inline constexpr PathView kFromSouth{
    "From the south", Direction::kEast, Direction::kUp, 560.0, 110.0, 220.0};
inline constexpr PathView kFromEast{
    "From the east", Direction::kNorth, Direction::kUp, 560.0, 110.0, 220.0};

/// Appends setpoints, flown path, numbered waypoints, start and end, with axes, as one <svg>.
/// @returns its height.
double append_path_svg(std::string& svg, const FlightRecord& record, const PathView& view);

/// The same as a figure of the page.
void append_path_figure(std::string& html, const FlightRecord& record, const PathView& view);

/// A picture that stands alone: path from above and from the south, side by side, colours included.
std::string path_svg(const FlightRecord& record);

/// `values` of the track for page.js:
/// {"t":[..],"n":[..],"e":[..],"u":[..],"waypoints":[[n,e,u],..]}, at most some 1500 points.
/// Missing values are null.
std::string track_json(const FlightRecord& record);

}  // namespace rosflight::report
