// SPDX-License-Identifier: BSD-3-Clause
#include "time_source.hpp"

#include "rcl_call.hpp"

namespace rclcpp::detail {

TimeSource::TimeSource(node_interfaces::NodeBaseInterface::SharedPtr base, Clock::SharedPtr clock,
                       NodeParameters& parameters, const NodeOptions& options)
    : base_(std::move(base)),
      clock_(std::move(clock)),
      parameters_(parameters),
      qos_(options.clock_qos()),
      topics_(options.use_intra_process_comms() ? base_->get_context()->intra_process_topics()
                                                : nullptr),
      own_thread_(options.use_clock_thread()) {
  constexpr auto kName = "use_sim_time";
  if (!parameters_.has(kName)) {
    NodeParameters::Descriptor descriptor;
    descriptor.description = "Time comes from the topic /clock.";
    parameters_.declare(kName, ParameterValue(false), PARAMETER_BOOL, descriptor, false);
  }
  parameters_.on_change([this](const Parameter& changed) {
    if (changed.get_name() == kName && changed.get_type() == PARAMETER_BOOL) {
      use_simulated_time(changed.as_bool());
    }
  });
  use_simulated_time(parameters_.get(kName).as_bool());
}

TimeSource::~TimeSource() {
  parameters_.on_change(nullptr);
  stop_listening();
}

void TimeSource::use_simulated_time(bool on) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (on == on_) return;
  on_ = on;
  if (!on) stop_listening();
  {
    const std::lock_guard<std::recursive_mutex> clock_lock(clock_->get_clock_mutex());
    auto* const handle = clock_->get_clock_handle();
    check(on ? rcl_enable_ros_time_override(handle) : rcl_disable_ros_time_override(handle),
          "switch simulated time");
  }
  if (on) start_listening();
}

void TimeSource::start_listening() {
  // A group and thread of its own: time goes on while a callback of the node sleeps on it.
  group_ = base_->create_callback_group(CallbackGroupType::MutuallyExclusive, !own_thread_);
  subscription_ = std::make_shared<Subscription<rosgraph_msgs::msg::Clock>>(
      base_->get_shared_rcl_node_handle(), "/clock", qos_,
      [clock = clock_](const rosgraph_msgs::msg::Clock& message) {
        const std::lock_guard<std::recursive_mutex> lock(clock->get_clock_mutex());
        check(
            rcl_set_ros_time_override(clock->get_clock_handle(), Time(message.clock).nanoseconds()),
            "set simulated time");
      },
      false, topics_);
  group_->add(subscription_);
  if (!own_thread_) return;
  ExecutorOptions options;
  options.context = base_->get_context();
  executor_ = std::make_unique<executors::SingleThreadedExecutor>(options);
  executor_->add_callback_group(group_, base_);
  // Spinning from here on, so that a cancel before the thread runs is not lost.
  thread_ = std::thread([this] { executor_->spin(); });
}

void TimeSource::stop_listening() {
  if (thread_.joinable()) {
    while (!executor_->is_spinning() && base_->get_context()->is_valid()) {
      std::this_thread::yield();
    }
    executor_->cancel();
    thread_.join();
  }
  executor_.reset();
  subscription_.reset();
  group_.reset();
}

}  // namespace rclcpp::detail
