// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "messages/ros_frames.hpp"
#include "messages/sensor_msgs.hpp"
#include "sim/world_sensors/samples.hpp"

/// Samples of sensors of the world as standard messages. NAME is the sensor's; its frames are NAME, mounted in axes of
/// base_link (x forward, y left, z up), and of a camera NAME_optical (x right, y down, z forward; REP 103).
namespace rosflight::messages {

/// Angles about z of the frame NAME, counter-clockwise (REP 117: -inf too near, +inf nothing, NaN no reading).
sensor_msgs::LaserScan laser_scan(const builtin_interfaces::Time& stamp, const std::string& name,
                                  const sim::ScanSample& in);
/// 32FC1 in metres (REP 118), frame NAME_optical.
sensor_msgs::Image depth_image(const builtin_interfaces::Time& stamp, const std::string& name,
                               const sim::DepthSample& in);
/// A pinhole without distortion whose pixel centres are whole numbers.
sensor_msgs::CameraInfo camera_info(const builtin_interfaces::Time& stamp, const std::string& name,
                                    const sim::DepthSample& in);
/// Pose of base_link in the frame map (x east, y north, z up).
geometry_msgs::PoseStamped pose_message(const builtin_interfaces::Time& stamp,
                                        const sim::PoseSample& in);
/// Along x of the frame NAME.
sensor_msgs::Range range_message(const builtin_interfaces::Time& stamp, const std::string& name,
                                 const hal::RangeSample& in);

/// Frames of a mounted sensor below `body`. @param R_BS  axes of the sensor, front-right-down, to those of the body.
tf2_msgs::TFMessage sensor_frames(const builtin_interfaces::Time& stamp, const std::string& name,
                                  const sim::Vector3& position_B, const sim::Matrix3& R_BS);

/// Calls `put(topic, message)` for each message of a sample: NAME/scan, NAME/image_raw and NAME/camera_info, NAME/pose or
/// NAME/range, without a leading slash.
template <class Put>
void put_sample(const builtin_interfaces::Time& stamp, const std::string& name,
                const sim::WorldSample& sample, Put&& put) {
  if (const auto* scan = std::get_if<sim::ScanSample>(&sample)) {
    put(name + "/scan", laser_scan(stamp, name, *scan));
  } else if (const auto* image = std::get_if<sim::DepthSample>(&sample)) {
    put(name + "/image_raw", depth_image(stamp, name, *image));
    put(name + "/camera_info", camera_info(stamp, name, *image));
  } else if (const auto* pose = std::get_if<sim::PoseSample>(&sample)) {
    put(name + "/pose", pose_message(stamp, *pose));
  } else if (const auto* range = std::get_if<hal::RangeSample>(&sample)) {
    put(name + "/range", range_message(stamp, name, *range));
  }
}

/// Time of measurement of a sample.
inline sim::Time measured_at(const sim::WorldSample& sample) {
  return std::visit([](const auto& one) { return one.stamp; }, sample);
}

}  // namespace rosflight::messages
