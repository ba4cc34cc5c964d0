// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/stream_publisher.hpp"

#include <utility>

#include "messages/link.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/messages.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;
namespace messages = rosflight::messages;
using messages::to_message;
using rosflight_common::to_ros;

/// What a machine without time has not passed on is kept, 2.5 s of the IMU; with a depth of 1 the next message replaces it.
constexpr std::size_t kDepth = 1000;

StreamPublisher::StreamPublisher(rclcpp::Node& node, Clock& clock, std::string frame_id)
    : node_{node}, clock_{clock}, frame_id_{std::move(frame_id)} {
  unsaved_ = rosflight_common::create_latched_publisher<std_msgs::msg::Bool>(
      node, "status/unsaved_params", 1);
  errors_ = rosflight_common::create_latched_publisher<rosflight_msgs::msg::Error>(
      node, "status/rosflight_errors", 5);
  params_changed_ = node.create_publisher<std_msgs::msg::Bool>("status/params_changed", 1);
  restarted_ = node.create_publisher<std_msgs::msg::Bool>("status/restarted", 1);
  unsaved_->publish(std_msgs::msg::Bool());
}

/// Satellites are measured long before they are received: what is from before the time began has no stamp.
template <class Ros, class Message>
void StreamPublisher::publish(Topic<Ros>& topic, const Message& message, companion::Time t,
                              const std::string& frame_id) {
  if (t < clock_.begin()) return;
  if (!topic.publisher) topic.publisher = node_.create_publisher<Ros>(topic.name, kDepth);
  auto out = to_ros<Ros>(message);
  out.header.stamp = clock_.to_ros(t);
  out.header.frame_id = frame_id;
  topic.publisher->publish(out);
}

void StreamPublisher::on_imu(const link::Imu& m, const Stamp& stamp) {
  publish(imu_, attitude_ ? to_message(m, *attitude_) : to_message(m), stamp.sample, frame_id_);
  publish(temperature_, messages::imu_temperature(m), stamp.sample, frame_id_);
}

void StreamPublisher::on_attitude(const link::Attitude& m, const Stamp& stamp) {
  attitude_ = m;
  publish(attitude_topic_, to_message(m), stamp.sample);
  publish(euler_, messages::euler_message(m), stamp.sample);
}

void StreamPublisher::on_mag(const link::Mag& m, const Stamp& stamp) {
  publish(mag_, to_message(m), stamp.sample, frame_id_);
}

void StreamPublisher::on_baro(const link::Baro& m, const Stamp& stamp) {
  publish(baro_, to_message(m), stamp.sample);
}

void StreamPublisher::on_diff_pressure(const link::DiffPressure& m, const Stamp& stamp) {
  publish(airspeed_, to_message(m), stamp.sample);
}

void StreamPublisher::on_range(const link::Range& m, const Stamp& stamp) {
  publish(range_, to_message(m), stamp.sample);
}

void StreamPublisher::on_rc(const link::RcChannels& m, const Stamp& stamp) {
  publish(rc_, to_message(m), stamp.sample);
}

void StreamPublisher::on_output(const link::OutputRaw& m, const Stamp& stamp) {
  publish(output_, to_message(m), stamp.sample);
}

void StreamPublisher::on_gnss(const link::Gnss& m, const Stamp& stamp) {
  publish(gnss_, to_message(m), stamp.sample, "NED");
}

void StreamPublisher::on_battery(const link::BatteryStatus& m, const Stamp& stamp) {
  publish(battery_, to_message(m), stamp.sample);
}

void StreamPublisher::on_status(const link::Status& m, const Stamp& stamp) {
  publish(status_, to_message(m), stamp.arrival);
}

void StreamPublisher::on_event(const companion::Event& event) {
  if (const auto* connection = std::get_if<companion::ConnectionEvent>(&event)) {
    if (connection->change != companion::ConnectionChange::kRestarted) return;
    std_msgs::msg::Bool message;
    message.data = true;
    restarted_->publish(message);
  } else if (const auto* unsaved = std::get_if<companion::UnsavedEvent>(&event)) {
    std_msgs::msg::Bool message;
    message.data = unsaved->unsaved;
    unsaved_->publish(message);
  } else if (const auto* list = std::get_if<companion::ParameterListEvent>(&event)) {
    list_complete_ = list->complete;
  } else if (const auto* parameter = std::get_if<companion::ParameterEvent>(&event)) {
    if (!list_complete_ || parameter->first) return;
    std_msgs::msg::Bool message;
    message.data = true;
    params_changed_->publish(message);
  } else if (const auto* fault = std::get_if<link::HardError>(&event)) {
    auto message = to_ros<rosflight_msgs::msg::Error>(to_message(*fault));
    message.header.stamp = node_.now();
    errors_->publish(message);
  } else if (const auto* version = std::get_if<companion::VersionEvent>(&event)) {
    if (!version_) {
      version_ =
          rosflight_common::create_latched_publisher<std_msgs::msg::String>(node_, "version", 1);
    }
    version_->publish(to_ros<std_msgs::msg::String>(to_message(version->version)));
  }
}

}  // namespace rosflight_io
