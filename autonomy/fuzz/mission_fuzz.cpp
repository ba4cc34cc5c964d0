// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "autonomy/multirotor/mission.hpp"
#include "config/strict_yaml.hpp"

/// Any bytes as a mission file: refused with one line, or a mission within the limits.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const autonomy::multirotor::MissionLimits limits;
  try {
    const autonomy::multirotor::Mission mission = autonomy::multirotor::read_mission(
        text, "fuzz", limits, autonomy::Geodetic{40.0, -111.0, 1400.0});
    const auto need = [](bool holds) {
      if (!holds) std::abort();
    };
    need(!mission.waypoints.empty() && mission.waypoints.size() <= autonomy::kMaxWaypoints);
    for (const autonomy::multirotor::Waypoint& wp : mission.waypoints) {
      need(std::hypot(wp.p_W.x(), wp.p_W.y()) <= limits.max_distance_m);
      need(-wp.p_W.z() >= limits.min_height_m && -wp.p_W.z() <= limits.max_height_m);
      need(wp.speed_m_s > 0.0 && wp.speed_m_s <= limits.max_speed_m_s);
      need(wp.hold_s >= 0.0 && std::isfinite(wp.hold_s) && std::abs(wp.psi_rad) < 7.0);
    }
  } catch (const config::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
