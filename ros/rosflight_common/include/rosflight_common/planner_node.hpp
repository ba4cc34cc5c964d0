// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/fence.hpp>
#include <rosflight_msgs/srv/param_file.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <vector>

#include "autonomy/common/geodesy.hpp"
#include "autonomy/common/mission_file.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/limits_input.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/paths.hpp"
#include "rosflight_common/vehicle_file.hpp"

namespace rosflight_common {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;

/// Does any waypoint of a mission file give its position on earth?
inline bool is_geodetic(const autonomy::MissionFile& mission) {
  const auto& list = mission.waypoints;
  return std::any_of(list.begin(), list.end(), [](const config::Section& wp) {
    return wp.boolean("use_lla", false) || wp.boolean("lla", false);
  });
}

/// Node path_planner of both stacks: an ordered list of waypoints, of which the first so many are
/// published. Late joiners get all that are in force: the topic keeps as many as a list can have. The fence of the mission file is
/// published on `mission/fence` (latched), before its waypoints.
///
/// Policy:
///
///     Waypoint, State, AddWaypoint          messages and service
///     kTopic, kServices                     name of the topic, prefix of the services
///     explicit Policy(const sim::Vehicle&)  limits of missions
///     Plan load(file, origin)               a struct with `waypoints` and `fence`, that of the file; throws config::Error
///     void check(Waypoint&, origin)         one from outside: made local, throws config::Error;
///                                           or with the list and the place it takes there
///     Waypoint waypoint_of(Request)         of AddWaypoint, unless it has a field wp
///     optional<Geodetic> origin(const State&)
///     string text(const Waypoint&)          one line
///
/// Derived classes learn of plans by changed().
template <class Policy>
class PlannerNode : public rclcpp::Node {
 public:
  using Waypoint = typename Policy::Waypoint;
  using State = typename Policy::State;
  using AddWaypoint = typename Policy::AddWaypoint;
  using Plan = typename Policy::Plan;

  explicit PlannerNode(const rclcpp::NodeOptions& options)
      : Node("path_planner", options),
        policy_{VehicleFile::declare(*this, Policy::kVehicle).read()} {
    max_published_ =
        declare_integer(*this, "num_waypoints_to_publish_at_start", kMaxWaypoints, 0, kMaxWaypoints,
                        "number of waypoints that are published at the start", true);
    const std::string file =
        declare_text(*this, "mission_file", "", "mission file (YAML) that is loaded at the start");
    waypoints_topic_ = create_latched_publisher<Waypoint>(
        *this, Policy::kTopic, static_cast<std::size_t>(kMaxWaypoints) + 1);
    fence_topic_ = create_latched_publisher<rosflight_msgs::msg::Fence>(*this, kFenceTopic, 1);
    states_ = create_subscription<State>(
        "estimated_state", stream(),
        [this](typename State::ConstSharedPtr message) { take_origin(*message); });
    serve();
    changes_ = on_change(*this, [this](const rclcpp::Parameter& parameter) {
      if (parameter.get_name() != "num_waypoints_to_publish_at_start") return;
      max_published_ = parameter.as_int();
      top_up();
    });
    publish_clear();
    if (!file.empty()) begin_with(file);
    publish_fence();
  }

 protected:
  /// The list is another, or another part of it is published.
  virtual void changed() {}
  const std::optional<Plan>& plan() const { return plan_; }  ///< From the file.
  bool all_published() const { return published_ == list_.size(); }

 private:
  using Trigger = std_srvs::srv::Trigger;
  using ParamFile = rosflight_msgs::srv::ParamFile;
  static constexpr std::int64_t kMaxWaypoints = autonomy::kMaxWaypoints;

  static std::string service(const char* name) { return std::string(Policy::kServices) + name; }

  template <class Act>
  void serve_trigger(const char* name, Act act) {
    triggers_.push_back(create_service<Trigger>(
        service(name), [act](const std::shared_ptr<Trigger::Request>,
                             std::shared_ptr<Trigger::Response> response) { act(*response); }));
  }

  void serve() {
    add_ = create_service<AddWaypoint>(
        service("add_waypoint"), [this](const std::shared_ptr<typename AddWaypoint::Request> in,
                                        std::shared_ptr<typename AddWaypoint::Response> out) {
          if constexpr (requires { in->wp; }) {
            add(in->wp, in->publish_now, *out);
          } else {
            add(Policy::waypoint_of(*in), in->publish_now, *out);
          }
        });
    load_ = create_service<ParamFile>(service("load_mission_from_file"),
                                      [this](const std::shared_ptr<ParamFile::Request> request,
                                             std::shared_ptr<ParamFile::Response> response) {
                                        response->success = load(user_path(request->filename));
                                      });
    serve_trigger("clear_waypoints", [this](Trigger::Response& response) {
      response.success = true;
      response.message = std::to_string(list_.size()) + " waypoints forgotten";
      clear();
    });
    serve_trigger("print_waypoints", [this](Trigger::Response& response) {
      for (std::size_t k = 0; k < list_.size(); ++k) {
        RCLCPP_INFO(get_logger(), "waypoint %zu%s: %s", k + 1,
                    k < published_ ? "" : " (not published)", policy_.text(list_[k]).c_str());
      }
      response.success = true;
      response.message =
          std::to_string(list_.size()) + " waypoints, " + std::to_string(published_) + " published";
    });
    serve_trigger("publish_next_waypoint", [this](Trigger::Response& response) {
      response.success = !all_published();
      if (response.success) publish_next();
      changed();
      response.message =
          response.success
              ? "waypoint " + std::to_string(published_) + " of " + std::to_string(list_.size())
              : "found " + std::to_string(list_.size()) +
                    " waypoints, all of them published: nothing is left";
    });
  }

  void add(const Waypoint& given, bool publish_now, typename AddWaypoint::Response& response) {
    Waypoint waypoint = given;
    try {
      if (list_.size() >= static_cast<std::size_t>(kMaxWaypoints)) {
        throw config::Error("waypoints: found " + std::to_string(kMaxWaypoints) +
                            " of them, allowed " + std::to_string(kMaxWaypoints));
      }
      if constexpr (requires { policy_.check(waypoint, origin_, list_, list_.size()); }) {
        policy_.check(waypoint, origin_, list_, publish_now ? published_ : list_.size());
      } else {
        policy_.check(waypoint, origin_);
      }
      const auto outside = autonomy::outside_of(fence(), position_of(waypoint));
      if (outside)
        throw config::Error("w: found " + outside->found + ", allowed " + outside->allowed);
    } catch (const config::Error& why) {
      response.success = false;
      response.message = why.what();
      return;
    }
    const auto place =
        publish_now ? list_.begin() + static_cast<std::ptrdiff_t>(published_) : list_.end();
    list_.insert(place, waypoint);
    if (publish_now) publish_next();
    top_up();
    response.success = true;
    response.message =
        std::to_string(list_.size()) + " waypoints, " + std::to_string(published_) + " published";
  }

  void begin_with(const std::string& file) {
    if (!is_geodetic(autonomy::MissionFile::load(file))) {
      take(policy_.load(file, {}));
      return;
    }
    waiting_file_ = file;
    RCLCPP_INFO(get_logger(), "%s waits for the origin of estimated_state", file.c_str());
  }

  bool load(const std::string& file) {
    try {
      take(policy_.load(file, origin_));
    } catch (const config::Error& why) {
      RCLCPP_ERROR(get_logger(), "%s", why.what());
      return false;
    }
    RCLCPP_INFO(get_logger(), "%s: %zu waypoints, %zu published", file.c_str(), list_.size(),
                published_);
    return true;
  }

  void take(Plan plan) {
    waiting_file_.reset();
    list_ = plan.waypoints;
    plan_ = std::move(plan);
    publish_fence();
    publish_clear();
    top_up();
  }

  void clear() {
    list_.clear();
    plan_.reset();
    waiting_file_.reset();
    publish_fence();
    publish_clear();
    changed();
  }

  std::optional<autonomy::Fence> fence() const { return plan_ ? plan_->fence : std::nullopt; }

  /// When it is another than before, and once at the start.
  void publish_fence() {
    if (fence_published_ && *fence_published_ == fence()) return;
    fence_published_ = fence();
    fence_topic_->publish(message_of(fence()));
  }

  /// The position of a waypoint that was made local.
  static autonomy::Vector3 position_of(const Waypoint& waypoint) {
    return {static_cast<double>(waypoint.w[0]), static_cast<double>(waypoint.w[1]),
            static_cast<double>(waypoint.w[2])};
  }

  void take_origin(const State& state) {
    origin_ = policy_.origin(state);
    if (!origin_) return;
    states_.reset();  // states have nothing else for a planner
    tell_executor(*this);
    if (waiting_file_) load(std::string(*waiting_file_));
  }

  void publish_clear() {
    Waypoint marker;
    marker.clear_wp_list = true;
    marker.header.stamp = now();
    waypoints_topic_->publish(marker);
    published_ = 0;
  }

  void publish_next() {
    Waypoint waypoint = list_[published_++];
    waypoint.header.stamp = now();
    waypoints_topic_->publish(waypoint);
  }

  void top_up() {
    const auto wanted = std::min(static_cast<std::size_t>(max_published_), list_.size());
    while (published_ < wanted) publish_next();
    changed();
  }

  Policy policy_;
  std::vector<Waypoint> list_;
  std::size_t published_{0};
  std::int64_t max_published_{kMaxWaypoints};
  std::optional<Plan> plan_;
  std::optional<std::optional<autonomy::Fence>> fence_published_;
  std::optional<autonomy::Geodetic> origin_;
  std::optional<std::string> waiting_file_;
  typename rclcpp::Publisher<Waypoint>::SharedPtr waypoints_topic_;
  rclcpp::Publisher<rosflight_msgs::msg::Fence>::SharedPtr fence_topic_;
  typename rclcpp::Subscription<State>::SharedPtr states_;
  typename rclcpp::Service<AddWaypoint>::SharedPtr add_;
  rclcpp::Service<ParamFile>::SharedPtr load_;
  std::vector<rclcpp::Service<Trigger>::SharedPtr> triggers_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace rosflight_common
