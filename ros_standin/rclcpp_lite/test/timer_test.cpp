// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <std_msgs/msg/int64.hpp>
#include <thread>
#include <vector>

namespace {

using std_msgs::msg::Int64;
using namespace std::chrono_literals;  // NOLINT: what nodes do

/// Made before the executor, which needs it.
struct Started {
  Started() { rclcpp::init(0, nullptr, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None); }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;
  ~Started() { rclcpp::shutdown(); }
};

class WithRos : public testing::Test {
 protected:
  /// Spins until the condition holds; a test that fails ends after 30 s.
  template <typename Condition>
  bool spin_until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 30s;
    while (!condition() && std::chrono::steady_clock::now() < end) executor_.spin_once(10ms);
    return condition();
  }
  Started started_;
  rclcpp::executors::SingleThreadedExecutor executor_;
};

using Timer = WithRos;

TEST_F(Timer, IsCancelledAndStartedAgain) {
  const auto node = std::make_shared<rclcpp::Node>("timed");
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  int calls = 0;
  rclcpp::TimerBase::SharedPtr timer;
  timer = node->create_wall_timer(1ms, [&] {
    if (++calls == 3) timer->cancel();
  });
  const auto clock = node->create_wall_timer(5ms, [] {});
  const auto spin = [&] {
    for (int i = 0; i < 20; ++i) executor.spin_once(10ms);
  };
  spin();
  EXPECT_EQ(calls, 3);
  EXPECT_TRUE(timer->is_canceled());
  EXPECT_EQ(timer->time_until_trigger(), std::chrono::nanoseconds::max());
  timer->reset();
  EXPECT_FALSE(timer->is_canceled());
  spin();
  EXPECT_GT(calls, 3);
}

TEST_F(Timer, GetsItselfIfItsCallbackAsks) {
  const auto node = std::make_shared<rclcpp::Node>("timed");
  int calls = 0;
  const auto timer = node->create_wall_timer(1ms, [&](rclcpp::TimerBase& self) {
    ++calls;
    self.cancel();
  });
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  for (int i = 0; i < 10; ++i) executor.spin_once(5ms);
  EXPECT_EQ(calls, 1);
}

TEST_F(Timer, SkipsPeriodsThatWereMissed) {
  const auto node = std::make_shared<rclcpp::Node>("timed");
  int calls = 0;
  const auto timer = node->create_wall_timer(10ms, [&] { ++calls; });
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  std::this_thread::sleep_for(100ms);
  executor.spin_some();
  EXPECT_EQ(calls, 1);
}

TEST_F(Timer, PeriodCannotBeNegative) {
  rclcpp::Node node("timed");
  EXPECT_THROW(node.create_wall_timer(-1ms, [] {}), std::invalid_argument);
}

TEST_F(WithRos, SimulatedTimeNeedsNoThreadOfItsOwn) {
  const auto options =
      rclcpp::NodeOptions().use_clock_thread(false).append_parameter_override("use_sim_time", true);
  const auto node = std::make_shared<rclcpp::Node>("threadless", options);
  const auto clock = node->create_publisher<rosgraph_msgs::msg::Clock>(
      "/clock", rclcpp::QoS(rclcpp::KeepLast(1)).best_effort());
  executor_.add_node(node);
  EXPECT_TRUE(node->get_clock()->ros_time_is_active());
  EXPECT_EQ(node->now().nanoseconds(), 0);
  rosgraph_msgs::msg::Clock five;
  five.clock.sec = 5;
  EXPECT_TRUE(spin_until([&] {
    clock->publish(five);
    return node->now() == rclcpp::Time(5, 0, RCL_ROS_TIME);
  }));
}

TEST_F(WithRos, DepthOfOneKeepsTheNewest) {
  const auto node = std::make_shared<rclcpp::Node>("slow");
  const auto newest = rclcpp::QoS(rclcpp::KeepLast(1)).reliable();
  std::vector<std::int64_t> received;
  const auto subscription = node->create_subscription<Int64>(
      "numbers", newest, [&](Int64::ConstSharedPtr message) { received.push_back(message->data); });
  const auto publisher = node->create_publisher<Int64>("numbers", newest);
  executor_.add_node(node);
  ASSERT_TRUE(spin_until([&] { return publisher->get_subscription_count() == 1; }));
  for (std::int64_t i = 1; i <= 5; ++i) {
    Int64 message;
    message.data = i;
    publisher->publish(message);
    ASSERT_TRUE(publisher->wait_for_all_acked(10s));
  }
  EXPECT_TRUE(spin_until([&] { return !received.empty(); }));
  EXPECT_EQ(received, std::vector<std::int64_t>{5});
}

TEST_F(WithRos, SpinAllGoesOnWhileThereIsWork) {
  const auto node = std::make_shared<rclcpp::Node>("busy");
  const auto publisher = node->create_publisher<Int64>("chain", 10);
  int received = 0;
  const auto subscription = node->create_subscription<Int64>("chain", 10, [&](const Int64&) {
    if (++received < 5) publisher->publish(Int64());
  });
  executor_.add_node(node);
  ASSERT_TRUE(spin_until([&] { return publisher->get_subscription_count() == 1; }));
  publisher->publish(Int64());
  EXPECT_TRUE(spin_until([&] {
    executor_.spin_all(1s);
    return received == 5;
  }));
  EXPECT_THROW(executor_.spin_all(-1ns), std::invalid_argument);
}

TEST_F(WithRos, CancelFromAnotherThreadEndsTheSpin) {
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(), 3);
  const auto node = std::make_shared<rclcpp::Node>("ended");
  executor.add_node(node);
  std::thread other([&] {
    while (!executor.is_spinning()) std::this_thread::sleep_for(1ms);
    EXPECT_THROW(executor.spin_once(0ns), std::runtime_error);  // one spin at a time
    executor.cancel();
  });
  executor.spin();
  other.join();
  EXPECT_FALSE(executor.is_spinning());
}

TEST_F(WithRos, NodesArgumentsNameAndRemapIt) {
  const auto options = rclcpp::NodeOptions().arguments(
      {"--ros-args", "-r", "__node:=another", "-r", "here:=there", "-p", "gain:=2.5"});
  rclcpp::Node node("one", "space", options);
  EXPECT_STREQ(node.get_fully_qualified_name(), "/space/another");
  EXPECT_STREQ(node.create_publisher<Int64>("here", 1)->get_topic_name(), "/space/there");
  EXPECT_STREQ(node.create_publisher<Int64>("~/own", 1)->get_topic_name(), "/space/another/own");
  EXPECT_DOUBLE_EQ(node.declare_parameter("gain", 1.0), 2.5);
  EXPECT_THROW(rclcpp::Node("bad", rclcpp::NodeOptions().arguments({"--ros-args", "--nonsense"})),
               rclcpp::exceptions::UnknownROSArgsError);
}

}  // namespace
