// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/mission_file.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

namespace rosflight::autonomy {
namespace {

using config::Document;
using config::number_text;
using config::Range;
using config::Section;

constexpr double kMaxHold_s = 86400.0;
constexpr double kMinTakeoff_m = 0.3;

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

MissionFile open(const Document& document, const std::string& name) {
  MissionFile out;
  if (document.is_list()) {
    out.waypoints = document.root_sections();
  } else {
    out.root = document.root();
    out.waypoints = out.root->sections("mission");
  }
  const std::size_t count = out.waypoints.size();
  if (count >= 1 && count <= kMaxWaypoints) return out;
  const std::string found = std::to_string(count) + " waypoints";
  const std::string allowed = "1 to " + std::to_string(kMaxWaypoints);
  throw out.root ? out.root->error("mission", found, allowed)
                 : config::Error(name + ": found " + found + ", allowed " + allowed);
}

}  // namespace

MissionFile MissionFile::read(std::string_view text, const std::string& name) {
  const auto list = repeats_wp(text) ? as_list(text) : std::string(text);
  return open(Document::from_text(list, name), name);
}

MissionFile MissionFile::load(const std::filesystem::path& file) {
  std::error_code code;
  const bool readable = std::filesystem::is_regular_file(file, code) &&
                        std::filesystem::file_size(file, code) <= Document::kMaxBytes && !code;
  if (readable) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (repeats_wp(text.str())) return read(text.str(), file.string());
  }
  return open(Document::from_file(file), file.string());
}

std::optional<double> MissionFile::score_radius_m() const {
  if (!root || !root->has("score_radius_m")) return {};
  return root->number("score_radius_m", Range::positive_up_to(1000.0));
}

std::optional<double> MissionFile::takeoff_height_m(const MissionArea& area) const {
  if (!root || !root->has("takeoff_height_m")) return {};
  return root->number("takeoff_height_m", Range::between(kMinTakeoff_m, area.max_height_m));
}

std::optional<Fence> MissionFile::fence() const {
  if (!root) return {};
  const auto in = root->optional_section("fence");
  if (!in) return {};
  Fence out;
  out.radius_m = in->number("radius_m", Range::between(1.0, 100000.0));
  out.height_m = in->number("height_m", Range::between(1.0, 10000.0));
  in->finish();
  return out;
}

AtEnd MissionFile::at_end(const Section::Choices<AtEnd>& choices) const {
  const AtEnd usual = choices.front().second;
  return root ? root->choice<AtEnd>("at_end", choices, usual) : usual;
}

void MissionFile::finish() const {
  if (root) root->finish();
}

WaypointType waypoint_type(const Section& wp) {
  return wp.choice<WaypointType>("type", {{"goto", WaypointType::kGoto},
                                          {"hold", WaypointType::kHold},
                                          {"1", WaypointType::kGoto},
                                          {"0", WaypointType::kHold}});
}

Vector3 waypoint_position(const Section& wp, const MissionArea& area,
                          const std::optional<Geodetic>& origin) {
  if (wp.has("use_lla") && wp.has("lla")) {
    throw wp.error("lla", "use_lla beside it", "one of the two");
  }
  const std::string_view key = wp.has("lla") ? "lla" : "use_lla";
  const bool geodetic = wp.boolean(key, false);
  const std::vector<double> w = wp.numbers("w", 3, Range::any());
  Vector3 p_W{w[0], w[1], w[2]};
  if (geodetic) {
    if (!origin)
      throw wp.error(key, "true", "false, because the start has no known position on earth");
    if (std::abs(w[0]) > 90.0)
      throw wp.error("w", "latitude " + number_text(w[0]), "-90 to 90 deg");
    if (std::abs(w[1]) > 180.0)
      throw wp.error("w", "longitude " + number_text(w[1]), "-180 to 180 deg");
    if (!(std::abs(w[2]) < 20000.0))
      throw wp.error("w", "altitude " + number_text(w[2]), "-20000 to 20000 m");
    p_W = ned_of({w[0], w[1], w[2]}, *origin);
  }
  const double distance_m = std::hypot(p_W.x(), p_W.y());
  if (!(distance_m <= area.max_distance_m)) {
    throw wp.error("w", "a position " + number_text(std::round(distance_m)) + " m from the start",
                   "at most " + number_text(area.max_distance_m) + " m");
  }
  const double height_m = -p_W.z();
  if (!Range::between(area.min_height_m, area.max_height_m).contains(height_m)) {
    throw wp.error("w", "a height of " + number_text(std::round(height_m * 100.0) / 100.0) + " m",
                   number_text(area.min_height_m) + " to " + number_text(area.max_height_m) +
                       " m above the start (down is positive in NED)");
  }
  return p_W;
}

std::optional<OutsideOfFence> outside_of(const std::optional<Fence>& fence, const Vector3& p_W) {
  if (!fence || fence->holds(p_W)) return {};
  return OutsideOfFence{"a position " + number_text(std::round(p_W.head<2>().norm())) +
                            " m from the start, " + number_text(std::round(-p_W.z())) + " m high",
                        "inside of the fence: " + number_text(fence->radius_m) + " m and " +
                            number_text(fence->height_m) + " m"};
}

void check_fence(const Section& wp, const std::optional<Fence>& fence, const Vector3& p_W) {
  const auto outside = outside_of(fence, p_W);
  if (outside) throw wp.error("w", outside->found, outside->allowed);
}

std::optional<double> waypoint_heading_rad(const Section& wp, std::string_view radians) {
  if (wp.has(radians) && wp.has("heading_deg")) {
    throw wp.error("heading_deg", std::string(radians) + " beside it",
                   "either " + std::string(radians) + " or heading_deg");
  }
  if (wp.has("heading_deg"))
    return wp.number("heading_deg", Range::between(-360.0, 360.0)) * kRadPerDeg;
  if (wp.has(radians)) return wp.number(radians, Range::between(-2.0 * kPi, 2.0 * kPi));
  return {};
}

HoldTime waypoint_hold(const Section& wp, WaypointType type) {
  HoldTime out;
  const bool hold = type == WaypointType::kHold;
  out.indefinitely = wp.boolean("hold_indefinitely", false);
  if (!hold && out.indefinitely)
    throw wp.error("hold_indefinitely", "true at a goto", "false, or type hold");
  const Range seconds = Range::between(0.0, hold ? kMaxHold_s : 0.0);
  const bool must_say = hold && !out.indefinitely;
  out.hold_s =
      must_say ? wp.number("hold_seconds", seconds) : wp.number("hold_seconds", seconds, 0.0);
  return out;
}

}  // namespace rosflight::autonomy
