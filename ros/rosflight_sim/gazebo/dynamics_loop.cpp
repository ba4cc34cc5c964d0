// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics_loop.hpp"

#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosflight_msgs/srv/set_sim_state.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <utility>

#include "messages/simulation.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosflight_sim {

namespace messages = rosflight::messages;
using namespace rosflight_common;
using gazebo::link_of;
using gazebo::link_wrench;
using gazebo::LinkState;
using gazebo::Run;
using gazebo::StepCommand;
using rosflight_msgs::srv::SetSimState;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;
using std_srvs::srv::Trigger;

namespace {

constexpr auto kLook = std::chrono::milliseconds(5);  ///< Between two looks while Gazebo stands.

/// Gazebo handles the signals. Another plugin may have begun.
void begin_ros() {
  if (!rclcpp::ok())
    rclcpp::init(0, nullptr, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None);
}

/// A state that no body can be in.
const char* wrong(const sim::BodyState& body) {
  if (!body.p_W.allFinite() || !body.v_B.allFinite() || !body.w_B.allFinite() ||
      !body.q_WB.coeffs().allFinite() || !(body.q_WB.norm() > 1e-6) || body.p_W.z() > 0.0)
    return "found a NaN, no rotation or a position below the ground, allowed finite numbers and z "
           "<= 0 (down is positive)";
  return nullptr;
}

}  // namespace

struct DynamicsLoop::Topics {
  explicit Topics(DynamicsLoop& loop)
      : node{std::make_shared<rclcpp::Node>("gazebo_dynamics", loop.options_.name_space,
                                            rclcpp::NodeOptions().use_global_arguments(false))},
        truth{node->create_publisher<rosflight_msgs::msg::SimState>("sim/truth_state", newest())},
        wind{
            node->create_publisher<geometry_msgs::msg::Vector3Stamped>("sim/truth_wind", newest())},
        set_state{node->create_service<SetSimState>(
            "dynamics/set_sim_state",
            [&loop](const std::shared_ptr<SetSimState::Request> request,
                    std::shared_ptr<SetSimState::Response> response) {
              const char* const error = loop.ask(messages::body_state(
                  from_ros<messages::rosflight_msgs::SimState>(request->state)));
              response->success = error == nullptr;
              response->message = response->success ? "set with the next step" : error;
            })},
        reset{node->create_service<Trigger>("dynamics/reset",
                                            [&loop](const std::shared_ptr<Trigger::Request>,
                                                    std::shared_ptr<Trigger::Response> response) {
                                              response->success = loop.ask({}) == nullptr;
                                              response->message = "at its start at the next step";
                                            })},
        wrenches{node->create_subscription<geometry_msgs::msg::WrenchStamped>(
            "sim/forces_and_moments", newest(),
            [this, &loop](geometry_msgs::msg::WrenchStamped::ConstSharedPtr message) {
              sim::Wrench wrench;
              if (messages::from_message(from_ros<messages::geometry_msgs::WrenchStamped>(*message),
                                         wrench))
                return loop.receive(
                    nanoseconds(rosflight_common::nanoseconds(message->header.stamp)), wrench);
              constexpr int kInterval_ms = 2000;
              RCLCPP_WARN_THROTTLE(
                  node->get_logger(), *node->get_clock(), kInterval_ms,
                  "sim/forces_and_moments: found numbers that are not finite, not used");
            })} {
    executor.add_node(node);
  }

  std::shared_ptr<rclcpp::Node> node;
  rclcpp::Publisher<rosflight_msgs::msg::SimState>::SharedPtr truth;
  rclcpp::Publisher<geometry_msgs::msg::Vector3Stamped>::SharedPtr wind;
  rclcpp::Service<SetSimState>::SharedPtr set_state;
  rclcpp::Service<Trigger>::SharedPtr reset;
  rclcpp::Subscription<geometry_msgs::msg::WrenchStamped>::SharedPtr wrenches;
  rclcpp::executors::SingleThreadedExecutor executor;
};

DynamicsLoop::DynamicsLoop(const sim::Vehicle& vehicle, const gazebo::PluginOptions& options,
                           const sim::Vector3& c_L, gazebo::LinkCoupling::Say say)
    : options_{options},
      say_{std::move(say)},
      gravity_m_s2_{vehicle.environment().gravity_m_s2},
      steps_{options.max_gap},
      truth_{c_L, gravity_m_s2_},
      wind_{vehicle.environment().wind, sim::RandomSource{options.choice.seed}} {
  begin_ros();
  topics_ = std::make_unique<Topics>(*this);
}

DynamicsLoop::~DynamicsLoop() = default;

void DynamicsLoop::spin(nanoseconds longest) {
  topics_->executor.spin_once(longest);
  topics_->executor.spin_some();
}

StepCommand DynamicsLoop::before_step(nanoseconds step) {
  step_ = step;
  we_paused_ = stands_ = false;
  topics_->executor.spin_some();
  const auto end = steady_clock::now() + options_.wait;
  while (!steps_.due(step) && rclcpp::ok()) {
    const auto left = end - steady_clock::now();
    if (left.count() <= 0) break;
    spin(left);
  }
  StepCommand command;
  due_ = steps_.due(step);
  if (!due_) {
    command.run = Run::kPause;
    we_paused_ = true;
  }
  if (asked_ && start_) {
    const sim::BodyState body = *std::exchange(asked_, std::nullopt);
    command.place = link_of(body, truth_.centre_of_mass_L());
    truth_.begin(body);
  }
  if (!steps_.stamp()) return command;
  const sim::Wrench& wrench = steps_.move(step);
  if (command.place || !now_) return command;
  const sim::Quaternion& q_WB = truth_.truth().body.q_WB;
  command.wrench =
      link_wrench({q_WB * wrench.force_B, wrench.torque_B}, now_->q_GL, truth_.centre_of_mass_L());
  return command;
}

void DynamicsLoop::after_step(const LinkState& state) {
  if (!start_) {
    start_ = state;
    truth_.begin(body_of(state, truth_.centre_of_mass_L()));
  }
  now_ = state;
  const double step_s = std::chrono::duration<double>(step_).count();
  sim::Truth& truth = truth_.truth();
  truth_.move(state, step_s);
  truth.air.wind_W =
      wind_.step(step_s, -truth.body.p_W.z(),
                 (truth.body.v_B - truth.body.q_WB.conjugate() * truth.air.wind_W).norm());
  // Who waits for the truth must get it from a simulator that is too slow as well, or its time would run away for good.
  if (due_ && (!steps_.due(step_) || steps_.loses_time(step_))) publish();
}

std::optional<Run> DynamicsLoop::while_paused() {
  stands_ = !we_paused_;
  spin(kLook);
  if (we_paused_ && step_.count() > 0 && steps_.due(step_)) return Run::kResume;
  return std::nullopt;
}

void DynamicsLoop::receive(nanoseconds stamp, const sim::Wrench& wrench) {
  if (stands_) return steps_.skip(stamp);
  if (!alone_checked_) {
    alone_checked_ = true;
    const std::size_t count = topics_->node->count_publishers("sim/truth_state");
    if (count > 1)
      say_("found " + std::to_string(count) +
           " publishers of sim/truth_state, allowed one: start the other nodes with "
           "dynamics:=false");
  }
  const nanoseconds gap = steps_.add(stamp, wrench);
  if (gap > options_.max_gap) {
    constexpr int kInterval_ms = 5000;
    RCLCPP_WARN_THROTTLE(topics_->node->get_logger(), *topics_->node->get_clock(), kInterval_ms,
                         "%.3f s between two wrenches: moves the body by %.3f s",
                         std::chrono::duration<double>(gap).count(),
                         std::chrono::duration<double>(options_.max_gap).count());
  }
  // It stands for no time: the answer is the state as it is.
  if (start_ && step_.count() > 0 && !steps_.due(step_)) publish();
}

/// A position and velocities of zero mean the start.
const char* DynamicsLoop::ask(sim::BodyState body) {
  if (body.p_W.isZero() && body.v_B.isZero() && body.w_B.isZero() && start_) {
    LinkState at_rest = *start_;
    at_rest.v_G.setZero();
    at_rest.w_G.setZero();
    body = body_of(at_rest, truth_.centre_of_mass_L());
  }
  if (const char* const error = wrong(body)) return error;
  body.q_WB.normalize();
  asked_ = body;
  steps_.forget_lead();
  return nullptr;
}

void DynamicsLoop::publish() {
  publish_wind();
  auto state =
      to_ros<rosflight_msgs::msg::SimState>(messages::to_message(truth_.truth(), gravity_m_s2_));
  state.header.stamp = stamp_of(steps_.stamp()->count());
  state.header.frame_id = "NED";
  topics_->truth->publish(state);
}

/// As often as the truth while it changes; a wind that stands, each tenth time.
void DynamicsLoop::publish_wind() {
  constexpr int kEvery = 10;
  const sim::Vector3 wind_W = wind_.velocity_W();
  if (wind_W == published_wind_W_ && ++same_winds_ % kEvery != 0) return;
  published_wind_W_ = wind_W;
  auto wind = to_ros<geometry_msgs::msg::Vector3Stamped>(messages::wind_message(wind_W));
  wind.header.stamp = stamp_of(steps_.stamp()->count());
  wind.header.frame_id = "NED";
  topics_->wind->publish(wind);
}

}  // namespace rosflight_sim
