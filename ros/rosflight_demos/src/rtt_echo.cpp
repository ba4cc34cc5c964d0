// SPDX-License-Identifier: BSD-3-Clause
// The far end of a round trip without the link: what rosflight_io and sil_echo do together, on bare DDS. For every Command an
// OutputRaw with its number, messages of the same size over the same middleware.
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/output_raw.hpp>

#include "rosflight_demos/program.hpp"

namespace {

using rosflight_msgs::msg::Command;
using rosflight_msgs::msg::OutputRaw;

constexpr std::size_t kAsked = 9;
constexpr std::size_t kAnswered = 13;

class Echo final : public rclcpp::Node {
 public:
  Echo() : Node("rtt_echo") {
    publisher_ = create_publisher<OutputRaw>("output_raw", 1);
    subscription_ = create_subscription<Command>("command", 1, [this](Command::ConstSharedPtr m) {
      OutputRaw answer;
      answer.header.stamp = now();
      answer.values[kAnswered] = m->u[kAsked];
      publisher_->publish(answer);
    });
  }

 private:
  rclcpp::Publisher<OutputRaw>::SharedPtr publisher_;
  rclcpp::Subscription<Command>::SharedPtr subscription_;
};

}  // namespace

int main(int argc, char** argv) {
  return program("rtt_echo", [&] {
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<Echo>());
    rclcpp::shutdown();
    return 0;
  });
}
