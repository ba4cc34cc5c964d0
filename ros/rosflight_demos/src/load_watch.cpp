// SPDX-License-Identifier: BSD-3-Clause
// Offboard commands at 100 Hz while every stream of rosflight_io is received at a depth of 2000, and a
// count of what is missing by its stamps.
//
//     load_watch SECONDS START_US
//
// START_US is the start_us of ./rosflight sil: the IMU has a sample then, on the steady clock, and
// one every period after it. Prints `watching` when every stream has come, then one JSON object: for
// each topic the messages received; for those stamped with the autopilot's clock also the period in ms
// and how many samples are missing; pauses of the simulated vehicle, for which the machine had no time;
// and the error of the IMU's stamps against the sample times, known up to whole periods.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/output_raw.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>
#include <set>
#include <string>
#include <vector>

#include "rosflight_demos/program.hpp"

namespace {

constexpr std::size_t kDepth =
    2000;  // 5 s of the IMU: what a busy machine leaves unread is not lost on the way
constexpr double kCommandRate_Hz = 100.0;
constexpr double kImuPeriod_s = 0.0025;
/// `sil` moves its ticks after a delay of so much (flight/sil/pace.hpp): no sample was taken in it.
constexpr double kPause_s = 0.04;

class Watch final : public rclcpp::Node {
 public:
  Watch() : Node("load_watch") {
    listen<sensor_msgs::msg::Imu>("imu/data");
    listen<sensor_msgs::msg::Temperature>("imu/temperature");
    listen<sensor_msgs::msg::MagneticField>("magnetometer");
    listen<sensor_msgs::msg::Range>("range");
    listen<rosflight_msgs::msg::Attitude>("attitude");
    listen<rosflight_msgs::msg::Barometer>("baro");
    listen<rosflight_msgs::msg::Airspeed>("airspeed");
    listen<rosflight_msgs::msg::GNSS>("gnss");
    listen<rosflight_msgs::msg::BatteryStatus>("battery");
    listen<rosflight_msgs::msg::OutputRaw>("output_raw");
    listen<rosflight_msgs::msg::RCRaw>("rc_raw");
    listen<rosflight_msgs::msg::Status>("status");
    publisher_ = create_publisher<rosflight_msgs::msg::Command>("command", 1);
    const auto period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / kCommandRate_Hz));
    timer_ = create_wall_timer(period, [this] { send(); });
  }

  bool complete() const {
    return std::all_of(stamps_.begin(), stamps_.end(),
                       [](const auto& entry) { return entry.second.size() > 5; });
  }
  void forget() {
    for (auto& entry : stamps_) entry.second.clear();
    sent_ = 0;
  }
  void report(double start_s) const {
    std::printf("{\"commands\": %zu, \"topics\": {", sent_);
    const char* comma = "";
    for (const auto& [topic, stamps] : stamps_) {
      std::printf("%s\"%s\": {\"received\": %zu", comma, topic.c_str(), stamps.size());
      if (of_samples_.count(topic) != 0) {
        const double period_s = median_step_s(stamps);
        std::printf(", \"period_ms\": %.3f, \"missing\": %zu", 1e3 * period_s,
                    missing(stamps, period_s));
      }
      std::printf("}");
      comma = ", ";
    }
    std::printf("}, ");
    report_stamps(start_s);
    std::printf(", \"pauses\": %zu}\n", pauses(stamps_.at("imu/data")));
  }

 private:
  /// Steady time to ROS time by the present difference of the clocks.
  void report_stamps(double start_s) const {
    const auto seconds = [](auto t) { return std::chrono::duration<double>(t).count(); };
    const double start_ros_s =
        start_s + now().seconds() - seconds(std::chrono::steady_clock::now().time_since_epoch());
    double sum = 0.0, sum_of_squares = 0.0, most = 0.0;
    const auto& stamps = stamps_.at("imu/data");
    for (const double stamp : stamps) {
      const double error_s = std::remainder(stamp - start_ros_s, kImuPeriod_s);
      sum += error_s;
      sum_of_squares += error_s * error_s;
      most = std::max(most, std::abs(error_s));
    }
    const double count = static_cast<double>(std::max<std::size_t>(stamps.size(), 1));
    const double mean = sum / count;
    const double std = std::sqrt(std::max(0.0, sum_of_squares / count - mean * mean));
    std::printf("\"stamp_error_ms\": {\"mean\": %.4f, \"std\": %.4f, \"max\": %.4f}", 1e3 * mean,
                1e3 * std, 1e3 * most);
  }

  template <class Message>
  void listen(const std::string& topic) {
    auto& stamps = stamps_[topic];
    subscriptions_.push_back(
        create_subscription<Message>(topic, kDepth, [&stamps](typename Message::ConstSharedPtr m) {
          stamps.push_back(static_cast<double>(m->header.stamp.sec) +
                           1e-9 * m->header.stamp.nanosec);
        }));
  }

  void send() {
    rosflight_msgs::msg::Command command;
    command.mode = rosflight_msgs::msg::Command::MODE_ROLL_PITCH_YAWRATE_THROTTLE;
    publisher_->publish(command);
    ++sent_;
  }

  static double median_step_s(const std::vector<double>& stamps) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < stamps.size(); ++k) steps.push_back(stamps[k] - stamps[k - 1]);
    if (steps.empty()) return 0.0;
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    return steps[steps.size() / 2];
  }

  /// How many samples between first and last were never received, without those of pauses.
  static std::size_t missing(const std::vector<double>& stamps, double period_s) {
    double count = 0.0;
    for (std::size_t k = 1; k < stamps.size(); ++k) {
      const double apart_s = stamps[k] - stamps[k - 1];
      if (apart_s < kPause_s) count += std::round(apart_s / period_s) - 1.0;
    }
    return static_cast<std::size_t>(std::max(0.0, count));
  }

  static std::size_t pauses(const std::vector<double>& stamps) {
    std::size_t count = 0;
    for (std::size_t k = 1; k < stamps.size(); ++k)
      count += stamps[k] - stamps[k - 1] < kPause_s ? 0 : 1;
    return count;
  }

  /// Topics whose messages carry the time of a sample; the others carry that of their arrival.
  const std::set<std::string> of_samples_{"imu/data", "imu/temperature", "gnss"};
  std::map<std::string, std::vector<double>> stamps_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  rclcpp::Publisher<rosflight_msgs::msg::Command>::SharedPtr publisher_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::size_t sent_{0};
};

}  // namespace

static int run(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const std::vector<std::string> words = rclcpp::init_and_remove_ros_arguments(argc, argv);
  const double seconds = words.size() == 3 ? std::atof(words[1].c_str()) : 0.0;
  if (!(seconds > 0.0)) {
    std::fprintf(stderr, "usage: load_watch SECONDS START_US\n");
    return 2;
  }
  const auto watch = std::make_shared<Watch>();
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(watch);
  const auto spin_until = [&](auto done) {
    while (rclcpp::ok() && !done()) executor.spin_once(std::chrono::milliseconds(20));
  };
  const auto timeout = Clock::now() + std::chrono::seconds(30);
  spin_until([&] { return watch->complete() || Clock::now() > timeout; });
  if (!watch->complete()) {
    std::fprintf(stderr, "load_watch: not every stream of rosflight_io was received within 30 s\n");
    return 1;
  }
  watch->forget();
  std::puts("watching");
  std::fflush(stdout);
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(seconds));
  spin_until([&] { return Clock::now() > end; });
  watch->report(1e-6 * std::atof(words[2].c_str()));
  rclcpp::shutdown();
  return 0;
}

int main(int argc, char** argv) {
  return program("load_watch", [&] { return run(argc, argv); });
}
