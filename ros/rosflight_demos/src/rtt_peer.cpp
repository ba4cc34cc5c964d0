// SPDX-License-Identifier: BSD-3-Clause
// Round trip of offboard commands through ROS: publisher, rosflight_io, link, firmware, and back to
// a subscriber. The firmware must be sil_echo, which returns u[9] in values[13] of output_raw.
//
//     rtt_peer RATE_HZ COUNT CSV    RATE_HZ 0: each command as soon as the last is back
//
// Prints one JSON object; the CSV has one line "number,round_trip_us" per command that came back.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/output_raw.hpp>
#include <string>
#include <utility>
#include <vector>

#include "rosflight_demos/program.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using rosflight_msgs::msg::Command;
using rosflight_msgs::msg::OutputRaw;

constexpr std::size_t kAsked = 9;
constexpr std::size_t kAnswered = 13;

class Peer final : public rclcpp::Node {
 public:
  Peer(double rate_hz, std::size_t count)
      : Node("rtt_peer"), rate_hz_{rate_hz}, count_{count}, sent_(count + 1), us_(count, -1.0) {
    publisher_ = create_publisher<Command>("command", 1);
    subscription_ = create_subscription<OutputRaw>(
        "output_raw", 100, [this](OutputRaw::ConstSharedPtr m) { received(*m); });
    start_ = create_wall_timer(std::chrono::milliseconds(100), [this] { start_when_connected(); });
    watch_ = create_wall_timer(std::chrono::milliseconds(500), [this] { watch(); });
  }

  bool done() const { return done_; }
  bool started() const { return last_ > 0; }
  const std::vector<double>& round_trips_us() const { return us_; }
  void report() const {
    const double seconds = std::chrono::duration<double>(ended_ - began_).count();
    std::printf("{\"sent\": %zu, \"lost\": %zu, \"achieved_Hz\": %.1f}\n", last_, last_ - answers_,
                seconds > 0.0 ? static_cast<double>(answers_) / seconds : 0.0);
  }

 private:
  void start_when_connected() {
    if (publisher_->get_subscription_count() == 0 || count_publishers("output_raw") == 0) return;
    start_->cancel();
    began_ = Clock::now();
    if (rate_hz_ > 0.0) {
      pace_ = create_wall_timer(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate_hz_)),
                                [this] { send(); });
    } else {
      send();
    }
  }

  void send() {
    if (last_ == count_) return;
    Command command;
    command.mode = Command::MODE_PASS_THROUGH;
    command.u[kAsked] = static_cast<float>(++last_);
    sent_[last_] = Clock::now();
    publisher_->publish(command);
  }

  void received(const OutputRaw& m) {
    const auto number = static_cast<std::size_t>(m.values[kAnswered]);
    if (number == 0 || number > last_ || us_[number - 1] >= 0.0) return;
    ended_ = Clock::now();
    us_[number - 1] = std::chrono::duration<double, std::micro>(ended_ - sent_[number]).count();
    if (++answers_ == count_) {
      done_ = true;
    } else if (rate_hz_ <= 0.0) {
      send();
    }
  }

  /// A lost command must not stop the others: without news for half a second goes on, or ends.
  void watch() {
    if (last_ == 0 || std::exchange(seen_, answers_) != answers_) return;
    if (last_ == count_) {
      done_ = true;
    } else if (rate_hz_ <= 0.0) {
      send();
    }
  }

  double rate_hz_;
  std::size_t count_;
  std::vector<Clock::time_point> sent_;
  std::vector<double> us_;  ///< By number - 1; negative: not back.
  std::size_t last_{0};
  std::size_t answers_{0};
  std::size_t seen_{0};
  bool done_{false};
  Clock::time_point began_, ended_;
  rclcpp::Publisher<Command>::SharedPtr publisher_;
  rclcpp::Subscription<OutputRaw>::SharedPtr subscription_;
  rclcpp::TimerBase::SharedPtr start_, watch_, pace_;
};

bool write_csv(const std::string& path, const std::vector<double>& us) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  std::fprintf(file, "number,round_trip_us\n");
  for (std::size_t k = 0; k < us.size(); ++k) {
    if (us[k] >= 0.0) std::fprintf(file, "%zu,%.3f\n", k + 1, us[k]);
  }
  return std::fclose(file) == 0;
}

}  // namespace

static int run(int argc, char** argv) {
  const std::vector<std::string> words = rclcpp::init_and_remove_ros_arguments(argc, argv);
  const double rate_hz = words.size() == 4 ? std::atof(words[1].c_str()) : -1.0;
  const long count = words.size() == 4 ? std::atol(words[2].c_str()) : 0;
  if (rate_hz < 0.0 || count < 1 || count > 10'000'000) {
    std::fprintf(stderr, "usage: rtt_peer RATE_HZ COUNT CSV\n");
    return 2;
  }
  const auto peer = std::make_shared<Peer>(rate_hz, static_cast<std::size_t>(count));
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(peer);
  const auto timeout = Clock::now() + std::chrono::seconds(30);
  while (rclcpp::ok() && !peer->done()) {
    executor.spin_once(std::chrono::milliseconds(100));
    if (!peer->started() && Clock::now() > timeout) {
      std::fprintf(stderr, "rtt_peer: no rosflight_io with a firmware behind it within 30 s\n");
      return 1;
    }
  }
  peer->report();
  rclcpp::shutdown();
  if (!write_csv(words[3], peer->round_trips_us())) {
    std::fprintf(stderr, "rtt_peer: cannot write %s\n", words[3].c_str());
    return 2;
  }
  return 0;
}

int main(int argc, char** argv) {
  return program("rtt_peer", [&] { return run(argc, argv); });
}
