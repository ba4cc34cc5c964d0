// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/mission.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::autonomy {
namespace {

using config::Document;
using config::number_text;
using config::Range;
using config::Section;

constexpr double kSlowestLeg_m_s = 0.1;
constexpr double kLongestHold_s = 86400.0;
constexpr double kLowestTakeoff_m = 0.3;

bool is_waypoint_line(std::string_view line) {
  return line.rfind("wp:", 0) == 0 && (line.size() == 3 || line[3] == ' ' || line[3] == '\r');
}

template <typename Visit>
void for_each_line(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const auto end = text.find('\n');
    visit(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
}

/// The file of ROSflight 2.x is a map whose key `wp` repeats. As a list it is YAML, line by line
/// the same.
bool repeats_wp(std::string_view text) {
  bool found = false;
  bool decided = false;
  for_each_line(text, [&](std::string_view line) {
    const auto first = line.find_first_not_of(" \t\r");
    const bool blank = first == std::string_view::npos || line[first] == '#';
    if (decided || blank || line.rfind("---", 0) == 0) return;
    decided = true;
    found = is_waypoint_line(line);
  });
  return found;
}

std::string as_list(std::string_view text) {
  std::string out;
  out.reserve(text.size() + 1);
  for_each_line(text, [&](std::string_view line) {
    if (is_waypoint_line(line)) {
      out.append("-  ").append(line.substr(3));
    } else {
      out.append(line);
    }
    out.push_back('\n');
  });
  return out;
}

double heading_of(const Section& wp) {
  if (wp.has("psi") && wp.has("heading_deg")) {
    throw wp.error("heading_deg", "psi beside it", "either psi or heading_deg");
  }
  if (wp.has("heading_deg"))
    return wp.number("heading_deg", Range::between(-360.0, 360.0)) * kRadPerDeg;
  return wp.number("psi", Range::between(-2.0 * kPi, 2.0 * kPi));
}

Vector3 position_of(const Section& wp, const MissionLimits& limits,
                    const std::optional<Geodetic>& origin) {
  const bool geodetic = wp.boolean("use_lla", false);
  const std::vector<double> w = wp.numbers("w", 3, Range::any());
  Vector3 p_N{w[0], w[1], w[2]};
  if (geodetic) {
    if (!origin)
      throw wp.error("use_lla", "true", "false, because the start has no known place on earth");
    if (std::abs(w[0]) > 90.0)
      throw wp.error("w", "latitude " + number_text(w[0]), "-90 to 90 deg");
    if (std::abs(w[1]) > 180.0)
      throw wp.error("w", "longitude " + number_text(w[1]), "-180 to 180 deg");
    if (!(std::abs(w[2]) < 20000.0))
      throw wp.error("w", "altitude " + number_text(w[2]), "-20000 to 20000 m");
    p_N = ned_of({w[0], w[1], w[2]}, *origin);
  }
  const double distance_m = std::hypot(p_N.x(), p_N.y());
  if (!(distance_m <= limits.max_distance_m)) {
    throw wp.error("w", "a place " + number_text(std::round(distance_m)) + " m from the start",
                   "at most " + number_text(limits.max_distance_m) + " m");
  }
  const double height_m = -p_N.z();
  if (!Range::between(limits.min_height_m, limits.max_height_m).contains(height_m)) {
    throw wp.error("w", "a height of " + number_text(std::round(height_m * 100.0) / 100.0) + " m",
                   number_text(limits.min_height_m) + " to " + number_text(limits.max_height_m) +
                       " m above the start (down is positive in NED)");
  }
  return p_N;
}

Waypoint waypoint_of(const Section& wp, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  Waypoint out;
  out.type = wp.choice<WaypointType>("type", {{"goto", WaypointType::kGoto},
                                              {"hold", WaypointType::kHold},
                                              {"1", WaypointType::kGoto},
                                              {"0", WaypointType::kHold}});
  out.p_N = position_of(wp, limits, origin);
  out.psi_rad = heading_of(wp);
  out.speed_m_s = wp.number("speed", Range::between(kSlowestLeg_m_s, limits.max_speed_m_s),
                            limits.max_speed_m_s);
  const bool hold = out.type == WaypointType::kHold;
  out.hold_indefinitely = wp.boolean("hold_indefinitely", false);
  if (!hold && out.hold_indefinitely)
    throw wp.error("hold_indefinitely", "true at a goto", "false, or type hold");
  const Range seconds = Range::between(0.0, hold ? kLongestHold_s : 0.0);
  const bool must_say = hold && !out.hold_indefinitely;
  out.hold_s =
      must_say ? wp.number("hold_seconds", seconds) : wp.number("hold_seconds", seconds, 0.0);
  return out;
}

std::vector<Waypoint> waypoints_of(const std::vector<Section>& list, const MissionLimits& limits,
                                   const std::optional<Geodetic>& origin) {
  std::vector<Waypoint> out;
  out.reserve(list.size());
  for (const Section& wp : list) {
    if (!out.empty() && out.back().hold_indefinitely) {
      throw wp.error("a waypoint behind one that holds for ever",
                     "hold_indefinitely at the last waypoint only");
    }
    out.push_back(waypoint_of(wp, limits, origin));
    wp.finish();
  }
  return out;
}

Mission read(const Document& document, const MissionLimits& limits,
             const std::optional<Geodetic>& origin) {
  if (document.is_list())
    return {waypoints_of(document.root_sections(), limits, origin), AtEnd::kLand, {}};
  const Section root = document.root();
  Mission mission;
  if (root.has("takeoff_height_m")) {
    mission.takeoff_height_m =
        root.number("takeoff_height_m", Range::between(kLowestTakeoff_m, limits.max_height_m));
  }
  mission.at_end = root.choice<AtEnd>(
      "at_end", {{"land", AtEnd::kLand}, {"hold", AtEnd::kHold}, {"cycle", AtEnd::kCycle}},
      AtEnd::kLand);
  const std::vector<Section> list = root.sections("mission");
  const std::string count = std::to_string(list.size()) + " waypoints";
  if (list.empty() || list.size() > kMaxWaypoints) {
    throw root.error("mission", count, "1 to " + std::to_string(kMaxWaypoints));
  }
  mission.waypoints = waypoints_of(list, limits, origin);
  root.finish();
  return mission;
}

}  // namespace

Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  if (!repeats_wp(text)) return read(Document::from_text(text, name), limits, origin);
  const Document document = Document::from_text(as_list(text), name);
  if (document.root_sections().size() > kMaxWaypoints) {
    throw config::Error(name + ": wp: found " + std::to_string(document.root_sections().size()) +
                        " waypoints, allowed 1 to " + std::to_string(kMaxWaypoints));
  }
  return read(document, limits, origin);
}

Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  std::error_code code;
  const bool readable = std::filesystem::is_regular_file(file, code) &&
                        std::filesystem::file_size(file, code) <= Document::kMaxBytes && !code;
  if (readable) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (repeats_wp(text.str())) return read_mission(text.str(), file.string(), limits, origin);
  }
  return read(Document::from_file(file), limits, origin);
}

}  // namespace rosflight::autonomy
