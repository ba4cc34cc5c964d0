// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <optional>
#include <rosflight_msgs/msg/range_finder_sensor.hpp>
#include <rosflight_msgs/msg/rgb_camera.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <string>
#include <vector>

#include "viewer/holoocean/sensor_frame.hpp"

/// What HoloOcean's sensors measured as messages: those of ROSflight 2.x, which have no header, and those of sensor_msgs.
namespace rosflight_sim {

namespace holoocean = rosflight::viewer::holoocean;

rosflight_msgs::msg::RGBCamera reference_image(const holoocean::Image& image,
                                               std::int64_t stamp_ns);
/// Ray i at 360 i / n degrees to the left; -1: nothing hit, as HoloOcean has it since 2.2.
rosflight_msgs::msg::RangeFinderSensor reference_ranges(const holoocean::Ranges& ranges,
                                                        std::int64_t stamp_ns);

/// bgra8; a depth camera 32FC1 in metres (REP 118).
sensor_msgs::msg::Image image_message(const holoocean::Image& image);
/// A pinhole 90 degrees wide, without distortion; pixel centres are whole numbers.
sensor_msgs::msg::CameraInfo camera_info(int width_px, int height_px);
/// Rays around z of the frame, counter-clockwise; infinity: nothing hit (REP 117). A single ray is along x of the frame of rays.
sensor_msgs::msg::LaserScan laser_scan(const holoocean::Ranges& ranges);
/// Whether a LaserScan can have them: its rays are in one plane.
bool is_plane(const holoocean::SensorSetup& sensor);

/// Frames of a sensor, as children of `base`: NAME where it is mounted, in axes of the body (forward, left, up), and below it
/// NAME_optical of a camera (right, down, forward) or NAME_rays of a single ray that is not level. Nothing for a sensor on a
/// socket, whose place only the engine knows.
std::vector<geometry_msgs::msg::TransformStamped> sensor_frames(
    const holoocean::SensorSetup& sensor, const std::string& base, const std::string& prefix);
/// The frame of its measurements.
std::string measuring_frame(const holoocean::SensorSetup& sensor, const std::string& prefix);

}  // namespace rosflight_sim
