// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <rosplane_msgs/srv/add_waypoint.hpp>

#include "autonomy/fixedwing/mission.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/planner_node.hpp"
#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace flight = rosflight::flight;
namespace {

using config::number_text;

[[noreturn]] void refuse(const std::string& field, const std::string& found,
                         const std::string& allowed) {
  throw config::Error(field + ": found " + found + ", allowed " + allowed);
}

/// Waypoints of a fixed wing: lists that can be flown inside the limits of the vehicle file.
class Policy {
 public:
  using Waypoint = rosplane_msgs::msg::Waypoint;
  using State = rosplane_msgs::msg::State;
  using AddWaypoint = rosplane_msgs::srv::AddWaypoint;
  static constexpr const char* kVehicle = kUsualVehicle;
  static constexpr const char* kTopic = "waypoint_path";
  static constexpr const char* kServices = "";
  struct Plan {
    std::vector<Waypoint> waypoints;
    fixedwing::Mission mission;  ///< Its head counts; the waypoints are above.
    std::optional<autonomy::Fence> fence;
  };

  explicit Policy(const sim::Vehicle& vehicle)
      : limits_{flight::read_fixedwing_autonomy(vehicle).mission} {}

  Plan load(const std::string& file, const std::optional<autonomy::Geodetic>& origin) const {
    Plan plan;
    plan.mission = fixedwing::load_mission(file, limits_, origin);
    plan.fence = plan.mission.fence;
    // Circles at the end come from at_end; path_manager makes them again.
    for (std::size_t k = 0; k < plan.mission.waypoints.size(); ++k) {
      const fixedwing::Waypoint& wp = plan.mission.waypoints[k];
      const bool at_end = k + 1 == plan.mission.waypoints.size() && wp.hold_indefinitely;
      if (wp.passing == fixedwing::Passing::kLine ||
          (wp.passing == fixedwing::Passing::kCircle && !at_end)) {
        throw config::Error(file + ": waypoint " + std::to_string(k + 1) + ": found " +
                            (wp.passing == fixedwing::Passing::kLine ? "path line" : "type hold") +
                            ", allowed path fillet or dubins over ROS, because a Waypoint has no "
                            "room for it");
      }
      Waypoint message;
      put(wp, message);
      plan.waypoints.push_back(message);
      if (at_end) plan.mission.at_end = autonomy::AtEnd::kHold;
    }
    return plan;
  }

  static Waypoint waypoint_of(const AddWaypoint::Request& in) {
    Waypoint out;
    out.w = in.w;
    out.lla = in.lla;
    out.chi_d = in.chi_d;
    out.use_chi = in.use_chi;
    out.va_d = in.va_d;
    out.set_current = in.set_current;
    return out;
  }

  /// The list with this waypoint at `place` must be one that can be flown.
  void check(Waypoint& wp, const std::optional<autonomy::Geodetic>& origin,
             const std::vector<Waypoint>& list, std::size_t place) const {
    if (wp.set_current) {
      refuse("set_current", "true", "false: a path always begins where the vehicle is");
    }
    check_place(wp, origin);
    if (!(std::abs(wide(wp.chi_d)) <= 2.0 * autonomy::kPi))
      refuse("chi_d", number_text(wide(wp.chi_d)), "-2 pi to 2 pi");
    const double speed_m_s = wide(wp.va_d);
    const bool flown =
        speed_m_s >= limits_.min_airspeed_m_s && speed_m_s <= limits_.max_airspeed_m_s;
    if (speed_m_s != 0.0 && !flown) {
      refuse("va_d", number_text(speed_m_s),
             number_text(limits_.min_airspeed_m_s) + " to " +
                 number_text(limits_.max_airspeed_m_s) + " m/s, or 0 for cruise");
    }
    fixedwing::Mission mission;
    mission.at_end = autonomy::AtEnd::kLand;
    for (const Waypoint& message : list) {
      mission.waypoints.push_back(rosplane::waypoint_of(message, origin));
    }
    mission.waypoints.insert(mission.waypoints.begin() + static_cast<std::ptrdiff_t>(place),
                             rosplane::waypoint_of(wp, origin));
    if (const auto fault = fixedwing::check_mission(mission, limits_)) {
      refuse("waypoint " + std::to_string(fault->waypoint + 1), fault->found, fault->allowed);
    }
  }

  static std::optional<autonomy::Geodetic> origin(const State& state) { return origin_of(state); }

  static std::string text(const Waypoint& wp) {
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(), "north %.1f, east %.1f, down %.1f m, %.1f m/s, %s",
                  wide(wp.w[0]), wide(wp.w[1]), wide(wp.w[2]), wide(wp.va_d),
                  wp.use_chi ? "on its course" : "rounded off");
    return line.data();
  }

 private:
  void check_place(Waypoint& wp, const std::optional<autonomy::Geodetic>& origin) const {
    autonomy::Vector3 p_W = vector(wp.w);
    if (wp.lla) {
      if (!origin)
        refuse("lla", "true", "false: the origin is not known yet, no vehicle state has arrived");
      const bool on_earth = std::abs(p_W.x()) <= 90.0 && std::abs(p_W.y()) <= 180.0;
      if (!on_earth)
        refuse("w", number_text(p_W.x()) + ", " + number_text(p_W.y()), "latitude, longitude");
      p_W = autonomy::ned_of({p_W.x(), p_W.y(), p_W.z()}, *origin);
      put(p_W, wp.w);
      wp.lla = false;
    }
    const autonomy::MissionArea& area = limits_.area;
    const double distance_m = std::hypot(p_W.x(), p_W.y());
    if (!(distance_m <= area.max_distance_m)) {
      refuse("w", "a position " + number_text(distance_m) + " m from the origin",
             "at most " + number_text(area.max_distance_m) + " m");
    }
    const double height_m = -p_W.z();
    const bool inside = height_m >= area.min_height_m && height_m <= area.max_height_m;
    if (!inside) {
      refuse("w", "a height of " + number_text(height_m) + " m",
             number_text(area.min_height_m) + " to " + number_text(area.max_height_m) +
                 " m above the origin (down is positive)");
    }
  }

  fixedwing::MissionLimits limits_;
};

/// Publishes besides what a Waypoint has no field for: the end of the mission, its turns, take-off and landing.
class PathPlanner final : public rosflight_common::PlannerNode<Policy> {
 public:
  explicit PathPlanner(const rclcpp::NodeOptions& options) : PlannerNode(options) {
    settings_ = rosflight_common::create_latched_publisher<rosplane_msgs::msg::MissionSettings>(
        *this, "mission_settings", 1);
    changed();
  }

 private:
  void changed() final {
    if (!settings_) return;  // still being made
    rosplane_msgs::msg::MissionSettings message;
    message.at_end = rosplane_msgs::msg::MissionSettings::HOLD;  // of waypoints added one by one
    message.takeoff_height = message.turn_radius = message.landing_course = kUnknown;
    const std::optional<Policy::Plan>& loaded = plan();
    if (loaded) put(loaded->mission, message);
    // Waypoints that wait to be published are no end: it circles there.
    if (!all_published()) message.at_end = rosplane_msgs::msg::MissionSettings::HOLD;
    message.header.stamp = now();
    settings_->publish(message);
  }

  rclcpp::Publisher<rosplane_msgs::msg::MissionSettings>::SharedPtr settings_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::PathPlanner, SingleThreadedExecutor)
