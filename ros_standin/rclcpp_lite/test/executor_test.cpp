// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int64.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <thread>
#include <vector>

namespace {

using std_msgs::msg::Int64;
using std_srvs::srv::Trigger;
using namespace std::chrono_literals;  // NOLINT: what nodes do

class Ros : public testing::Test {
 protected:
  Ros() { rclcpp::init(0, nullptr, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None); }
  ~Ros() override { rclcpp::shutdown(); }

  /// Spins until the condition holds; a test that fails ends after 30 s.
  template <typename Condition>
  static bool spin_until(rclcpp::Executor& executor, Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 30s;
    while (!condition() && std::chrono::steady_clock::now() < end) executor.spin_once(10ms);
    return condition();
  }
};
using Executor = Ros;

/// Counts how many are inside at the same time.
struct Crowd {
  std::atomic_int inside{0}, most{0}, calls{0};
  void visit() {
    const int now = ++inside;
    int seen = most;
    while (now > seen && !most.compare_exchange_weak(seen, now)) {
    }
    std::this_thread::sleep_for(5ms);
    --inside;
    ++calls;
  }
};

int most_at_once(rclcpp::CallbackGroupType type, bool one_group) {
  const auto node = std::make_shared<rclcpp::Node>("crowded");
  Crowd crowd;
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(), 4);
  std::vector<rclcpp::CallbackGroup::SharedPtr> groups;
  std::vector<rclcpp::TimerBase::SharedPtr> timers;
  for (int i = 0; i < 4; ++i) {
    if (i == 0 || !one_group) groups.push_back(node->create_callback_group(type));
    timers.push_back(node->create_wall_timer(
        1ms,
        [&] {
          crowd.visit();
          if (crowd.calls >= 40) executor.cancel();
        },
        groups.back()));
  }
  executor.add_node(node);
  executor.spin();
  EXPECT_GE(crowd.calls, 40);
  return crowd.most;
}

TEST_F(Executor, MutuallyExclusiveGroupLetsOneInAtATime) {
  EXPECT_EQ(most_at_once(rclcpp::CallbackGroupType::MutuallyExclusive, true), 1);
}

TEST_F(Executor, ReentrantGroupLetsSeveralIn) {
  EXPECT_GT(most_at_once(rclcpp::CallbackGroupType::Reentrant, true), 1);
}

TEST_F(Executor, ExclusiveGroupsDoNotHinderEachOther) {
  EXPECT_GT(most_at_once(rclcpp::CallbackGroupType::MutuallyExclusive, false), 1);
}

TEST_F(Executor, CallbackMayWaitForAServiceOfItsOwnNode) {
  const auto node = std::make_shared<rclcpp::Node>("selfish");
  const auto group = node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
  const auto service = node->create_service<Trigger>(
      "answer", [](Trigger::Request::SharedPtr, Trigger::Response::SharedPtr response) {
        response->success = true;
      });
  const auto client = node->create_client<Trigger>("answer", rclcpp::ServicesQoS(), group);
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(), 3);
  bool answered = false;
  const auto asking = node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
  const auto timer = node->create_wall_timer(
      1ms,
      [&] {
        if (!client->wait_for_service(10s)) return executor.cancel();
        auto future = client->async_send_request(std::make_shared<Trigger::Request>());
        answered = future.wait_for(10s) == std::future_status::ready && future.get()->success;
        executor.cancel();
      },
      asking);
  executor.add_node(node);
  executor.spin();
  EXPECT_TRUE(answered);
}

TEST_F(Executor, WaitingForAServiceEndsWithTheContext) {
  const auto node = std::make_shared<rclcpp::Node>("waiting");
  const auto client = node->create_client<Trigger>("nobody");
  rclcpp::shutdown();
  EXPECT_FALSE(client->wait_for_service());
}

TEST_F(Executor, FutureIsAwaitedNotLongerThanAllowed) {
  const auto node = std::make_shared<rclcpp::Node>("waiting");
  std::promise<int> promise;
  const auto future = promise.get_future().share();
  EXPECT_EQ(rclcpp::spin_until_future_complete(node, future, 20ms),
            rclcpp::FutureReturnCode::TIMEOUT);
  bool done = false;
  const auto timer = node->create_wall_timer(5ms, [&] {
    if (!done) promise.set_value(1);
    done = true;
  });
  EXPECT_EQ(rclcpp::spin_until_future_complete(node, future, 10s),
            rclcpp::FutureReturnCode::SUCCESS);
}

TEST_F(Executor, EntitiesMayComeAndGoWhileItSpins) {
  const auto node = std::make_shared<rclcpp::Node>("changing");
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  std::thread spinner([&] { executor.spin(); });
  const auto publisher = node->create_publisher<Int64>("here", 10);
  std::atomic_int received{0};
  for (int round = 0; round < 20; ++round) {
    const int before = received;
    auto subscription =
        node->create_subscription<Int64>("here", 10, [&](const Int64&) { ++received; });
    while (publisher->get_subscription_count() == 0) std::this_thread::sleep_for(1ms);
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (received == before && std::chrono::steady_clock::now() < end) {
      publisher->publish(Int64());
      std::this_thread::sleep_for(1ms);
    }
    EXPECT_GT(received, before);
    subscription.reset();
    while (publisher->get_subscription_count() != 0) {
      publisher->publish(Int64());
      std::this_thread::sleep_for(1ms);
    }
  }
  executor.cancel();
  spinner.join();
}

// With rclcpp 28 the executor would give what is ready to the wrong subscriptions, and never rest.
TEST_F(Executor, WhoDropsAnEntityTellsTheExecutor) {
  const auto node = std::make_shared<rclcpp::Node>("dropping");
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  auto subscription = node->create_subscription<Int64>("here", 10, [](const Int64&) {});
  const auto beat = node->create_wall_timer(10ms, [] {});
  const auto spin = [&](std::chrono::milliseconds time) {
    for (const auto end = std::chrono::steady_clock::now() + time;
         std::chrono::steady_clock::now() < end;)
      executor.spin_once(100ms);
  };
  spin(50ms);
  subscription.reset();
  node->get_node_base_interface()->get_default_callback_group()->trigger_notify_guard_condition();
  EXPECT_NO_THROW(spin(1500ms));
  auto timer = node->create_wall_timer(1h, [] {});
  spin(50ms);
  timer.reset();
  EXPECT_THROW(spin(1500ms), std::logic_error);
}

TEST_F(Executor, ANodeThatEndsNeedNotTellTheExecutor) {
  auto node = std::make_shared<rclcpp::Node>("ends");
  const auto stays = std::make_shared<rclcpp::Node>("stays");
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  executor.add_node(stays);
  const auto beat = stays->create_wall_timer(10ms, [] {});
  auto subscription = node->create_subscription<Int64>("here", 10, [](const Int64&) {});
  executor.spin_once(100ms);
  subscription.reset();
  node.reset();
  const auto end = std::chrono::steady_clock::now() + 1500ms;
  EXPECT_NO_THROW(while (std::chrono::steady_clock::now() < end) executor.spin_once(100ms));
}

// The middleware tells of a message in its own thread, at any moment of the wait.
TEST_F(Executor, NothingThatHasComeIsLeftLying) {
  const auto sender = std::make_shared<rclcpp::Node>("sender");
  const auto node = std::make_shared<rclcpp::Node>("receiver");
  constexpr int kMessages = 5000;
  const rclcpp::QoS all = rclcpp::QoS(rclcpp::KeepLast(kMessages)).reliable();
  const auto publisher = sender->create_publisher<Int64>("many", all);
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  std::vector<std::int64_t> received;
  std::atomic_int count{0};
  const auto subscription = node->create_subscription<Int64>("many", all, [&](const Int64& m) {
    received.push_back(m.data);
    ++count;
  });
  while (publisher->get_subscription_count() == 0) std::this_thread::sleep_for(1ms);
  std::thread spinner([&] { executor.spin(); });
  for (int i = 0; i < kMessages; ++i) {
    publisher->publish(Int64().set__data(i));
    const auto end = std::chrono::steady_clock::now() + 30s;
    // Half of them one by one: nothing that follows would hide one that was left.
    while (i % 2 == 0 && count <= i && std::chrono::steady_clock::now() < end)
      std::this_thread::yield();
    if (i % 2 == 0 && count <= i) break;
  }
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (count < kMessages && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(1ms);
  executor.cancel();
  spinner.join();
  ASSERT_EQ(received.size(), kMessages);
  for (int i = 0; i < kMessages; ++i) ASSERT_EQ(received[static_cast<std::size_t>(i)], i);
}

TEST_F(Executor, WhatCameBeforeItsExecutorIsTaken) {
  const auto node = std::make_shared<rclcpp::Node>("late");
  const auto publisher = node->create_publisher<Int64>("early", 10);
  int received = 0;
  const auto subscription =
      node->create_subscription<Int64>("early", 10, [&](const Int64&) { ++received; });
  while (publisher->get_subscription_count() == 0) std::this_thread::sleep_for(1ms);
  for (int i = 0; i < 3; ++i) publisher->publish(Int64());
  std::this_thread::sleep_for(50ms);
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  EXPECT_TRUE(spin_until(executor, [&] { return received == 3; }));
}

TEST_F(Executor, NodeBelongsToOneExecutor) {
  const auto node = std::make_shared<rclcpp::Node>("single");
  rclcpp::executors::SingleThreadedExecutor first, second;
  first.add_node(node);
  EXPECT_THROW(second.add_node(node), std::runtime_error);
  first.remove_node(node);
  EXPECT_NO_THROW(second.add_node(node));
  EXPECT_THROW(first.remove_node(node), std::runtime_error);
}

TEST_F(Executor, GroupThatIsNotAddedWithItsNodeHasItsOwnExecutor) {
  const auto node = std::make_shared<rclcpp::Node>("divided");
  const auto group =
      node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, false);
  int apart = 0, with_node = 0;
  const auto one = node->create_wall_timer(1ms, [&] { ++apart; }, group);
  const auto two = node->create_wall_timer(1ms, [&] { ++with_node; });
  rclcpp::executors::SingleThreadedExecutor of_node, of_group;
  of_node.add_node(node);
  of_group.add_callback_group(group, node->get_node_base_interface());
  EXPECT_TRUE(spin_until(of_node, [&] { return with_node > 3; }));
  EXPECT_EQ(apart, 0);
  EXPECT_TRUE(spin_until(of_group, [&] { return apart > 3; }));
}

TEST_F(Executor, WhatACallbackThrowsComesOutOfSpin) {
  const auto node = std::make_shared<rclcpp::Node>("throwing");
  const auto timer =
      node->create_wall_timer(1ms, [] { throw std::domain_error("from the callback"); });
  EXPECT_THROW(rclcpp::spin(node), std::domain_error);
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(), 3);
  executor.add_node(node);
  EXPECT_THROW(executor.spin(), std::domain_error);
}

TEST_F(Executor, SpinSomeDoesNotWait) {
  const auto node = std::make_shared<rclcpp::Node>("hasty");
  int calls = 0;
  const auto timer = node->create_wall_timer(1h, [&] { ++calls; });
  rclcpp::spin_some(node);
  EXPECT_EQ(calls, 0);
}

TEST_F(Executor, ResponseAfterRemovalIsDropped) {
  const auto node = std::make_shared<rclcpp::Node>("forgetful");
  int served = 0, answered = 0;
  const auto service = node->create_service<Trigger>(
      "slow", [&](Trigger::Request::SharedPtr, Trigger::Response::SharedPtr) { ++served; });
  const auto client = node->create_client<Trigger>("slow");
  ASSERT_TRUE(client->wait_for_service(10s));
  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(node);
  const auto ask = [&] {
    return client->async_send_request(std::make_shared<Trigger::Request>(),
                                      [&](rclcpp::Client<Trigger>::SharedFuture) { ++answered; });
  };
  EXPECT_TRUE(client->remove_pending_request(ask()));
  EXPECT_FALSE(client->remove_pending_request(std::int64_t{12345}));
  ask();
  EXPECT_TRUE(spin_until(executor, [&] { return answered == 1 && served == 2; }));
  EXPECT_EQ(client->prune_pending_requests(), 0U);
}

TEST(Context, CanBeStartedAgainAfterShutdown) {
  int told = 0;
  rclcpp::on_shutdown([&] { ++told; });  // once for all rounds
  for (int round = 0; round < 3; ++round) {
    rclcpp::init(0, nullptr);
    EXPECT_TRUE(rclcpp::ok());
    EXPECT_THROW(rclcpp::init(0, nullptr), std::runtime_error);
    const auto node = std::make_shared<rclcpp::Node>("again");
    const auto publisher = node->create_publisher<Int64>("topic", 1);
    EXPECT_TRUE(rclcpp::shutdown());
    EXPECT_EQ(told, round + 1);
    EXPECT_FALSE(rclcpp::ok());
    EXPECT_FALSE(rclcpp::shutdown());
    EXPECT_NO_THROW(publisher->publish(Int64()));  // ignored
    EXPECT_EQ(publisher->get_subscription_count(), 0U);
    EXPECT_THROW(rclcpp::spin(node), rclcpp::exceptions::RCLError);  // as with rclcpp
  }
}

TEST(Context, NodeWithoutInitIsRefused) {
  rclcpp::NodeOptions options;
  options.context(std::make_shared<rclcpp::Context>());
  EXPECT_THROW(rclcpp::Node("early", options), std::runtime_error);
}

TEST_F(Ros, BadNamesAreRefused) {
  EXPECT_THROW(rclcpp::Node("two words"), rclcpp::exceptions::InvalidNodeNameError);
  EXPECT_THROW(rclcpp::Node("n", "a b"), rclcpp::exceptions::InvalidNamespaceError);
  rclcpp::Node node("good");
  EXPECT_THROW(node.create_publisher<Int64>("a b", 1), rclcpp::exceptions::InvalidTopicNameError);
  EXPECT_THROW(node.create_client<Trigger>("a b"), rclcpp::exceptions::InvalidServiceNameError);
}

}  // namespace
