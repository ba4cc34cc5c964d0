// SPDX-License-Identifier: BSD-3-Clause
// The node that the tests of this folder talk to from rclpy. Topics and services are relative.
#include <chrono>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int64.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <vector>

namespace {

using std_msgs::msg::Int64;
using std_msgs::msg::String;
using std_srvs::srv::SetBool;
using std_srvs::srv::Trigger;
using namespace std::chrono_literals;  // NOLINT: what nodes do

class Peer : public rclcpp::Node {
 public:
  Peer() : Node("peer") {
    declare();
    echo("echo/reference", [this](const Int64& message) { reply(message.data); });
    echo("echo/shared", [this](Int64::SharedPtr message) { reply(message->data); });
    echo("echo/const_shared", [this](Int64::ConstSharedPtr message) { reply(message->data); });
    echo("echo/unique", [this](Int64::UniquePtr message) { reply(message->data); });
    echo("echo/with_info", [this](const Int64& message, const rclcpp::MessageInfo& info) {
      const auto& known = info.get_rmw_message_info();
      reply(known.source_timestamp > 0 && !known.from_intra_process ? message.data : -1);
    });
    echo("echo/bytes",
         [this](std::shared_ptr<rclcpp::SerializedMessage> bytes) { reply_->publish(*bytes); });
    echo("echo/member", std::bind(&Peer::on_member, this, std::placeholders::_1));
    offer_qos("qos/reliable", rclcpp::QoS(10).reliable());
    offer_qos("qos/best_effort", rclcpp::QoS(5).best_effort());
    offer_qos("qos/sensor_data", rclcpp::SensorDataQoS());
    offer_qos("qos/system_defaults", rclcpp::SystemDefaultsQoS());
    latched_ = create_publisher<String>("latched", rclcpp::QoS(1).transient_local());
    String text;
    text.data = "kept for late ones";
    latched_->publish(text);
    recent_ = create_publisher<Int64>("recent", rclcpp::QoS(5).transient_local());
    for (std::int64_t i = 1; i <= 8; ++i) say(*recent_, i);
    kept_.push_back(
        create_subscription<Int64>("to_latched", rclcpp::QoS(5).transient_local(),
                                   [this](const Int64& message) { reply(message.data); }));
    offer_services();
    watch_jumps();
    start_timers();
  }

 private:
  template <typename CallbackT>
  void echo(const std::string& topic, CallbackT&& callback) {
    kept_.push_back(create_subscription<Int64>(topic, 10, std::forward<CallbackT>(callback)));
  }
  void on_member(const Int64::ConstSharedPtr& message) { reply(message->data); }
  static void say(rclcpp::Publisher<Int64>& publisher, std::int64_t value) {
    Int64 message;
    message.data = value;
    publisher.publish(message);
  }
  void reply(std::int64_t value) { say(*reply_, value); }

  /// Says on TOPIC/received what it got on TOPIC, both with the same quality of service.
  void offer_qos(const std::string& topic, const rclcpp::QoS& qos) {
    const auto received = create_publisher<Int64>(topic + "/received", qos);
    kept_.push_back(create_subscription<Int64>(
        topic, qos, [received](const Int64& message) { received->publish(message); }));
  }

  void offer_services() {
    simple_ = create_service<SetBool>("simple", [](const SetBool::Request::SharedPtr request,
                                                   SetBool::Response::SharedPtr answer) {
      answer->success = request->data;
      answer->message = "simple";
    });
    with_id_ = create_service<SetBool>("with_id", [](const std::shared_ptr<rmw_request_id_t> id,
                                                     const SetBool::Request::SharedPtr request,
                                                     SetBool::Response::SharedPtr answer) {
      answer->success = request->data;
      answer->message = id->sequence_number > 0 ? "with id" : "no id";
    });
    deferred_ = create_service<SetBool>(
        "deferred", [this](const std::shared_ptr<rclcpp::Service<SetBool>> service,
                           const std::shared_ptr<rmw_request_id_t> id,
                           const SetBool::Request::SharedPtr request) {
          later_ = create_wall_timer(20ms, [this, service, id, request] {
            later_->cancel();
            SetBool::Response answer;
            answer.success = request->data;
            answer.message = "later";
            service->send_response(*id, answer);
          });
        });
    client_ = create_client<SetBool>("server_in_python");
    ask_ = create_service<Trigger>("ask_python", [this](const Trigger::Request::SharedPtr,
                                                        Trigger::Response::SharedPtr answer) {
      answer->success = client_->service_is_ready();
      answer->message = client_->get_service_name();
      auto request = std::make_shared<SetBool::Request>();
      request->data = true;
      client_->async_send_request(request, [this](rclcpp::Client<SetBool>::SharedFuture future) {
        String said;
        said.data = future.get()->message;
        python_said_->publish(said);
      });
    });
    log_ = create_service<Trigger>(
        "log", [this](const Trigger::Request::SharedPtr, Trigger::Response::SharedPtr answer) {
          RCLCPP_DEBUG(get_logger(), "debug %d", 1);
          RCLCPP_INFO(get_logger(), "info %d", 2);
          RCLCPP_WARN_STREAM(get_logger(), "warn " << 3);
          RCLCPP_ERROR(get_logger(), "error %s", "4");
          for (int i = 0; i < 3; ++i) {
            RCLCPP_INFO_ONCE(get_logger(), "once");
            RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 60000, "throttled");
          }
          answer->success = true;
        });
    declare_ = create_service<Trigger>(
        "declare", [this](const Trigger::Request::SharedPtr, Trigger::Response::SharedPtr answer) {
          rcl_interfaces::msg::ParameterDescriptor free;
          free.dynamic_typing = true;
          if (has_parameter("late")) undeclare_parameter("late");
          answer->message = std::to_string(declare_parameter("late", 7, free));
          answer->success = true;
        });
    count_ = create_service<Trigger>(
        "count", [this](const Trigger::Request::SharedPtr, Trigger::Response::SharedPtr answer) {
          answer->message = std::to_string(count_subscribers("reply")) + " " +
                            std::to_string(count_publishers("reply")) + " " +
                            std::to_string(reply_->get_subscription_count());
          answer->success = true;
        });
  }

  void start_timers() {
    wall_ = create_wall_timer(20ms, [this] { say(*wall_ticks_, ++walls_); });
    ros_ = rclcpp::create_timer(this, get_clock(), 100ms,
                                [this] { say(*ros_ticks_, now().nanoseconds()); });
  }

  /// Tells how far the clock jumped [ns]: forward by 10 s or more, back by any span.
  void watch_jumps() {
    const rcl_jump_threshold_t far{true, {10'000'000'000}, {-1}};
    jumps_ = get_clock()->create_jump_callback(
        nullptr, [this](const rcl_time_jump_t& jump) { say(*jumped_, jump.delta.nanoseconds); },
        far);
  }

  void declare() {
    rcl_interfaces::msg::ParameterDescriptor gain;
    gain.description = "a gain";
    gain.floating_point_range.resize(1);
    gain.floating_point_range[0].from_value = 0.0;
    gain.floating_point_range[0].to_value = 2.0;
    gain.floating_point_range[0].step = 0.25;
    declare_parameter("gain", 1.0, gain);
    rcl_interfaces::msg::ParameterDescriptor count;
    count.integer_range.resize(1);
    count.integer_range[0].from_value = -3;
    count.integer_range[0].to_value = 9;
    count.integer_range[0].step = 3;
    declare_parameter<int>("count", 3, count);
    rcl_interfaces::msg::ParameterDescriptor fixed;
    fixed.read_only = true;
    declare_parameter("fixed", std::string("as it is"), fixed);
    declare_parameter("group.flag", false);
    declare_parameter("group.deep.names", std::vector<std::string>{"a", "b"});
    declare_parameter("group.numbers", std::vector<double>{1.0, 2.5});
    declare_parameter("even", 2);
    rcl_interfaces::msg::ParameterDescriptor free;
    free.dynamic_typing = true;
    declare_parameter("free", 1, free);
    on_set_ = add_on_set_parameters_callback([](const std::vector<rclcpp::Parameter>& parameters) {
      rcl_interfaces::msg::SetParametersResult result;
      result.successful = true;
      for (const auto& parameter : parameters) {
        if (parameter.get_name() == "even" && parameter.as_int() < 0)
          throw std::runtime_error("the callback threw");
        if (parameter.get_name() == "even" && parameter.as_int() % 2 != 0) {
          result.successful = false;
          result.reason = "odd";
        }
      }
      return result;
    });
  }

  rclcpp::Publisher<Int64>::SharedPtr reply_{create_publisher<Int64>("reply", 10)};
  rclcpp::Publisher<Int64>::SharedPtr wall_ticks_{create_publisher<Int64>("wall_ticks", 1000)};
  rclcpp::Publisher<Int64>::SharedPtr ros_ticks_{create_publisher<Int64>("ros_ticks", 50)};
  rclcpp::Publisher<String>::SharedPtr python_said_{create_publisher<String>("python_said", 10)};
  rclcpp::Publisher<Int64>::SharedPtr jumped_{create_publisher<Int64>("jumps", 50)};
  rclcpp::Publisher<String>::SharedPtr latched_;
  rclcpp::Publisher<Int64>::SharedPtr recent_;
  rclcpp::JumpHandler::SharedPtr jumps_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> kept_;
  rclcpp::Service<SetBool>::SharedPtr simple_, with_id_, deferred_;
  rclcpp::Service<Trigger>::SharedPtr ask_, log_, count_, declare_;
  rclcpp::Client<SetBool>::SharedPtr client_;
  rclcpp::TimerBase::SharedPtr wall_, ros_, later_;
  std::int64_t walls_{0};
  OnSetParametersCallbackHandle::SharedPtr on_set_;
};

}  // namespace

int main(int argc, char** argv) {
  bool started = false;
  try {
    rclcpp::init(argc, argv);
    started = true;
    rclcpp::spin(std::make_shared<Peer>());
    rclcpp::shutdown();
  } catch (const std::exception& error) {
    // A signal may come while the node is being made: that is an end like any other.
    if (started && !rclcpp::ok()) return 0;
    RCLCPP_FATAL(rclcpp::get_logger("peer"), "%s", error.what());
    return 2;
  }
  return 0;
}
