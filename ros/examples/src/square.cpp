// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <stdexcept>
#include <string>
#include <vector>

// Arms, lets go of the pilot's override, takes off, flies a square, lands and disarms.
//
// Angles (roll, pitch), a yaw rate and a throttle go out on `command`; the position comes from the
// simulator's `sim/truth_state`: north, east, down [m], attitude body -> NED, velocity in body axes
// (forward, right, down). scripts/square.py does the same in Python.

using rosflight_msgs::msg::Command;
using rosflight_msgs::msg::SimState;
using rosflight_msgs::msg::Status;
using std_srvs::srv::Trigger;

namespace {

struct Vec {
  double x{}, y{}, z{};
};

Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// v rotated by the attitude: body -> NED.
Vec rotated(const geometry_msgs::msg::Quaternion& q, const Vec& v) {
  const Vec t{2.0 * (q.y * v.z - q.z * v.y), 2.0 * (q.z * v.x - q.x * v.z),
              2.0 * (q.x * v.y - q.y * v.x)};
  return {v.x + q.w * t.x + q.y * t.z - q.z * t.y, v.y + q.w * t.y + q.z * t.x - q.x * t.z,
          v.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

double clipped(double x, double most) {
  return std::clamp(x, -most, most);
}

constexpr double kGravity_m_s2 = 9.81;
constexpr double kPeriod_s = 0.01;
constexpr double kTimeout_s = 60.0;  // of node time, for each step of the flight

// A parameter; `side_m:=5` is an integer for ROS, and good for a number all the same.
double number(rclcpp::Node& node, const std::string& name, double value) {
  rcl_interfaces::msg::ParameterDescriptor any_type;
  any_type.dynamic_typing = true;
  const rclcpp::ParameterValue given =
      node.declare_parameter(name, rclcpp::ParameterValue(value), any_type);
  if (given.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER)
    return static_cast<double>(given.get<std::int64_t>());
  if (given.get_type() != rclcpp::ParameterType::PARAMETER_DOUBLE)
    throw std::invalid_argument("parameter " + name + ": found '" + rclcpp::to_string(given) +
                                "', allowed a number");
  return given.get<double>();
}

class Square : public rclcpp::Node {
 public:
  Square() : Node("square") {
    const double side_m = number(*this, "side_m", 3.0);
    const double height_m = number(*this, "height_m", 2.0);
    corners_ = {{0, 0, -height_m},
                {side_m, 0, -height_m},
                {side_m, side_m, -height_m},
                {0, side_m, -height_m},
                {0, 0, -height_m}};
    command_ = create_publisher<Command>("command", 1);
    truth_ = create_subscription<SimState>("sim/truth_state", 1,
                                           [this](SimState::ConstSharedPtr m) { state_ = m; });
    status_sub_ =
        create_subscription<Status>("status", 1, [this](Status::ConstSharedPtr m) { status_ = m; });
    arm_ = create_client<Trigger>("toggle_arm");
    override_ = create_client<Trigger>("toggle_override");
    timer_ = rclcpp::create_timer(
        this, get_clock(), rclcpp::Duration(std::chrono::milliseconds(10)), [this] { step(); });
    begin(Phase::kWait, "waiting for the simulator and for an autopilot without errors");
  }

  int exit_code() const { return exit_code_; }

 private:
  enum class Phase { kWait, kArm, kRelease, kFly, kLand, kTakeBack, kDisarm };

  void begin(Phase phase, const std::string& text) {
    phase_ = phase;
    since_.reset();  // its time begins with its first step: simulated time may come later
    RCLCPP_INFO(get_logger(), "%s", text.c_str());
  }

  void step() {
    if (!since_) since_ = now();
    if ((now() - *since_).seconds() > kTimeout_s) return end(1, "gave up: nothing moves on");
    if (!state_ || !status_) return;
    const bool airborne = phase_ == Phase::kFly || phase_ == Phase::kLand;
    if (airborne && !status_->armed) return end(1, "disarmed in flight");
    switch (phase_) {
      case Phase::kWait:
        if (status_->error_code == 0 && !status_->armed) begin(Phase::kArm, "arming");
        break;
      case Phase::kArm:
        if (toggled(*arm_, status_->armed, true)) begin(Phase::kRelease, "releasing the override");
        break;
      case Phase::kRelease:
        publish(rest());  // the computer's setpoints must flow before they are let through
        if (toggled(*override_, pilot_holds(), false)) begin(Phase::kFly, "taking off");
        break;
      case Phase::kFly:
        fly_to(corners_[corner_]);
        if (reached(corners_[corner_])) next_corner();
        break;
      case Phase::kLand:
        target_.z += 0.5 * kPeriod_s;  // down, slowly, into the ground
        fly_to(target_);
        if (target_.z - state_->pose.position.z > 0.7)
          begin(Phase::kTakeBack, "landed, giving back");
        break;
      case Phase::kTakeBack:
        publish(rest());
        if (toggled(*override_, pilot_holds(), true)) begin(Phase::kDisarm, "disarming");
        break;
      case Phase::kDisarm:
        if (toggled(*arm_, status_->armed, false)) end(0, "done");
        break;
    }
  }

  void end(int code, const char* text) {
    exit_code_ = code;
    RCLCPP_INFO(get_logger(), "%s", text);
    timer_->cancel();
    rclcpp::shutdown();
  }

  bool pilot_holds() const {
    return (status_->rc_override & (Status::OVERRIDE_ATT_SWITCH | Status::OVERRIDE_THR_SWITCH)) !=
           0;
  }

  // The service flips a switch of the pilot, so it is asked again only if it has answered and the autopilot has not
  // followed a second later, by the time of its own status.
  bool toggled(rclcpp::Client<Trigger>& client, bool is, bool wanted) {
    if (is == wanted) return true;
    const rclcpp::Time status_at(status_->header.stamp, answered_.get_clock_type());
    if (!asked_ && client.service_is_ready() && (status_at - answered_).seconds() > 1.0) {
      asked_ = true;
      client.async_send_request(std::make_shared<Trigger::Request>(),
                                [this](rclcpp::Client<Trigger>::SharedFuture) {
                                  asked_ = false;
                                  answered_ = now();
                                });
    }
    return false;
  }

  bool reached(const Vec& place) const {
    const Vec d = place - position();
    return std::hypot(d.x, d.y, d.z) < 0.25;
  }

  void next_corner() {
    if (++corner_ < corners_.size()) {
      return begin(Phase::kFly, "corner " + std::to_string(corner_) + " of 4");
    }
    target_ = corners_.back();
    begin(Phase::kLand, "landing");
  }

  Vec position() const {
    const auto& p = state_->pose.position;
    return {p.x, p.y, p.z};
  }

  // Position error -> velocity -> acceleration -> angles and throttle.
  void fly_to(const Vec& place) {
    const auto& q = state_->pose.orientation;
    const auto& v_body = state_->twist.linear;
    const Vec v = rotated(q, {v_body.x, v_body.y, v_body.z});
    const Vec d = place - position();
    const Vec a{2.0 * (clipped(0.9 * d.x, 2.0) - v.x), 2.0 * (clipped(0.9 * d.y, 2.0) - v.y),
                2.5 * (clipped(1.0 * d.z, 1.0) - v.z)};
    hover_ = std::clamp(hover_ - 0.04 * a.z * kPeriod_s, 0.1, 0.9);
    const double yaw =
        std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z));
    const double forward = a.x * std::cos(yaw) + a.y * std::sin(yaw);
    const double right = a.y * std::cos(yaw) - a.x * std::sin(yaw);
    publish({clipped(right / kGravity_m_s2, 0.35), clipped(-forward / kGravity_m_s2, 0.35),
             clipped(-yaw, 0.5), std::clamp(hover_ * (1.0 - a.z / kGravity_m_s2), 0.05, 0.95)});
  }

  // Roll, pitch [rad], yaw rate [rad/s], throttle 0..1.
  using SetPoint = std::array<double, 4>;
  static SetPoint rest() { return {0.0, 0.0, 0.0, 0.0}; }

  void publish(const SetPoint& set_point) {
    Command command;
    command.header.stamp = now();
    command.mode = Command::MODE_ROLL_PITCH_YAWRATE_THROTTLE;
    command.u[3] = static_cast<float>(set_point[0]);
    command.u[4] = static_cast<float>(set_point[1]);
    command.u[5] = static_cast<float>(set_point[2]);
    command.u[2] = static_cast<float>(set_point[3]);
    command_->publish(command);
  }

  std::vector<Vec> corners_;
  std::size_t corner_{0};
  Vec target_;
  double hover_{0.5};  // throttle that carries the vehicle, learnt on the way
  Phase phase_{Phase::kWait};
  std::optional<rclcpp::Time> since_;
  bool asked_{false};  // and not answered yet
  rclcpp::Time answered_{now()};
  int exit_code_{1};
  SimState::ConstSharedPtr state_;
  Status::ConstSharedPtr status_;
  rclcpp::Publisher<Command>::SharedPtr command_;
  rclcpp::Subscription<SimState>::SharedPtr truth_;
  rclcpp::Subscription<Status>::SharedPtr status_sub_;
  rclcpp::Client<Trigger>::SharedPtr arm_, override_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  try {
    const auto node = std::make_shared<Square>();
    rclcpp::spin(node);
    rclcpp::shutdown();
    return node->exit_code();
  } catch (const std::invalid_argument& why) {
    std::fprintf(stderr, "square: %s\n", why.what());
    rclcpp::shutdown();
    return 2;
  }
}
