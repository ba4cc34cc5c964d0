// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <optional>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosflight_msgs/srv/set_sim_state.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "messages/simulation.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/vehicle_tuning.hpp"
#include "sim/dynamics/rigid_body.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;
namespace hal = rosflight::hal;
namespace messages = rosflight::messages;
namespace {

using namespace rosflight_common;
using messages::from_message;

using rosflight_msgs::srv::SetSimState;
using std_srvs::srv::Trigger;

/// The wrench of another node, as a forces-and-moments module without states.
class HeldWrench final : public sim::ForcesAndMoments {
 public:
  std::size_t state_size() const override { return 0; }
  void initial_state(std::span<double> /*x*/) const override {}
  void evaluate(const Input& /*in*/, std::span<const double> /*x*/, sim::Wrench& wrench,
                std::span<double> /*x_dot*/) const override {
    wrench = held;
  }
  sim::Wrench held;
};

/// Moves the body under the wrenches it is sent: from the stamp of the last one to that of this
/// one, then publishes truth and wind. Stamps that stand publish only; those that go back begin
/// again; a gap of more than max_gap_s moves the body by that much.
class DynamicsNode : public rclcpp::Node {
 public:
  explicit DynamicsNode(const rclcpp::NodeOptions& options)
      : Node("dynamics", options),
        parameters_{VehicleParameters::declare(*this)},
        tuning_{*this, dynamics_views(), parameters_, [this] { retune(); }} {
    max_gap_s_ = declare_number(*this, "max_gap_s", 0.1, 0.001, 10.0,
                                "maximum step that one wrench may stand for [s]");
    body_ = make_body();
    truth_ = create_publisher<rosflight_msgs::msg::SimState>("sim/truth_state", newest());
    wind_ = create_publisher<geometry_msgs::msg::Vector3Stamped>("sim/truth_wind", newest());
    set_state_ = create_service<SetSimState>(
        "dynamics/set_sim_state", [this](const std::shared_ptr<SetSimState::Request> request,
                                         std::shared_ptr<SetSimState::Response> response) {
          set_state(request->state, *response);
        });
    reset_ = create_service<Trigger>("dynamics/reset",
                                     [this](const std::shared_ptr<Trigger::Request>,
                                            std::shared_ptr<Trigger::Response> response) {
                                       body_ = make_body();
                                       publish(newest_stamp());
                                       response->success = true;
                                       response->message = "at rest at the origin";
                                     });
    wrenches_ = create_subscription<geometry_msgs::msg::WrenchStamped>(
        "sim/forces_and_moments", newest(),
        [this](geometry_msgs::msg::WrenchStamped::ConstSharedPtr message) { step(*message); });
  }

 private:
  std::unique_ptr<sim::RigidBody> make_body() const {
    const sim::Vehicle& vehicle = parameters_.vehicle;
    return std::make_unique<sim::RigidBody>(vehicle.body(), vehicle.ground(), vehicle.environment(),
                                            forces_, parameters_.random);
  }

  /// Another body or wind, where and as fast as the one before.
  void retune() {
    const sim::BodyState state = body_->truth().body;
    body_ = make_body();
    body_->set_state(state);
  }

  void step(const geometry_msgs::msg::WrenchStamped& message) {
    if (!from_message(from_ros<messages::geometry_msgs::WrenchStamped>(message), forces_.held)) {
      constexpr int kInterval_ms = 2000;
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms,
                           "sim/forces_and_moments: found numbers that are not finite, not used");
      return;
    }
    const std::int64_t stamp = nanoseconds(message.header.stamp);
    std::int64_t gap_ns = started_ ? stamp - last_stamp_ns_ : 0;
    started_ = true;
    last_stamp_ns_ = stamp;
    const auto max_ns = static_cast<std::int64_t>(max_gap_s_ * 1e9);
    if (gap_ns > max_ns) {
      report_gap(gap_ns);
      gap_ns = max_ns;
    }
    if (gap_ns > 0) {
      pending_ns_ += gap_ns;
      constexpr std::int64_t kMicrosecond_ns = 1000;
      body_->step(body_->truth().time + hal::Time{pending_ns_ / kMicrosecond_ns},
                  hal::OutputValues{});
      pending_ns_ %= kMicrosecond_ns;
    }
    publish(message.header.stamp);
  }

  /// For what a service has published. Only before the first wrench is it that of a clock, so the launch files give this node none.
  builtin_interfaces::msg::Time newest_stamp() {
    return started_ ? stamp_of(last_stamp_ns_) : static_cast<builtin_interfaces::msg::Time>(now());
  }

  /// The first at once, later ones in one line each five seconds.
  void report_gap(std::int64_t gap_ns) {
    ++gaps_;
    max_gap_ns_ = std::max(max_gap_ns_, gap_ns);
    const auto now = std::chrono::steady_clock::now();
    constexpr auto kInterval = std::chrono::seconds(5);
    if (gaps_reported_ && now - *gaps_reported_ < kInterval) return;
    RCLCPP_WARN(get_logger(),
                "%.3f s between two wrenches, gaps since the last report: %d: each moves the body "
                "by %.3f s",
                static_cast<double>(max_gap_ns_) * 1e-9, gaps_, max_gap_s_);
    gaps_reported_ = now;
    gaps_ = 0;
    max_gap_ns_ = 0;
  }

  void publish(const builtin_interfaces::msg::Time& stamp) {
    publish_wind(stamp);
    auto state = to_ros<rosflight_msgs::msg::SimState>(
        messages::to_message(body_->truth(), parameters_.vehicle.environment().gravity_m_s2));
    state.header.stamp = stamp;
    state.header.frame_id = "NED";
    truth_->publish(state);
  }

  /// As often as the truth while it changes; a wind that stands, each tenth time.
  void publish_wind(const builtin_interfaces::msg::Time& stamp) {
    constexpr int kEvery = 10;
    const sim::Vector3 wind_W = body_->truth().air.wind_W;
    if (wind_W == told_wind_W_ && ++winds_ % kEvery != 0) return;
    told_wind_W_ = wind_W;
    auto wind = to_ros<geometry_msgs::msg::Vector3Stamped>(messages::wind_message(wind_W));
    wind.header.stamp = stamp;
    wind.header.frame_id = "NED";
    wind_->publish(wind);
  }

  /// An all-zero pose means the start: at rest on the gear, whose height the caller cannot know.
  void set_state(const rosflight_msgs::msg::SimState& state, SetSimState::Response& response) {
    sim::BodyState body = messages::body_state(from_ros<messages::rosflight_msgs::SimState>(state));
    if (body.p_W.isZero() && body.v_B.isZero() && body.w_B.isZero())
      body.p_W = body_->rest_state().p_W;
    response.success = body_->set_state(body);
    response.message = response.success
                           ? "set"
                           : "found a NaN, no rotation or a position below the ground, "
                             "allowed finite numbers and z <= 0 (down is positive)";
    if (response.success) publish(newest_stamp());
  }

  VehicleParameters parameters_;
  VehicleTuning tuning_;
  HeldWrench forces_;
  std::unique_ptr<sim::RigidBody> body_;
  double max_gap_s_{};
  bool started_{false};
  std::int64_t last_stamp_ns_{0};
  std::int64_t pending_ns_{0};
  std::optional<sim::Vector3> told_wind_W_;
  int winds_{0};  ///< That were the same as the one before.
  int gaps_{0};   ///< Since the last report.
  std::int64_t max_gap_ns_{0};
  std::optional<std::chrono::steady_clock::time_point> gaps_reported_;
  rclcpp::Publisher<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::Publisher<geometry_msgs::msg::Vector3Stamped>::SharedPtr wind_;
  rclcpp::Service<SetSimState>::SharedPtr set_state_;
  rclcpp::Service<Trigger>::SharedPtr reset_;
  rclcpp::Subscription<geometry_msgs::msg::WrenchStamped>::SharedPtr wrenches_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::DynamicsNode, SingleThreadedExecutor)
