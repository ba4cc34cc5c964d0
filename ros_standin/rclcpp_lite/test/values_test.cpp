// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

namespace {

using rclcpp::Duration;
using rclcpp::Parameter;
using rclcpp::Time;
using namespace std::chrono_literals;  // NOLINT: what nodes do

TEST(Duration, ConvertsBetweenUnitsAndMessages) {
  const Duration duration = 1500ms;
  EXPECT_EQ(duration.nanoseconds(), 1'500'000'000);
  EXPECT_DOUBLE_EQ(duration.seconds(), 1.5);
  const builtin_interfaces::msg::Duration message = Duration::from_seconds(-0.25);
  EXPECT_EQ(message.sec, -1);
  EXPECT_EQ(message.nanosec, 750'000'000U);
  EXPECT_EQ(Duration(message), Duration::from_seconds(-0.25));
  EXPECT_EQ((duration * 2.0).to_chrono<std::chrono::milliseconds>(), 3000ms);
}

TEST(Duration, OverflowIsAnError) {
  const auto most = Duration::from_nanoseconds(std::numeric_limits<std::int64_t>::max());
  EXPECT_THROW(most + 1ns, std::overflow_error);
  EXPECT_THROW(most * 2.0, std::overflow_error);
  EXPECT_THROW(Duration(-1, 0).to_rmw_time(), std::runtime_error);
}

TEST(Time, DifferentClocksDoNotMix) {
  const Time ros(1, 500'000'000, RCL_ROS_TIME);
  const Time system(1, 0, RCL_SYSTEM_TIME);
  EXPECT_THROW((void)(ros < system), std::runtime_error);
  EXPECT_THROW((void)(ros - system), std::runtime_error);
  EXPECT_THROW((void)(ros == system), std::runtime_error);
  EXPECT_EQ((ros + 500ms).nanoseconds(), 2'000'000'000);
  EXPECT_EQ((ros - Time(1, 0, RCL_ROS_TIME)).nanoseconds(), 500'000'000);
}

TEST(Time, MessageHoldsNoTimeBeforeZero) {
  const Time before(std::int64_t{-1}, RCL_ROS_TIME);
  EXPECT_THROW((void)static_cast<builtin_interfaces::msg::Time>(before), std::runtime_error);
  builtin_interfaces::msg::Time message;
  message.sec = 7;
  message.nanosec = 9;
  EXPECT_EQ(Time(message).nanoseconds(), 7'000'000'009);
  EXPECT_EQ(Time(message).get_clock_type(), RCL_ROS_TIME);
}

TEST(Rate, MustBePositive) {
  EXPECT_THROW(rclcpp::Rate(0.0), std::invalid_argument);
  EXPECT_THROW(rclcpp::WallRate(-1.0), std::invalid_argument);
}

TEST(Qos, ProfilesHaveTheValuesOfRos) {
  EXPECT_EQ(rclcpp::QoS(7).depth(), 7U);
  EXPECT_EQ(rclcpp::QoS(7).reliability(), rclcpp::ReliabilityPolicy::Reliable);
  EXPECT_EQ(rclcpp::QoS(7).durability(), rclcpp::DurabilityPolicy::Volatile);
  EXPECT_EQ(rclcpp::SensorDataQoS().depth(), 5U);
  EXPECT_EQ(rclcpp::SensorDataQoS().reliability(), rclcpp::ReliabilityPolicy::BestEffort);
  EXPECT_EQ(rclcpp::SensorDataQoS(rclcpp::KeepLast(2)).depth(), 2U);
  EXPECT_EQ(rclcpp::ClockQoS().depth(), 1U);
  EXPECT_EQ(rclcpp::ParameterEventsQoS().depth(), 1000U);
  EXPECT_EQ(rclcpp::QoS(1).keep_all().history(), rclcpp::HistoryPolicy::KeepAll);
  EXPECT_EQ(rclcpp::QoS(1).deadline(20ms).deadline(), Duration(20ms));
  EXPECT_NE(rclcpp::QoS(1), rclcpp::QoS(1).transient_local());
}

TEST(Parameter, IsReadAsItsTypeOnly) {
  const Parameter parameter("gain", 1.5);
  EXPECT_DOUBLE_EQ(parameter.as_double(), 1.5);
  EXPECT_DOUBLE_EQ(parameter.get_value<float>(), 1.5);
  EXPECT_THROW((void)parameter.as_int(), rclcpp::exceptions::InvalidParameterTypeException);
  EXPECT_EQ(Parameter("text", "as it is").as_string(), "as it is");
  EXPECT_EQ(Parameter("list", std::vector<int>{1, 2}).as_integer_array().back(), 2);
  EXPECT_EQ(Parameter("none").get_type(), rclcpp::PARAMETER_NOT_SET);
  EXPECT_EQ(Parameter("flags", std::vector<bool>{true, false}).value_to_string(), "[true, false]");
}

class WithRos : public testing::Test {
 protected:
  WithRos() { rclcpp::init(0, nullptr); }
  ~WithRos() override { rclcpp::shutdown(); }
};
using NodeParameters = WithRos;

TEST_F(NodeParameters, AreDeclaredOnceAndReadWhenDeclared) {
  rclcpp::Node node("holder");
  EXPECT_THROW((void)node.get_parameter("gain"), rclcpp::exceptions::ParameterNotDeclaredException);
  EXPECT_EQ(node.declare_parameter("gain", 2), 2);
  EXPECT_THROW(node.declare_parameter("gain", 2),
               rclcpp::exceptions::ParameterAlreadyDeclaredException);
  EXPECT_THROW(node.declare_parameter<double>("unset"),
               rclcpp::exceptions::ParameterUninitializedException);
  EXPECT_THROW(node.set_parameter(Parameter("other", 1)),
               rclcpp::exceptions::ParameterNotDeclaredException);
  double value = 0.0;
  EXPECT_FALSE(node.get_parameter("other", value));
  EXPECT_DOUBLE_EQ(node.get_parameter_or("other", 4.5), 4.5);
  EXPECT_TRUE(node.has_parameter("gain") && !node.has_parameter("other"));
}

TEST_F(NodeParameters, OverridesOfTheOptionsCount) {
  rclcpp::NodeOptions options;
  options.append_parameter_override("gain", 3.5).append_parameter_override("free", 1);
  rclcpp::Node node("given", options);
  EXPECT_DOUBLE_EQ(node.declare_parameter("gain", 1.0), 3.5);
  EXPECT_FALSE(node.has_parameter("free"));
  options.automatically_declare_parameters_from_overrides(true);
  rclcpp::Node automatic("automatic", options);
  EXPECT_EQ(automatic.get_parameter("free").as_int(), 1);
}

TEST_F(NodeParameters, MayBeUndeclaredWhereThatIsAllowed) {
  rclcpp::Node node("open", rclcpp::NodeOptions().allow_undeclared_parameters(true));
  EXPECT_TRUE(node.set_parameter(Parameter("new", 1)).successful);
  EXPECT_TRUE(node.set_parameter(Parameter("new", "another type")).successful);
  EXPECT_EQ(node.get_parameter("new").as_string(), "another type");
  EXPECT_EQ(node.get_parameter("nothing").get_type(), rclcpp::PARAMETER_NOT_SET);
}

TEST_F(NodeParameters, CallbackRefusesUntilItsHandleIsDropped) {
  rclcpp::Node node("strict");
  node.declare_parameter("gain", 1);
  auto handle = node.add_on_set_parameters_callback([&](const std::vector<Parameter>&) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = false;
    result.reason = "never";
    EXPECT_THROW(node.set_parameter(Parameter("gain", 5)),
                 rclcpp::exceptions::ParameterModifiedInCallbackException);
    return result;
  });
  EXPECT_EQ(node.set_parameter(Parameter("gain", 2)).reason, "never");
  EXPECT_THROW(node.declare_parameter("late", 1),
               rclcpp::exceptions::InvalidParameterValueException);
  handle.reset();
  EXPECT_TRUE(node.set_parameter(Parameter("gain", 2)).successful);
  EXPECT_EQ(node.get_parameter("gain").as_int(), 2);
}

}  // namespace
