// SPDX-License-Identifier: BSD-3-Clause
#include "stream_publisher.hpp"

#include <utility>

namespace rosflight_io {

namespace companion = rosflight::companion;

StreamPublisher::StreamPublisher(rclcpp::Node& node, Clock& clock, std::string frame_id)
    : node_{node}, clock_{clock}, frame_id_{std::move(frame_id)} {
  const auto latched = [](std::size_t depth) { return rclcpp::QoS(depth).transient_local(); };
  unsaved_ = node.create_publisher<std_msgs::msg::Bool>("status/unsaved_params", latched(1));
  errors_ =
      node.create_publisher<rosflight_msgs::msg::Error>("status/rosflight_errors", latched(5));
  params_changed_ = node.create_publisher<std_msgs::msg::Bool>("status/params_changed", 1);
  unsaved_->publish(std_msgs::msg::Bool());
}

template <class In, class Message>
void StreamPublisher::publish(Topic<Message>& topic, const In& in, companion::Time t,
                              const std::string& frame_id) {
  if (!topic.publisher) {
    topic.publisher = node_.create_publisher<Message>(topic.name, 1);
    topic.message.header.frame_id = frame_id;
  }
  fill(in, topic.message);
  topic.message.header.stamp = clock_.to_ros(t);
  topic.publisher->publish(topic.message);
}

void StreamPublisher::on_imu(const link::Imu& m, const Stamp& stamp) {
  imu_.message.orientation = attitude_.message.attitude;
  publish(imu_, m, stamp.sample, frame_id_);
  publish(temperature_, m, stamp.sample, frame_id_);
}

void StreamPublisher::on_attitude(const link::Attitude& m, const Stamp& stamp) {
  publish(attitude_, m, stamp.sample);
  publish(euler_, m, stamp.sample);
}

void StreamPublisher::on_mag(const link::Mag& m, const Stamp& stamp) {
  publish(mag_, m, stamp.sample, frame_id_);
}

void StreamPublisher::on_baro(const link::Baro& m, const Stamp& stamp) {
  publish(baro_, m, stamp.sample);
}

void StreamPublisher::on_diff_pressure(const link::DiffPressure& m, const Stamp& stamp) {
  publish(airspeed_, m, stamp.sample);
}

void StreamPublisher::on_range(const link::Range& m, const Stamp& stamp) {
  publish(range_, m, stamp.sample);
}

void StreamPublisher::on_rc(const link::RcChannels& m, const Stamp& stamp) {
  publish(rc_, m, stamp.sample);
}

void StreamPublisher::on_output(const link::OutputRaw& m, const Stamp& stamp) {
  publish(output_, m, stamp.sample);
}

void StreamPublisher::on_gnss(const link::Gnss& m, const Stamp& stamp) {
  publish(gnss_, m, stamp.sample, "NED");
}

void StreamPublisher::on_battery(const link::BatteryStatus& m, const Stamp& stamp) {
  publish(battery_, m, stamp.sample);
}

void StreamPublisher::on_status(const link::Status& m, const Stamp& stamp) {
  publish(status_, m, stamp.arrival);
}

void StreamPublisher::on_event(const companion::Event& event) {
  if (const auto* unsaved = std::get_if<companion::UnsavedEvent>(&event)) {
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
    rosflight_msgs::msg::Error message;
    fill(*fault, message);
    message.header.stamp = node_.now();
    errors_->publish(message);
  } else if (const auto* version = std::get_if<companion::VersionEvent>(&event)) {
    if (!version_) {
      version_ = node_.create_publisher<std_msgs::msg::String>("version",
                                                               rclcpp::QoS(1).transient_local());
    }
    std_msgs::msg::String message;
    message.data = std::string(companion::text_of(version->version.text));
    version_->publish(message);
  }
}

}  // namespace rosflight_io
