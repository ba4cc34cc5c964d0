// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/holoocean_messages.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/constants.hpp"

namespace rosflight_sim {
namespace {

constexpr std::int32_t kBytesPerPixel = 4;

bool is_single_ray(const holoocean::SensorSetup& sensor) {
  return sensor.type == holoocean::SensorType::kRangeFinder && sensor.rays == 1 &&
         sensor.elevation_deg != 0.0;
}

double step_rad(std::size_t rays) {
  return 2.0 * rosflight::base::kPi / static_cast<double>(rays);
}

geometry_msgs::msg::TransformStamped transform(const std::string& parent, const std::string& child,
                                               const std::array<double, 3>& p_m,
                                               const Eigen::Quaterniond& q) {
  geometry_msgs::msg::TransformStamped t;
  t.header.frame_id = parent;
  t.child_frame_id = child;
  t.transform.translation.x = p_m[0];
  t.transform.translation.y = p_m[1];
  t.transform.translation.z = p_m[2];
  t.transform.rotation.w = q.w();
  t.transform.rotation.x = q.x();
  t.transform.rotation.y = q.y();
  t.transform.rotation.z = q.z();
  return t;
}

/// Roll, pitch, yaw about fixed axes.
Eigen::Quaterniond from_degrees(const std::array<double, 3>& angles) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const double rad = rosflight::base::kRadPerDeg;
  return AngleAxisd(angles[2] * rad, Vector3d::UnitZ()) *
         AngleAxisd(angles[1] * rad, Vector3d::UnitY()) *
         AngleAxisd(angles[0] * rad, Vector3d::UnitX());
}

}  // namespace

rosflight_msgs::msg::RGBCamera reference_image(const holoocean::Image& image,
                                               std::int64_t stamp_ns) {
  rosflight_msgs::msg::RGBCamera message;
  message.timestamp = stamp_ns;
  message.width = image.width_px;
  message.height = image.height_px;
  message.channels = kBytesPerPixel;
  message.image = image.bgra;
  return message;
}

rosflight_msgs::msg::RangeFinderSensor reference_ranges(const holoocean::Ranges& ranges,
                                                        std::int64_t stamp_ns) {
  rosflight_msgs::msg::RangeFinderSensor message;
  message.timestamp = stamp_ns;
  message.count = static_cast<std::int32_t>(ranges.ranges_m.size());
  for (std::size_t i = 0; i < ranges.ranges_m.size(); ++i) {
    const float range = ranges.ranges_m[i];
    message.distances.push_back(std::isfinite(range) ? range : -1.0F);
    message.angles.push_back(
        static_cast<float>(static_cast<double>(i) * step_rad(ranges.ranges_m.size())));
  }
  return message;
}

sensor_msgs::msg::Image image_message(const holoocean::Image& image) {
  sensor_msgs::msg::Image message;
  message.width = static_cast<std::uint32_t>(image.width_px);
  message.height = static_cast<std::uint32_t>(image.height_px);
  message.step = message.width * static_cast<std::uint32_t>(kBytesPerPixel);
  if (image.type != holoocean::SensorType::kDepthCamera) {
    message.encoding = "bgra8";
    message.data = image.bgra;
    return message;
  }
  message.encoding = "32FC1";
  message.data.resize(image.bgra.size());
  std::uint8_t* at = message.data.data();
  for (int row = 0; row < image.height_px; ++row) {
    for (int column = 0; column < image.width_px; ++column, at += sizeof(float)) {
      const auto depth = static_cast<float>(holoocean::depth_m(image, column, row));
      std::memcpy(at, &depth, sizeof(depth));
    }
  }
  return message;
}

sensor_msgs::msg::CameraInfo camera_info(int width_px, int height_px) {
  const double focal_px = 0.5 * width_px;  // 90 degrees: tan 45 degrees = 1
  const double center_x = 0.5 * (width_px - 1);
  const double center_y = 0.5 * (height_px - 1);
  sensor_msgs::msg::CameraInfo info;
  info.width = static_cast<std::uint32_t>(width_px);
  info.height = static_cast<std::uint32_t>(height_px);
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {focal_px, 0.0, center_x, 0.0, focal_px, center_y, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {focal_px, 0.0, center_x, 0.0, 0.0, focal_px, center_y, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

sensor_msgs::msg::LaserScan laser_scan(const holoocean::Ranges& ranges) {
  const std::size_t rays = ranges.ranges_m.size();
  sensor_msgs::msg::LaserScan scan;
  scan.angle_increment = static_cast<float>(step_rad(rays));
  scan.angle_max = static_cast<float>(static_cast<double>(rays - 1) * step_rad(rays));
  scan.range_max = static_cast<float>(ranges.max_range_m);
  scan.ranges = ranges.ranges_m;
  return scan;
}

bool is_plane(const holoocean::SensorSetup& sensor) {
  return sensor.rays == 1 || sensor.elevation_deg == 0.0;
}

std::vector<geometry_msgs::msg::TransformStamped> sensor_frames(
    const holoocean::SensorSetup& sensor, const std::string& base, const std::string& prefix) {
  if (!sensor.socket.empty()) return {};
  std::vector<geometry_msgs::msg::TransformStamped> frames;
  const std::string mounted = prefix + sensor.name;
  frames.push_back(
      transform(prefix + base, mounted, sensor.location_m, from_degrees(sensor.rotation_deg)));
  const std::string measuring = measuring_frame(sensor, prefix);
  if (holoocean::is_camera(sensor.type)) {
    frames.push_back(transform(mounted, measuring, {}, from_degrees({-90.0, 0.0, -90.0})));
  } else if (measuring != mounted) {  // up is a negative pitch
    frames.push_back(
        transform(mounted, measuring, {}, from_degrees({0.0, -sensor.elevation_deg, 0.0})));
  }
  return frames;
}

std::string measuring_frame(const holoocean::SensorSetup& sensor, const std::string& prefix) {
  if (holoocean::is_camera(sensor.type)) return prefix + sensor.name + "_optical";
  return prefix + sensor.name + (is_single_ray(sensor) ? "_rays" : "");
}

}  // namespace rosflight_sim
