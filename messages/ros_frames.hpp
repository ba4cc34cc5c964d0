// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>
#include <string_view>

#include "link/messages.hpp"
#include "messages/frames.hpp"
#include "messages/nav_msgs.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "messages/sensor_msgs.hpp"
#include "messages/tf2_msgs.hpp"

/// Messages that ROS tools draw without knowing ROSflight, in the frames of frames.hpp. Frame
/// ids are set here.
namespace rosflight::messages {

inline constexpr std::string_view kMapFrame = "map";
inline constexpr std::string_view kOdomFrame = "odom";
inline constexpr std::string_view kBaseFrame = "base_link";
inline constexpr std::string_view kNedFrame = "NED";
inline constexpr std::string_view kBodyFrame = "body";

/// The edges of the tree that never move: map - odom - NED and body - base_link.
tf2_msgs::TFMessage fixed_transforms(const builtin_interfaces::Time& stamp);
/// The edge between them, NED - body, which is the motion itself. Keeps the memory of `out`.
void fill_transform(const builtin_interfaces::Time& stamp, const sim::BodyState& body,
                    tf2_msgs::TFMessage& out);

geometry_msgs::PoseStamped pose_message(const builtin_interfaces::Time& stamp,
                                        const sim::BodyState& body);
/// Pose in the map, velocities in base_link. Covariances are 0: a truth has none.
nav_msgs::Odometry odometry_message(const builtin_interfaces::Time& stamp,
                                    const sim::BodyState& body);
/// The same of an estimate, with covariances from its standard deviations; those of the position and
/// the velocity about the axes of the map, that of the attitude about the fixed axes of the map, both
/// turned from the axes of the filter. It has no angular velocity: 0.
nav_msgs::Odometry odometry_message(const builtin_interfaces::Time& stamp,
                                    const rosflight_log_msgs::Estimate& in);
/// Points in NED; orientations are those of the map.
nav_msgs::Path path_message(const builtin_interfaces::Time& stamp,
                            std::span<const std::array<double, 3>> points_W);
/// Latitude, longitude and height with the variances that the receiver reports.
sensor_msgs::NavSatFix fix_message(const builtin_interfaces::Time& stamp, const link::Gnss& in);

}  // namespace rosflight::messages
