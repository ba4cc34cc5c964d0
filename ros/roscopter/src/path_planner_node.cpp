// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <limits>
#include <roscopter_msgs/srv/add_waypoint.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_msgs/msg/string.hpp>

#include "autonomy/multirotor/mission.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "roscopter/conversions.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/planner_node.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace flight = rosflight::flight;
namespace {

using config::number_text;

bool between(double x, double min, double max) {
  return x >= min && x <= max;
}

[[noreturn]] void refuse(const std::string& field, const std::string& found,
                         const std::string& allowed) {
  throw config::Error("wp." + field + ": found " + found + ", allowed " + allowed);
}

/// Waypoints of a multirotor: missions inside the limits of the vehicle file.
class Policy {
 public:
  using Waypoint = roscopter_msgs::msg::Waypoint;
  using State = roscopter_msgs::msg::State;
  using AddWaypoint = roscopter_msgs::srv::AddWaypoint;
  static constexpr const char* kVehicle = kUsualVehicle;
  static constexpr const char* kTopic = "waypoints";
  static constexpr const char* kServices = "path_planner/";
  struct Plan {
    std::vector<Waypoint> waypoints;
    autonomy::AtEnd at_end{autonomy::AtEnd::kLand};
    std::optional<double> takeoff_height_m;
    std::optional<autonomy::Fence> fence;
  };

  explicit Policy(const sim::Vehicle& vehicle)
      : limits_{flight::read_multirotor_autonomy(vehicle).mission} {}

  Plan load(const std::string& file, const std::optional<autonomy::Geodetic>& origin) const {
    const autonomy::multirotor::Mission mission =
        autonomy::multirotor::load_mission(file, limits_, origin);
    Plan plan;
    plan.at_end = mission.at_end;
    plan.takeoff_height_m = mission.takeoff_height_m;
    plan.fence = mission.fence;
    for (const autonomy::multirotor::Waypoint& waypoint : mission.waypoints) {
      if (waypoint.figure_turns > 0) {
        throw config::Error(file +
                            ": figure_eight: found one, allowed none over ROS, because a Waypoint "
                            "has no room for it");
      }
      plan.waypoints.push_back(message_of(waypoint));
    }
    return plan;
  }

  void check(Waypoint& wp, const std::optional<autonomy::Geodetic>& origin) const {
    if (wp.clear_wp_list) refuse("clear_wp_list", "true", "false; call clear_waypoints");
    if (wp.type > Waypoint::TYPE_GOTO)
      refuse("type", std::to_string(wp.type), "0 (hold) or 1 (goto)");
    check_place(wp, origin);
    if (!(std::abs(static_cast<double>(wp.psi)) <= 2.0 * autonomy::kPi))
      refuse("psi", number_text(static_cast<double>(wp.psi)), "-2 pi to 2 pi");
    const bool speed_fits =
        wp.speed == 0.0F ||
        (wp.speed >= kMinSpeed_m_s && static_cast<double>(wp.speed) <= limits_.max_speed_m_s);
    if (!speed_fits) {
      refuse("speed", number_text(static_cast<double>(wp.speed)),
             "0.1 to " + number_text(limits_.max_speed_m_s) + ", or 0 for the vehicle's");
    }
    if (!between(static_cast<double>(wp.hold_seconds), 0.0, kMaxHold_s))
      refuse("hold_seconds", number_text(static_cast<double>(wp.hold_seconds)), "0 to 86400");
    if (wp.hold_indefinitely && wp.type == Waypoint::TYPE_GOTO)
      refuse("hold_indefinitely", "true at a goto", "false, or type 0");
  }

  static std::optional<autonomy::Geodetic> origin(const State& state) { return origin_of(state); }

  static std::string text(const Waypoint& wp) {
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(),
                  "%s north %.2f, east %.2f, down %.2f m, heading %.2f rad, hold %.1f s%s",
                  wp.type == Waypoint::TYPE_GOTO ? "goto" : "hold", static_cast<double>(wp.w[0]),
                  static_cast<double>(wp.w[1]), static_cast<double>(wp.w[2]),
                  static_cast<double>(wp.psi), static_cast<double>(wp.hold_seconds),
                  wp.hold_indefinitely ? " and for ever" : "");
    return line.data();
  }

 private:
  static constexpr float kMinSpeed_m_s = 0.1F;
  static constexpr double kMaxHold_s = 86400.0;

  void check_place(Waypoint& wp, const std::optional<autonomy::Geodetic>& origin) const {
    autonomy::Vector3 p_W = vector(wp.w);
    if (wp.use_lla) {
      if (!origin)
        refuse("use_lla", "true",
               "false: the origin is not known yet, no vehicle state has arrived");
      if (!between(p_W.x(), -90.0, 90.0) || !between(p_W.y(), -180.0, 180.0))
        refuse("w", number_text(p_W.x()) + ", " + number_text(p_W.y()), "latitude, longitude");
      p_W = autonomy::ned_of({p_W.x(), p_W.y(), p_W.z()}, *origin);
      wp.w = array(p_W);
      wp.use_lla = false;
    }
    const double distance_m = std::hypot(p_W.x(), p_W.y());
    if (!(distance_m <= limits_.max_distance_m)) {
      refuse("w", "a position " + number_text(distance_m) + " m from the origin",
             "at most " + number_text(limits_.max_distance_m) + " m");
    }
    const double height_m = -p_W.z();
    if (!between(height_m, limits_.min_height_m, limits_.max_height_m)) {
      refuse("w", "a height of " + number_text(height_m) + " m",
             number_text(limits_.min_height_m) + " to " + number_text(limits_.max_height_m) +
                 " m above the origin (down is positive)");
    }
  }

  autonomy::multirotor::MissionLimits limits_;
};

const char* word(autonomy::AtEnd at_end) {
  switch (at_end) {
    case autonomy::AtEnd::kHold:
      return "hold";
    case autonomy::AtEnd::kCycle:
      return "cycle";
    case autonomy::AtEnd::kLand:
    case autonomy::AtEnd::kReturn:
      break;
  }
  return "land";
}

/// Publishes besides what a Waypoint has no field for: what happens at the end, and the height of the take-off.
class PathPlanner final : public rosflight_common::PlannerNode<Policy> {
 public:
  explicit PathPlanner(const rclcpp::NodeOptions& options) : PlannerNode(options) {
    at_end_ = rosflight_common::create_latched_publisher<std_msgs::msg::String>(
        *this, "mission/at_end", 1);
    takeoff_ = rosflight_common::create_latched_publisher<std_msgs::msg::Float64>(
        *this, "mission/takeoff_height", 1);
    changed();
  }

 private:
  void changed() final {
    if (!at_end_) return;  // still being made
    // Waypoints that wait to be published are no end: it holds there.
    const std::optional<Policy::Plan>& mission = plan();
    std_msgs::msg::String end;
    std_msgs::msg::Float64 height;
    height.data = std::numeric_limits<double>::quiet_NaN();
    if (mission) {
      end.data = all_published() ? word(mission->at_end) : "hold";
      height.data = mission->takeoff_height_m.value_or(height.data);
    }
    at_end_->publish(end);
    takeoff_->publish(height);
  }

  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr at_end_;
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr takeoff_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::PathPlanner, SingleThreadedExecutor)
