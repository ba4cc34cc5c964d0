// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/io_node.hpp"

#include <filesystem>
#include <memory>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/aux_command.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "messages/link.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_io/diagnostics.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;

namespace {

constexpr std::chrono::milliseconds kLookAfterPeriod{10};
constexpr std::chrono::seconds kDiagnosePeriod{1};
constexpr int kWarningPeriod_ms = 1000;

rcl_interfaces::msg::ParameterDescriptor described(const std::string& text) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = text;
  descriptor.read_only = true;
  return descriptor;
}

rcl_interfaces::msg::ParameterDescriptor port_number(const std::string& text) {
  rcl_interfaces::msg::ParameterDescriptor descriptor = described(text);
  descriptor.integer_range.resize(1);
  descriptor.integer_range[0].from_value = 1;
  descriptor.integer_range[0].to_value = 65535;
  return descriptor;
}

}  // namespace

IoNode::IoNode(const rclcpp::NodeOptions& options)
    : Node("rosflight_io", options),
      clock_{get_clock()},
      runner_{codec_, read_link(), companion::Session::Options{}, [this] { return clock_.now(); }},
      streams_{
          *this, clock_,
          declare_parameter<std::string>(
              "frame_id", "world", described("frame of IMU, IMU temperature and magnetometer"))},
      log_lines_{get_logger()},
      parameters_{*this, runner_},
      services_{*this, runner_},
      diagnostics_{create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", 10)} {
  companion::Session& session = runner_.session();
  session.add(log_lines_);
  session.add(streams_);
  session.add(parameters_);
  runner_.on_link_state([logger = get_logger(), first = std::make_shared<bool>(true)](
                            bool open, const std::string& line) {
    if (open && std::exchange(*first, false)) {
      RCLCPP_DEBUG(logger, "%s", line.c_str());  // the version has more
    } else if (open) {
      RCLCPP_INFO(logger, "%s", line.c_str());
    } else {
      RCLCPP_WARN(logger, "%s", line.c_str());
    }
  });
  subscribe();
  look_after_timer_ = create_wall_timer(kLookAfterPeriod, [this] { look_after(); });
  diagnose_timer_ = create_wall_timer(kDiagnosePeriod, [this] { diagnose(); });
  runner_.open();
  start_link();
}

IoNode::~IoNode() {
  runner_.stop();
  if (link_.joinable()) link_.join();
}

companion::LinkSpec IoNode::read_link() {
  const bool udp =
      declare_parameter("udp", false, described("uses UDP instead of the serial port"));
  const std::string bind_host = declare_parameter<std::string>(
      "bind_host", "localhost",
      described("default of remote_host; the node listens on every address"));
  const auto bind_port =
      declare_parameter<std::int64_t>("bind_port", 14520, port_number("local UDP port"));
  const std::string remote_host = declare_parameter<std::string>(
      "remote_host", bind_host, described("address of the simulated board"));
  const auto remote_port = declare_parameter<std::int64_t>(
      "remote_port", 14525, port_number("UDP port of the simulated board"));
  const std::string port =
      declare_parameter<std::string>("port", "/dev/ttyACM0", described("serial device"));
  const auto baud_rate = declare_parameter<std::int64_t>(
      "baud_rate", 921600, described("baud rate of the serial device"));
  const bool wait = declare_parameter("wait_for_port", false,
                                      described("waits for a serial device that is not there yet"));
  const std::string link =
      declare_parameter<std::string>("link", "",
                                     described("link that replaces all parameters above: "
                                               "serial:PATH[:BAUD], udp:HOST:PORT[:LOCAL_PORT], "
                                               "tcp:HOST:PORT, tcp:PORT, pty"));
  if (!link.empty()) return companion::parse_link(link);
  if (udp) {
    return companion::parse_link("udp:" + remote_host + ":" + std::to_string(remote_port) + ":" +
                                 std::to_string(bind_port));
  }
  if (!wait && !std::filesystem::exists(port)) {
    throw companion::LinkError("port: found " + port +
                               ", which is not there; wait_for_port:=true "
                               "waits for it");
  }
  return companion::parse_link("serial:" + port + ":" + std::to_string(baud_rate));
}

void IoNode::subscribe() {
  commands_ = create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
  namespace ours = rosflight::messages::rosflight_msgs;
  forward<ours::Command, rosflight_msgs::msg::Command>("command", rosflight_common::newest());
  forward<ours::AuxCommand, rosflight_msgs::msg::AuxCommand>("aux_command",
                                                             rosflight_common::newest());
  forward<ours::Attitude, rosflight_msgs::msg::Attitude>("external_attitude",
                                                         rosflight_common::stream());
}

template <class Message, class Ros>
void IoNode::forward(const char* topic, const rclcpp::QoS& qos) {
  rclcpp::SubscriptionOptions options;
  options.callback_group = commands_;
  subscriptions_.push_back(create_subscription<Ros>(
      topic, qos,
      [this, topic](typename Ros::ConstSharedPtr received) {
        if (!link_runs_) return;
        const auto message =
            rosflight::messages::to_link(rosflight_common::from_ros<Message>(*received));
        runner_.post([this, topic, message](companion::Session& session) {
          const companion::SendStatus status = session.offboard().send(message);
          if (status == companion::SendStatus::kSent) return;
          RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kWarningPeriod_ms, "%s not sent: %s",
                               topic, companion::send_status_text(status));
        });
      },
      options));
}

void IoNode::start_link() {
  if (link_.joinable() || !clock_.runs()) return;
  link_ = std::thread([this] { run_link(); });
  link_runs_ = true;
}

void IoNode::run_link() {
  try {
    runner_.run();
  } catch (const std::exception& error) {
    RCLCPP_FATAL(get_logger(), "the link has failed: %s", error.what());
    link_failed_ = true;
    rclcpp::shutdown();
  }
}

/// What only the node's thread may do for the link's.
void IoNode::look_after() {
  start_link();
  if (!link_.joinable()) return;
  parameters_.update();
  if (has_baro_) services_.offer_baro();
  if (has_airspeed_) services_.offer_airspeed();
  // The link's timers do not see simulated time move: each task makes it look at the clock.
  if (clock_.simulated()) runner_.post([](companion::Session&) {});
}

void IoNode::diagnose() {
  if (!link_.joinable()) return;
  runner_.post([this](companion::Session& session) {
    has_baro_ = session.streams().baro.count > 0;
    has_airspeed_ = session.streams().diff_pressure.count > 0;
    auto array = diagnostics_of(session, get_fully_qualified_name(), runner_.transport().name());
    array.header.stamp = now();
    diagnostics_->publish(array);
  });
}

}  // namespace rosflight_io

ROSFLIGHT_WAITS_IN_CALLBACKS
ROSFLIGHT_COMPONENT(rosflight_io::IoNode)
