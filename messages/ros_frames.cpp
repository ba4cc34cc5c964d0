// SPDX-License-Identifier: BSD-3-Clause
#include "messages/ros_frames.hpp"

#include <string>

#include "firmware/hal/samples.hpp"
#include "messages/fill.hpp"

namespace rosflight::messages {
namespace {

geometry_msgs::Quaternion message_of(const sim::Quaternion& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

geometry_msgs::Pose pose_of(const sim::Vector3& p_W, const sim::Quaternion& q_WB) {
  geometry_msgs::Pose out;
  fill(enu(p_W), out.position);
  out.orientation = message_of(q_map_base(q_WB));
  return out;
}

geometry_msgs::TransformStamped edge(const builtin_interfaces::Time& stamp, std::string_view parent,
                                     std::string_view child, const sim::Quaternion& rotation) {
  geometry_msgs::TransformStamped out;
  out.header = {stamp, std::string(parent)};
  out.child_frame_id = child;
  out.transform.rotation = message_of(rotation);
  return out;
}

template <class Three>
sim::Vector3 doubles(const Three& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Writes a covariance of three quantities into the block of a 6 by 6 matrix that starts at `first`.
void put_block(const sim::Matrix3& covariance, std::size_t first, std::array<double, 36>& out) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      out[6 * (first + row) + first + column] =
          covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
  }
}

/// Independent errors with these standard deviations, seen along other axes.
sim::Matrix3 turned(const sim::Quaternion& to_axes, const sim::Vector3& sigma) {
  const sim::Matrix3 R = to_axes.toRotationMatrix();
  return R * sigma.cwiseAbs2().asDiagonal() * R.transpose();
}

}  // namespace

tf2_msgs::TFMessage fixed_transforms(const builtin_interfaces::Time& stamp) {
  return {{edge(stamp, kMapFrame, kOdomFrame, sim::Quaternion::Identity()),
           edge(stamp, kOdomFrame, kNedFrame, kEnuFromNed),
           edge(stamp, kBodyFrame, kBaseFrame, kFluFromFrd)}};
}

void fill_transform(const builtin_interfaces::Time& stamp, const sim::BodyState& body,
                    tf2_msgs::TFMessage& out) {
  if (out.transforms.size() != 1) out.transforms = {edge(stamp, kNedFrame, kBodyFrame, body.q_WB)};
  geometry_msgs::TransformStamped& moving = out.transforms.front();
  moving.header.stamp = stamp;
  fill(body.p_W, moving.transform.translation);
  moving.transform.rotation = message_of(body.q_WB);
}

geometry_msgs::PoseStamped pose_message(const builtin_interfaces::Time& stamp,
                                        const sim::BodyState& body) {
  geometry_msgs::PoseStamped out;
  out.header = {stamp, std::string(kMapFrame)};
  out.pose = pose_of(body.p_W, body.q_WB);
  return out;
}

nav_msgs::Odometry odometry_message(const builtin_interfaces::Time& stamp,
                                    const sim::BodyState& body) {
  nav_msgs::Odometry out;
  out.header = {stamp, std::string(kOdomFrame)};
  out.child_frame_id = kBaseFrame;
  out.pose.pose = pose_of(body.p_W, body.q_WB);
  fill(flu(body.v_B), out.twist.twist.linear);
  fill(flu(body.w_B), out.twist.twist.angular);
  return out;
}

nav_msgs::Odometry odometry_message(const builtin_interfaces::Time& stamp,
                                    const rosflight_log_msgs::Estimate& in) {
  // Its numbers are rounded to single precision.
  const sim::Quaternion q_WB =
      sim::Quaternion{static_cast<double>(in.attitude[0]), static_cast<double>(in.attitude[1]),
                      static_cast<double>(in.attitude[2]), static_cast<double>(in.attitude[3])}
          .normalized();
  nav_msgs::Odometry out = odometry_message(
      stamp, sim::BodyState{doubles(in.position), q_WB, q_WB.conjugate() * doubles(in.velocity),
                            sim::Vector3::Zero()});
  put_block(turned(kEnuFromNed, doubles(in.position_sigma)), 0, out.pose.covariance);
  put_block(turned(kEnuFromNed * q_WB, doubles(in.attitude_sigma)), 3, out.pose.covariance);
  put_block(turned(kFluFromFrd * q_WB.conjugate(), doubles(in.velocity_sigma)), 0,
            out.twist.covariance);
  return out;
}

nav_msgs::Path path_message(const builtin_interfaces::Time& stamp,
                            std::span<const std::array<double, 3>> points_W) {
  nav_msgs::Path out;
  out.header = {stamp, std::string(kMapFrame)};
  for (const std::array<double, 3>& point : points_W) {
    geometry_msgs::PoseStamped pose;
    pose.header = out.header;
    fill(enu(doubles(point)), pose.pose.position);
    out.poses.push_back(std::move(pose));
  }
  return out;
}

sensor_msgs::NavSatFix fix_message(const builtin_interfaces::Time& stamp, const link::Gnss& in) {
  using Fix = sensor_msgs::NavSatFix;
  using Status = sensor_msgs::NavSatStatus;
  const auto has_position = [](hal::GnssFix fix) {
    return fix == hal::GnssFix::k2d || fix == hal::GnssFix::k3d ||
           fix == hal::GnssFix::kGnssPlusDeadReckoning;
  };
  Fix out;
  out.header = {stamp, std::string(kBaseFrame)};
  out.status.status =
      has_position(static_cast<hal::GnssFix>(in.fix)) ? Status::STATUS_FIX : Status::STATUS_NO_FIX;
  out.status.service = Status::SERVICE_GPS;
  out.latitude = in.latitude_deg;
  out.longitude = in.longitude_deg;
  out.altitude = static_cast<double>(in.height_msl_m);
  const auto variance = [](float sigma) {
    return static_cast<double>(sigma) * static_cast<double>(sigma);
  };
  out.position_covariance[0] = out.position_covariance[4] = variance(in.horizontal_accuracy_m);
  out.position_covariance[8] = variance(in.vertical_accuracy_m);
  out.position_covariance_type = Fix::COVARIANCE_TYPE_APPROXIMATED;
  return out;
}

}  // namespace rosflight::messages
