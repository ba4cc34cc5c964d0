// SPDX-License-Identifier: BSD-3-Clause
// A component with a thread of its own in `compose`. One that is called `throws` throws at the first call of its timer.
#include <chrono>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string_view>

#include "rosflight_common/component.hpp"

namespace {

class ThrowsAtOnce final : public rclcpp::Node {
 public:
  explicit ThrowsAtOnce(const rclcpp::NodeOptions& options) : Node("throws_at_once", options) {
    if (std::string_view(get_name()) != "throws") return;
    timer_ = create_wall_timer(std::chrono::nanoseconds(1),
                               [] { throw std::runtime_error("thrown by a timer"); });
  }

 private:
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace

ROSFLIGHT_WAITS_IN_CALLBACKS
extern "C" void rosflight_make_node(const rclcpp::NodeOptions& options,
                                    std::shared_ptr<rclcpp::Node>& node) {
  node = std::make_shared<ThrowsAtOnce>(options);
}
