// SPDX-License-Identifier: BSD-3-Clause
#include "messages/world_sensors.hpp"

#include <bit>
#include <cstring>

#include "messages/simulation.hpp"

namespace rosflight::messages {
namespace {

std_msgs::Header header_of(const builtin_interfaces::Time& stamp, std::string frame) {
  return {stamp, std::move(frame)};
}

std::string optical(const std::string& name) {
  return name + "_optical";
}

geometry_msgs::TransformStamped sensor_edge(const builtin_interfaces::Time& stamp,
                                            std::string parent, std::string child,
                                            const sim::Vector3& p, const sim::Quaternion& q) {
  geometry_msgs::TransformStamped out;
  out.header = header_of(stamp, std::move(parent));
  out.child_frame_id = std::move(child);
  out.transform.translation = {p.x(), p.y(), p.z()};
  out.transform.rotation = {q.x(), q.y(), q.z(), q.w()};
  return out;
}

}  // namespace

sensor_msgs::LaserScan laser_scan(const builtin_interfaces::Time& stamp, const std::string& name,
                                  const sim::ScanSample& in) {
  sensor_msgs::LaserScan out;
  out.header = header_of(stamp, name);
  const double steps = in.ranges_m.empty() ? 0.0 : static_cast<double>(in.ranges_m.size() - 1);
  out.angle_min = static_cast<float>(in.angle_min_rad);
  out.angle_max = static_cast<float>(in.angle_min_rad + steps * in.angle_step_rad);
  out.angle_increment = static_cast<float>(in.angle_step_rad);
  out.range_min = static_cast<float>(in.min_m);
  out.range_max = static_cast<float>(in.max_m);
  out.ranges = in.ranges_m;
  return out;
}

sensor_msgs::Image depth_image(const builtin_interfaces::Time& stamp, const std::string& name,
                               const sim::DepthSample& in) {
  sensor_msgs::Image out;
  out.header = header_of(stamp, optical(name));
  out.width = static_cast<std::uint32_t>(in.width_px);
  out.height = static_cast<std::uint32_t>(in.height_px);
  out.encoding = "32FC1";
  out.is_bigendian = std::endian::native == std::endian::big ? 1 : 0;
  out.step = out.width * static_cast<std::uint32_t>(sizeof(float));
  out.data.resize(in.depths_m.size() * sizeof(float));
  if (!out.data.empty()) std::memcpy(out.data.data(), in.depths_m.data(), out.data.size());
  return out;
}

sensor_msgs::CameraInfo camera_info(const builtin_interfaces::Time& stamp, const std::string& name,
                                    const sim::DepthSample& in) {
  constexpr std::size_t kPlumbBob = 5;
  const double f = in.focal_px;
  const double center_u = 0.5 * (in.width_px - 1);
  const double center_v = 0.5 * (in.height_px - 1);
  sensor_msgs::CameraInfo out;
  out.header = header_of(stamp, optical(name));
  out.width = static_cast<std::uint32_t>(in.width_px);
  out.height = static_cast<std::uint32_t>(in.height_px);
  out.distortion_model = "plumb_bob";
  out.d.assign(kPlumbBob, 0.0);
  out.k = {f, 0.0, center_u, 0.0, f, center_v, 0.0, 0.0, 1.0};
  out.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  out.p = {f, 0.0, center_u, 0.0, 0.0, f, center_v, 0.0, 0.0, 0.0, 1.0, 0.0};
  return out;
}

geometry_msgs::PoseStamped pose_message(const builtin_interfaces::Time& stamp,
                                        const sim::PoseSample& in) {
  sim::BodyState body;
  body.p_W = in.p_W;
  body.q_WB = in.q_WB;
  return pose_message(stamp, body);
}

sensor_msgs::Range range_message(const builtin_interfaces::Time& stamp, const std::string& name,
                                 const hal::RangeSample& in) {
  sensor_msgs::Range out = to_message(in);
  out.header = header_of(stamp, name);
  return out;
}

tf2_msgs::TFMessage sensor_frames(const builtin_interfaces::Time& stamp, const std::string& name,
                                  const sim::Vector3& position_B, const sim::Matrix3& R_BS) {
  const sim::Quaternion mounted = sim::Quaternion(R_BS) * kFluFromFrd.conjugate();
  // Optical x (right) is -y, y (down) -z, z (forward) x of the axes forward, left, up.
  const sim::Quaternion to_optical(0.5, -0.5, 0.5, -0.5);
  return {{sensor_edge(stamp, std::string(kBodyFrame), name, position_B, mounted),
           sensor_edge(stamp, name, optical(name), sim::Vector3::Zero(), to_optical)}};
}

}  // namespace rosflight::messages
