// SPDX-License-Identifier: BSD-3-Clause
// Messages that stay in the process, as rclcpp has them: between nodes that both ask for it, and to all others as ever.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int64.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

namespace {

using std_msgs::msg::Int64;
using namespace std::chrono_literals;  // NOLINT: what nodes do

Int64 number(std::int64_t value) {
  Int64 message;
  message.data = value;
  return message;
}

class IntraProcess : public testing::Test {
 protected:
  IntraProcess() {
    rclcpp::init(0, nullptr, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None);
    within_ = std::make_shared<rclcpp::Node>("within", asking(true));
    outside_ = std::make_shared<rclcpp::Node>("outside", asking(false));
    executor_ = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
    executor_->add_node(within_);
    executor_->add_node(outside_);
  }
  ~IntraProcess() override {
    executor_.reset();
    rclcpp::shutdown();
  }

  static rclcpp::NodeOptions asking(bool intra_process) {
    return rclcpp::NodeOptions().use_intra_process_comms(intra_process);
  }

  /// A test that fails ends after 30 s.
  bool spin_until(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + 30s;
    while (!condition() && std::chrono::steady_clock::now() < end) executor_->spin_once(10ms);
    return condition();
  }

  rclcpp::Node::SharedPtr within_, outside_;
  std::unique_ptr<rclcpp::executors::SingleThreadedExecutor> executor_;
};

TEST_F(IntraProcess, AMessageIsPassedOnAsItIs) {
  std::vector<const Int64*> got;
  bool marked = false;
  const auto first = within_->create_subscription<Int64>(
      "topic", 10, [&](Int64::ConstSharedPtr message, const rclcpp::MessageInfo& info) {
        got.push_back(message.get());
        marked = info.get_rmw_message_info().from_intra_process;
      });
  const auto second = within_->create_subscription<Int64>(
      "topic", 10, [&](const Int64& message) { got.push_back(&message); });
  const auto publisher = within_->create_publisher<Int64>("topic", 10);
  EXPECT_EQ(publisher->get_intra_process_subscription_count(), 2U);
  auto message = std::make_unique<Int64>(number(5));
  const std::vector<const Int64*> sent(2, message.get());
  publisher->publish(std::move(message));
  ASSERT_TRUE(spin_until([&] { return got.size() == 2; }));
  EXPECT_EQ(got, sent);
  EXPECT_TRUE(marked);
}

TEST_F(IntraProcess, WhoMayChangeAMessageGetsACopy) {
  std::int64_t seen = 0;
  int changed = 0;
  const auto changes = within_->create_subscription<Int64>("topic", 10, [&](Int64::UniquePtr mine) {
    mine->data = -1;
    ++changed;
  });
  const auto changes_too =
      within_->create_subscription<Int64>("topic", 10, [&](Int64::SharedPtr mine) {
        mine->data = -2;
        ++changed;
      });
  const auto reads = within_->create_subscription<Int64>(
      "topic", 10, [&](Int64::ConstSharedPtr message) { seen = message->data; });
  within_->create_publisher<Int64>("topic", 10)->publish(number(7));
  ASSERT_TRUE(spin_until([&] { return changed == 2 && seen != 0; }));
  EXPECT_EQ(seen, 7);
}

TEST_F(IntraProcess, OthersGetItByTheMiddlewareAndNobodyGetsItTwice) {
  constexpr std::int64_t kMessages = 50;
  std::vector<std::int64_t> by_pointer, by_middleware, as_bytes, to_both;
  const auto pointer = within_->create_subscription<Int64>(
      "topic", 100, [&](const Int64& message) { by_pointer.push_back(message.data); });
  const auto middleware = outside_->create_subscription<Int64>(
      "topic", 100, [&](const Int64& message) { by_middleware.push_back(message.data); });
  const auto bytes = within_->create_generic_subscription(
      "topic", "std_msgs/msg/Int64", 100,
      [&](std::shared_ptr<const rclcpp::SerializedMessage>) { as_bytes.push_back(0); });
  const auto publisher = within_->create_publisher<Int64>("topic", 100);
  const auto stranger = outside_->create_publisher<Int64>("topic", 100);
  ASSERT_TRUE(spin_until([&] {
    return publisher->get_subscription_count() == 3 && stranger->get_subscription_count() == 3;
  }));
  std::vector<std::int64_t> expected;
  for (std::int64_t i = 0; i < kMessages; ++i) {
    publisher->publish(number(i));
    expected.push_back(i);
  }
  ASSERT_TRUE(spin_until([&] {
    return by_middleware.size() == kMessages && as_bytes.size() == kMessages &&
           by_pointer.size() >= kMessages;
  }));
  stranger->publish(number(kMessages));  // what came twice would be before it
  expected.push_back(kMessages);
  ASSERT_TRUE(spin_until([&] { return by_pointer.back() == kMessages; }));
  EXPECT_EQ(by_pointer, expected);
}

/// The middleware numbers what it sends.
TEST_F(IntraProcess, WhatNobodyReadsIsNotSent) {
  const auto publisher = within_->create_publisher<Int64>("topic", 10);
  for (int i = 0; i < 5; ++i) publisher->publish(number(i));
  int got = 0;
  const auto pointer =
      within_->create_subscription<Int64>("topic", 10, [&](const Int64&) { ++got; });
  for (int i = 0; i < 5; ++i) publisher->publish(number(i));
  ASSERT_TRUE(spin_until([&] { return got == 5; }));
  std::uint64_t sent = 0;
  const auto middleware = outside_->create_subscription<Int64>(
      "topic", 10, [&](const Int64&, const rclcpp::MessageInfo& info) {
        sent = info.get_rmw_message_info().publication_sequence_number;
      });
  ASSERT_TRUE(spin_until([&] { return publisher->get_subscription_count() == 2; }));
  publisher->publish(number(0));
  ASSERT_TRUE(spin_until([&] { return sent != 0; }));
  EXPECT_EQ(sent, 1U);
}

TEST_F(IntraProcess, ThereAreNoMoreThanTheDepthAndTheOldestGo) {
  std::vector<std::int64_t> got;
  const auto subscription = within_->create_subscription<Int64>(
      "topic", 3, [&](const Int64& message) { got.push_back(message.data); });
  const auto publisher = within_->create_publisher<Int64>("topic", 10);
  for (std::int64_t i = 0; i < 8; ++i) publisher->publish(number(i));
  ASSERT_TRUE(spin_until([&] { return !got.empty() && got.back() == 7; }));
  EXPECT_EQ(got, (std::vector<std::int64_t>{5, 6, 7}));
}

TEST_F(IntraProcess, WhatOneDoesNotPromiseTheOtherDoesNotGet) {
  const auto subscription =
      within_->create_subscription<Int64>("topic", rclcpp::QoS(5).reliable(), [](const Int64&) {});
  const auto unreliable = within_->create_publisher<Int64>("topic", rclcpp::QoS(5).best_effort());
  const auto reliable = within_->create_publisher<Int64>("topic", rclcpp::QoS(5).reliable());
  EXPECT_EQ(unreliable->get_intra_process_subscription_count(), 0U);
  EXPECT_EQ(reliable->get_intra_process_subscription_count(), 1U);
}

TEST_F(IntraProcess, WhatRclcppRefusesIsRefused) {
  const auto ignore = [](const Int64&) {};
  for (const auto& qos : {rclcpp::QoS(1).transient_local(), rclcpp::QoS(1).keep_all()}) {
    EXPECT_THROW(within_->create_publisher<Int64>("topic", qos), std::invalid_argument);
    EXPECT_THROW(within_->create_subscription<Int64>("topic", qos, ignore), std::invalid_argument);
    rclcpp::PublisherOptions options;
    options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    EXPECT_NO_THROW(within_->create_publisher<Int64>("topic", qos, options));
    EXPECT_NO_THROW(outside_->create_publisher<Int64>("topic", qos));
    options.use_intra_process_comm = rclcpp::IntraProcessSetting::Enable;
    EXPECT_THROW(outside_->create_publisher<Int64>("topic", qos, options), std::invalid_argument);
  }
  const auto publisher = within_->create_publisher<Int64>("topic", 1);
  EXPECT_THROW(publisher->publish(rclcpp::SerializedMessage()), std::runtime_error);
}

TEST_F(IntraProcess, APublisherThatIsGoneLeavesTheTopicToOthers) {
  std::vector<std::int64_t> got;
  const auto subscription = within_->create_subscription<Int64>(
      "topic", 10, [&](const Int64& message) { got.push_back(message.data); });
  within_->create_publisher<Int64>("topic", 10)->publish(number(1));
  ASSERT_TRUE(spin_until([&] { return got.size() == 1; }));
  const auto publisher = within_->create_publisher<Int64>("topic", 10);
  publisher->publish(number(2));
  ASSERT_TRUE(spin_until([&] { return got.size() == 2; }));
  EXPECT_EQ(got, (std::vector<std::int64_t>{1, 2}));
}

/// Two threads that wait for each other's message all the time: one that was not woken would wait for ever.
TEST_F(IntraProcess, AMessageWakesAThreadThatWaits) {
  constexpr std::int64_t kRounds = 20'000;
  const auto other = std::make_shared<rclcpp::Node>("other", asking(true));
  const auto there = within_->create_publisher<Int64>("there", 1);
  const auto back = other->create_publisher<Int64>("back", 1);
  std::atomic<std::int64_t> rounds{0};
  const auto turn = other->create_subscription<Int64>(
      "there", 1, [&](const Int64& message) { back->publish(message); });
  const auto start = within_->create_subscription<Int64>("back", 1, [&](const Int64& message) {
    ++rounds;
    if (message.data < kRounds) there->publish(number(message.data + 1));
  });
  rclcpp::executors::SingleThreadedExecutor others;
  others.add_node(other);
  std::thread thread([&] { others.spin(); });
  there->publish(number(1));
  EXPECT_TRUE(spin_until([&] { return rounds == kRounds; })) << rounds;
  others.cancel();
  thread.join();
}

/// A node that sends itself a message for each one that comes leaves timers, services and messages of others their turn.
TEST_F(IntraProcess, EndlessMessagesLeaveTheOthersTheirTurn) {
  const auto publisher = within_->create_publisher<Int64>("endless", 1);
  std::int64_t endless = 0;
  const auto again = within_->create_subscription<Int64>("endless", 1, [&](const Int64& message) {
    ++endless;
    publisher->publish(message);
  });
  int ticks = 0;
  const auto timer = within_->create_wall_timer(1ms, [&] { ++ticks; });
  bool received = false;
  const auto from_outside = outside_->create_subscription<Int64>(
      "by_middleware", 1, [&](const Int64&) { received = true; });
  const auto outside = outside_->create_publisher<Int64>("by_middleware", 1);
  ASSERT_TRUE(spin_until([&] { return outside->get_subscription_count() == 1; }));
  const auto service = within_->create_service<std_srvs::srv::Trigger>(
      "asked",
      [](const std::shared_ptr<std_srvs::srv::Trigger::Request>,
         std::shared_ptr<std_srvs::srv::Trigger::Response> response) { response->success = true; });
  const auto client = outside_->create_client<std_srvs::srv::Trigger>("asked");
  publisher->publish(number(0));
  ASSERT_TRUE(spin_until([&] { return client->service_is_ready(); }));
  const auto answer =
      client->async_send_request(std::make_shared<std_srvs::srv::Trigger::Request>());
  outside->publish(number(1));
  const int before = ticks;
  const std::int64_t messages_before = endless;
  EXPECT_TRUE(spin_until([&] {
    return received && ticks > before + 2 && answer.wait_for(0s) == std::future_status::ready;
  }));
  EXPECT_GT(endless, messages_before + 10);
}

}  // namespace
