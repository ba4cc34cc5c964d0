// SPDX-License-Identifier: BSD-3-Clause
// The pass-through demonstration of the ROSflight 2.0 paper: attitude loops in a ROS node, closed
// at the rate of `attitude` over the serial link, forces and torques to the firmware's mixer.
//
//     passthrough SECONDS CSV [--ros-args -p mass_kg:=3.5 ...]
//
// Waits until the vehicle is armed and the pilot lets go, climbs, follows a triangle wave of roll
// for SECONDS and then sinks to the ground. The CSV has time, setpoint and measured roll [rad].
//
//     torque = J w^2 (e + integral of e / T) + 2 z w J (rate setpoint - rate)             (1)
//     thrust = m (g + k_p (h_set - h) - k_d climb) / (cos roll cos pitch)                   (2)
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "rosflight_demos/program.hpp"

namespace {

constexpr double kGravity_m_s2 = rosflight::base::kStandardGravity_m_s2;
constexpr double kClimb_s = 6.0;

/// Height and climb from pressure altitude and vertical acceleration: an observer with double pole.
class HeightObserver {
 public:
  void predict(double up_m_s2, double dt_s) {
    climb_m_s_ += up_m_s2 * dt_s;
    height_m_ += climb_m_s_ * dt_s;
  }
  void correct(double height_m, double dt_s) {
    constexpr double kPole_1_s = 1.5;
    const double error = height_m - height_m_;
    height_m_ += 2.0 * kPole_1_s * error * dt_s;
    climb_m_s_ += kPole_1_s * kPole_1_s * error * dt_s;
  }
  double height_m() const { return height_m_; }
  double climb_m_s() const { return climb_m_s_; }

 private:
  double height_m_{0.0};
  double climb_m_s_{0.0};
};

struct Euler {
  double roll, pitch, yaw;
};

Euler euler(const geometry_msgs::msg::Quaternion& q) {
  return {std::atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)),
          std::asin(std::clamp(2.0 * (q.w * q.y - q.z * q.x), -1.0, 1.0)),
          std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
}

/// Triangle wave of unit amplitude that starts at 0 and rises, and its slope.
struct Triangle {
  double value, slope_1_s;
};
Triangle triangle(double t_s, double period_s) {
  const double phase = std::fmod(t_s / period_s + 0.25, 1.0);
  const bool rising = phase < 0.5;
  return {rising ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase, (rising ? 4.0 : -4.0) / period_s};
}

class Passthrough final : public rclcpp::Node {
 public:
  explicit Passthrough(double duration_s) : Node("passthrough"), duration_s_{duration_s} {
    using rosflight_msgs::msg::Attitude;
    using rosflight_msgs::msg::Barometer;
    using rosflight_msgs::msg::Status;
    publisher_ = create_publisher<rosflight_msgs::msg::Command>("command", 1);
    subscriptions_ = {
        create_subscription<Attitude>("attitude", 10,
                                      [this](Attitude::ConstSharedPtr m) { control(*m); }),
        create_subscription<sensor_msgs::msg::Imu>(
            "imu/data", 10,
            [this](sensor_msgs::msg::Imu::ConstSharedPtr m) { accel_ = m->linear_acceleration; }),
        create_subscription<Barometer>("baro", 10,
                                       [this](Barometer::ConstSharedPtr m) { take_baro(*m); }),
        create_subscription<Status>("status", 10, [this](Status::ConstSharedPtr m) {
          ready_ = m->armed && (m->rc_override & 0x3F) == 0;
        })};
  }

  bool done() const { return done_; }
  void write(std::FILE* csv) const {
    std::fprintf(csv, "time_s,set_roll_rad,roll_rad\n");
    for (const Row& row : rows_) std::fprintf(csv, "%.6f,%.6f,%.6f\n", row[0], row[1], row[2]);
  }

 private:
  using Row = std::array<double, 3>;

  void take_baro(const rosflight_msgs::msg::Barometer& m) {
    const double t = rclcpp::Time(m.header.stamp).seconds();
    const auto altitude = static_cast<double>(m.altitude);
    if (flying_s_ == 0.0) ground_m_ = altitude;
    if (baro_s_ > 0.0 && t > baro_s_) height_.correct(altitude - ground_m_, t - baro_s_);
    baro_s_ = t;
  }

  void control(const rosflight_msgs::msg::Attitude& m) {
    const double t = rclcpp::Time(m.header.stamp).seconds();
    const double dt_s = std::clamp(t - last_s_, 0.0, 0.05);
    last_s_ = t;
    const Euler a = euler(m.attitude);
    const auto& q = m.attitude;
    // Third row of the rotation body to NED: the vertical part of the specific force, downwards.
    const double down = 2.0 * (q.x * q.z - q.w * q.y) * accel_.x +
                        2.0 * (q.y * q.z + q.w * q.x) * accel_.y +
                        (1.0 - 2.0 * (q.x * q.x + q.y * q.y)) * accel_.z;
    if (flying_s_ == 0.0) {
      yaw_ = a.yaw;
      if (ready_ || sent_ == 0) ++sent_;
      flying_s_ = ready_ && sent_ > kHeldPasses ? t : 0.0;
      send(0.0, {0.0, 0.0, 0.0});
      return;
    }
    height_.predict(-down - kGravity_m_s2, dt_s);
    const double flown_s = t - flying_s_;
    const double wave_s = flown_s - kClimb_s;
    const bool waving = wave_s >= 0.0 && wave_s < duration_s_;
    const Triangle wave = triangle(std::max(wave_s, 0.0), period_s_);
    const double set_roll = waving ? amplitude_rad_ * wave.value : 0.0;
    const double set_rate = waving ? amplitude_rad_ * wave.slope_1_s : 0.0;
    if (waving) rows_.push_back({wave_s, set_roll, a.roll});

    const double sinking = std::max(0.0, wave_s - duration_s_);
    const double set_height = std::min(height_set_m_, flown_s) - 0.6 * sinking;
    const auto torque = [&](std::size_t k, double inertia, double error, double rate_error) {
      integral_[k] = std::clamp(integral_[k] + error * dt_s, -0.2, 0.2);
      return inertia *
             (w_ * w_ * (error + integral_[k] / kIntegral_s) + 2.0 * kDamping * w_ * rate_error);
    };
    const double yaw_error = std::remainder(yaw_ - a.yaw, 2.0 * rosflight::base::kPi);
    const std::array<double, 3> torques{
        torque(0, inertia_xx_, set_roll - a.roll, set_rate - m.angular_velocity.x),
        torque(1, inertia_yy_, -a.pitch, -m.angular_velocity.y),
        torque(2, inertia_zz_, 0.1 * yaw_error, 0.3 * -m.angular_velocity.z)};
    const double lift =
        kGravity_m_s2 + 2.0 * (set_height - height_.height_m()) - 2.5 * height_.climb_m_s();
    const double thrust = mass_kg_ * std::clamp(lift, 2.0, 15.0) /
                          std::max(0.5, std::cos(a.roll) * std::cos(a.pitch));
    const bool down_again = sinking > 1.0 && height_.height_m() < 0.3;
    if (down_again || sinking > 20.0) done_ = true;
    send(done_ ? 0.0 : thrust, torques);
  }

  void send(double thrust_N, const std::array<double, 3>& torques_Nm) {
    rosflight_msgs::msg::Command command;
    command.header.stamp = now();
    command.mode = rosflight_msgs::msg::Command::MODE_PASS_THROUGH;
    command.u[2] = static_cast<float>(-thrust_N);
    for (std::size_t k = 0; k < 3; ++k) command.u[3 + k] = static_cast<float>(torques_Nm[k]);
    publisher_->publish(command);
  }

  static constexpr double kDamping = 0.8;
  static constexpr double kIntegral_s = 2.0;
  static constexpr int kHeldPasses = 200;  // commands at rest before the motors are asked for lift

  double duration_s_;
  double mass_kg_{declare_parameter("mass_kg", 3.5)};
  double inertia_xx_{declare_parameter("inertia_xx_kg_m2", 0.08)};
  double inertia_yy_{declare_parameter("inertia_yy_kg_m2", 0.08)};
  double inertia_zz_{declare_parameter("inertia_zz_kg_m2", 0.12)};
  double w_{declare_parameter("frequency_rad_s", 12.0)};
  double amplitude_rad_{declare_parameter("amplitude_rad", 0.2)};
  double period_s_{declare_parameter("period_s", 4.0)};
  double height_set_m_{declare_parameter("height_m", 5.0)};

  rclcpp::Publisher<rosflight_msgs::msg::Command>::SharedPtr publisher_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  HeightObserver height_;
  geometry_msgs::msg::Vector3 accel_;
  std::array<double, 3> integral_{};
  std::vector<Row> rows_;
  double ground_m_{0.0}, baro_s_{0.0}, last_s_{0.0}, flying_s_{0.0}, yaw_{0.0};
  int sent_{0};
  bool ready_{false}, done_{false};
};

}  // namespace

static int run(int argc, char** argv) {
  const std::vector<std::string> words = rclcpp::init_and_remove_ros_arguments(argc, argv);
  const double seconds = words.size() == 3 ? std::atof(words[1].c_str()) : 0.0;
  if (!(seconds > 0.0) || seconds > 600.0) {
    std::fprintf(stderr, "usage: passthrough SECONDS CSV, seconds up to 600\n");
    return 2;
  }
  const auto node = std::make_shared<Passthrough>(seconds);
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  const auto timeout =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds + 90.0);
  while (rclcpp::ok() && !node->done()) {
    executor.spin_once(std::chrono::milliseconds(100));
    if (std::chrono::steady_clock::now() > timeout) {
      std::fprintf(stderr, "passthrough: not armed, or never down again\n");
      return 1;
    }
  }
  std::FILE* csv = std::fopen(words[2].c_str(), "w");
  if (csv == nullptr) {
    std::fprintf(stderr, "passthrough: cannot write %s\n", words[2].c_str());
    return 2;
  }
  node->write(csv);
  std::fclose(csv);
  rclcpp::shutdown();
  return 0;
}

int main(int argc, char** argv) {
  return program("passthrough", [&] { return run(argc, argv); });
}
