// SPDX-License-Identifier: BSD-3-Clause
// What compiles here compiles with the rclcpp of Humble (16) and Jazzy (28): types that their
// headers state, and forms that they refuse. Most of it is decided by the compiler.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <rclcpp/create_timer.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int64.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace {

using rclcpp::Node;
using rclcpp::Parameter;
using rclcpp::ParameterValue;
using std_msgs::msg::Int64;
using std_srvs::srv::Trigger;

template <typename Left, typename Right>
inline constexpr bool kSame = std::is_same_v<Left, Right>;

TEST(Api, ParametersHaveTheTypesOfTheirMessages) {
  static_assert(kSame<decltype(std::declval<Node&>().declare_parameter("a", 1)), std::int64_t>);
  static_assert(kSame<decltype(std::declval<Node&>().declare_parameter("a", 1.0F)), double>);
  static_assert(kSame<decltype(std::declval<Node&>().declare_parameter("a", true)), bool>);
  static_assert(
      kSame<decltype(std::declval<Node&>().declare_parameter("a", std::string())), std::string>);
  static_assert(kSame<decltype(std::declval<Node&>().declare_parameter<int>("a")), std::int64_t>);
  static_assert(kSame<decltype(std::declval<Node&>().declare_parameter("a", ParameterValue(1))),
                      const ParameterValue&>);
  static_assert(kSame<decltype(std::declval<Parameter&>().as_int()), std::int64_t>);
  static_assert(kSame<decltype(std::declval<Parameter&>().as_double()), double>);
  static_assert(kSame<decltype(std::declval<Parameter&>().get_value<int>()), const std::int64_t&>);
  static_assert(kSame<decltype(std::declval<ParameterValue&>().get<float>()), const double&>);
  static_assert(kSame<decltype(std::declval<ParameterValue&>().get<std::vector<int>>()),
                      const std::vector<std::int64_t>&>);
  static_assert(!rclcpp::detail::kMakesParameter<unsigned> &&
                !rclcpp::detail::kMakesParameter<std::uint16_t> &&
                !rclcpp::detail::kMakesParameter<std::vector<unsigned>>);
  static_assert(!std::is_convertible_v<int, ParameterValue>, "explicit");
}

TEST(Api, SubscriptionsTakeTheSameCallbacks) {
  const auto takes = [](auto callback) {
    return rclcpp::detail::kTakes<decltype(callback), Int64> ||
           rclcpp::detail::kTakes<decltype(callback), rclcpp::SerializedMessage>;
  };
  EXPECT_TRUE(takes([](const Int64&) {}));
  EXPECT_TRUE(takes([](Int64::ConstSharedPtr) {}));  // NOLINT: the form itself
  EXPECT_TRUE(takes([](const Int64::ConstSharedPtr&) {}));
  EXPECT_TRUE(takes([](Int64::SharedPtr) {}));  // NOLINT: the form itself
  EXPECT_TRUE(takes([](Int64::UniquePtr) {}));
  EXPECT_TRUE(takes([](const Int64&, const rclcpp::MessageInfo&) {}));
  EXPECT_TRUE(takes([](std::unique_ptr<rclcpp::SerializedMessage>) {}));
  EXPECT_FALSE(takes([](Int64) {}));
  EXPECT_FALSE(takes([](const Int64::SharedPtr&) {}));
  EXPECT_FALSE(takes([](const Int64&, rclcpp::MessageInfo) {}));  // NOLINT: the form itself
  EXPECT_FALSE(takes([] {}));
  EXPECT_FALSE(takes([n = 0](const Int64&) mutable { ++n; }))
      << "rclcpp knows const call operators only";
}

TEST(Api, TimersTakeTheSameCallbacks) {
  const auto takes = [](auto callback) { return rclcpp::detail::kTimerTakes<decltype(callback)>; };
  EXPECT_TRUE(takes([] {}));
  EXPECT_TRUE(takes([](rclcpp::TimerBase&) {}));
  EXPECT_TRUE(takes(std::function<void()>()));
  EXPECT_FALSE(takes([n = 0]() mutable { ++n; }));
  EXPECT_FALSE(takes([]() noexcept {}));
  EXPECT_FALSE(takes([](int) {}));
  EXPECT_FALSE(takes([](const rclcpp::TimerBase&) {}));
}

TEST(Api, ServicesTakeTheSameCallbacks) {
  using Request = std::shared_ptr<Trigger::Request>;
  using Response = std::shared_ptr<Trigger::Response>;
  const auto takes = [](auto callback) {
    return rclcpp::detail::kServiceTakes<decltype(callback), Trigger>;
  };
  EXPECT_TRUE(takes([](Request, Response) {}));                           // NOLINT: the form itself
  EXPECT_TRUE(takes([](std::shared_ptr<rmw_request_id_t>, Request) {}));  // NOLINT: the form itself
  EXPECT_TRUE(takes(
      [](std::shared_ptr<rmw_request_id_t>, Request, Response) {}));  // NOLINT: the form itself
  EXPECT_FALSE(takes([n = 0](Request, Response) mutable { ++n; }));   // NOLINT: the form itself
  EXPECT_TRUE(takes([](const Request&, const Response&) {}));
  EXPECT_FALSE(takes([](int) {}));
}

template <typename CallbackT, typename = void>
inline constexpr bool kClientTakes = false;
template <typename CallbackT>
inline constexpr bool kClientTakes<
    CallbackT, std::void_t<decltype(std::declval<rclcpp::Client<Trigger>&>().async_send_request(
                   std::shared_ptr<Trigger::Request>(), std::declval<CallbackT>()))>> = true;

TEST(Api, ClientsTakeTheSameCallbacksAndKeepTheirFutures) {
  using Client = rclcpp::Client<Trigger>;
  const auto takes = [](auto callback) { return kClientTakes<decltype(callback)>; };
  EXPECT_TRUE(takes([](Client::SharedFuture) {}));             // NOLINT: the form itself
  EXPECT_TRUE(takes([](Client::SharedFutureWithRequest) {}));  // NOLINT: the form itself
  EXPECT_FALSE(takes([](const Client::SharedFuture&) {}));
  EXPECT_FALSE(takes([](const Client::SharedResponse&) {}));
  static_assert(!std::is_copy_constructible_v<Client::FutureAndRequestId> &&
                !std::is_copy_constructible_v<Client::SharedFutureAndRequestId>);
  static_assert(std::is_move_constructible_v<Client::FutureAndRequestId>);
  static_assert(kSame<decltype(std::declval<Client&>().prune_pending_requests()), std::size_t>);
}

TEST(Api, WhatOnlyOneOfThemHasIsNotThere) {
  // Humble: rmw_qos_profile_t where Jazzy has a QoS; a node's own create_timer and
  // add_post_set_parameters_callback are Jazzy's.
  static_assert(!std::is_convertible_v<rclcpp::ServicesQoS, rmw_qos_profile_t>);
  static_assert(!std::is_convertible_v<rmw_qos_profile_t, rclcpp::QoS>);
  static_assert(std::is_convertible_v<int, rclcpp::QoS>);
  static_assert(!std::is_constructible_v<rclcpp::Rate, double, rclcpp::Clock::SharedPtr>);
  static_assert(std::is_constructible_v<rclcpp::Rate, std::chrono::milliseconds>);
}

TEST(Api, TimesConvertAsTheyDoThere) {
  static_assert(std::is_convertible_v<std::chrono::milliseconds, rclcpp::Duration>);
  static_assert(!std::is_convertible_v<std::int64_t, rclcpp::Duration>);
  static_assert(!std::is_constructible_v<rclcpp::Duration, std::int64_t>);
  static_assert(!std::is_convertible_v<std::int64_t, rclcpp::Time>);
  static_assert(std::is_constructible_v<rclcpp::Time, std::int64_t, rcl_clock_type_t>);
  static_assert(std::is_convertible_v<builtin_interfaces::msg::Time, rclcpp::Time>);
  static_assert(std::is_convertible_v<rclcpp::Time, builtin_interfaces::msg::Time>);
  static_assert(kSame<decltype(rclcpp::Time() - rclcpp::Time()), rclcpp::Duration>);
  static_assert(kSame<decltype(std::declval<const rclcpp::Clock&>().now()), rclcpp::Time>);
  static_assert(
      kSame<decltype(std::declval<const Node&>().get_clock()), rclcpp::Clock::ConstSharedPtr>);
  static_assert(kSame<decltype(std::declval<Node&>().get_clock()), rclcpp::Clock::SharedPtr>);
}

}  // namespace
