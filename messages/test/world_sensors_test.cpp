// SPDX-License-Identifier: BSD-3-Clause
#include "messages/world_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace rosflight::messages {
namespace {

const builtin_interfaces::Time kStamp{12, 345};

TEST(WorldSensors, AScanIsALaserScanWithTheSameAngles) {
  sim::ScanSample in;
  in.angle_min_rad = -0.5;
  in.angle_step_rad = 0.25;
  in.min_m = 0.1;
  in.max_m = 30.0;
  in.ranges_m = {1.0F, 2.0F, std::numeric_limits<float>::infinity(), 4.0F, 5.0F};
  const auto out = laser_scan(kStamp, "scan", in);
  EXPECT_EQ(out.header.frame_id, "scan");
  EXPECT_EQ(out.header.stamp.sec, 12);
  EXPECT_FLOAT_EQ(out.angle_min, -0.5F);
  EXPECT_FLOAT_EQ(out.angle_max, 0.5F);
  EXPECT_FLOAT_EQ(out.angle_increment, 0.25F);
  EXPECT_EQ(out.time_increment, 0.0F);  // all rays at once
  EXPECT_FLOAT_EQ(out.range_max, 30.0F);
  EXPECT_EQ(out.ranges, in.ranges_m);
  EXPECT_TRUE(out.intensities.empty());
}

TEST(WorldSensors, ADepthImageIs32FC1RowByRow) {
  sim::DepthSample in;
  in.width_px = 3;
  in.height_px = 2;
  in.focal_px = 4.0;
  in.depths_m = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.5F};
  const auto out = depth_image(kStamp, "depth", in);
  EXPECT_EQ(out.header.frame_id, "depth_optical");
  EXPECT_EQ(out.encoding, "32FC1");
  EXPECT_EQ(out.step, 12U);
  ASSERT_EQ(out.data.size(), 24U);
  float last = 0.0F;
  std::memcpy(&last, &out.data[out.step + 8], sizeof(last));
  EXPECT_EQ(last, 6.5F);
}

TEST(WorldSensors, CameraInfoProjectsThePixelsBackToTheirRays) {
  // A point at (x, y, z) of the optical frame is seen at u = f x/z + c_u: depth_camera.hpp (1) solved for u.
  sim::DepthSample in;
  in.width_px = 64;
  in.height_px = 48;
  in.focal_px = 32.0;
  const auto info = camera_info(kStamp, "depth", in);
  const double u = info.k[0] * (1.5 / 2.0) + info.k[2];
  EXPECT_NEAR((u - 31.5) / 32.0, 0.75, 1e-12);
  EXPECT_EQ(info.k[4], 32.0);
  EXPECT_EQ(info.k[5], 23.5);
  EXPECT_EQ(info.p[0], info.k[0]);
  EXPECT_EQ(info.p[6], info.k[5]);
  EXPECT_EQ(info.d.size(), 5U);
}

TEST(WorldSensors, APoseIsThatOfBaseLinkInTheMap) {
  // 3 m north, 1 m east, 2 m up, nose east: in the map (1, 3, 2), and base_link has the axes of the map.
  sim::PoseSample in;
  in.p_W = {3.0, 1.0, -2.0};
  in.q_WB = sim::Quaternion(Eigen::AngleAxisd(std::acos(0.0), sim::Vector3::UnitZ()));
  const auto out = pose_message(kStamp, in);
  EXPECT_EQ(out.header.frame_id, "map");
  EXPECT_EQ(out.pose.position.x, 1.0);
  EXPECT_EQ(out.pose.position.y, 3.0);
  EXPECT_EQ(out.pose.position.z, 2.0);
  EXPECT_NEAR(std::abs(out.pose.orientation.w), 1.0, 1e-12);
}

sim::Quaternion rotation_of(const geometry_msgs::TransformStamped& edge) {
  const auto& q = edge.transform.rotation;
  return {q.w, q.x, q.y, q.z};
}

TEST(WorldSensors, FramesAreForwardLeftUpAndRightDownForward) {
  // Mounted as the body is: x of NAME is the body's front, y its left; z of the optical frame is the front.
  const auto level = sensor_frames(kStamp, "depth", {0.3, 0.0, 0.1}, sim::Matrix3::Identity());
  ASSERT_EQ(level.transforms.size(), 2U);
  EXPECT_EQ(level.transforms[0].header.frame_id, "body");
  EXPECT_EQ(level.transforms[0].child_frame_id, "depth");
  EXPECT_EQ(level.transforms[1].header.frame_id, "depth");
  EXPECT_EQ(level.transforms[1].child_frame_id, "depth_optical");
  EXPECT_EQ(level.transforms[0].transform.translation.x, 0.3);
  const sim::Quaternion mounted = rotation_of(level.transforms[0]);
  EXPECT_TRUE((mounted * sim::Vector3::UnitY()).isApprox(sim::Vector3(0.0, -1.0, 0.0), 1e-12));
  const sim::Quaternion optical = mounted * rotation_of(level.transforms[1]);
  EXPECT_TRUE((optical * sim::Vector3::UnitX()).isApprox(sim::Vector3(0.0, 1.0, 0.0), 1e-12));
  EXPECT_TRUE((optical * sim::Vector3::UnitY()).isApprox(sim::Vector3(0.0, 0.0, 1.0), 1e-12));
  EXPECT_TRUE((optical * sim::Vector3::UnitZ()).isApprox(sim::Vector3(1.0, 0.0, 0.0), 1e-12));
}

TEST(WorldSensors, EachSampleHasItsTopics) {
  const auto topics = [](const sim::WorldSample& sample) {
    std::string all;
    put_sample(kStamp, "eye", sample, [&](const std::string& topic, const auto& message) {
      using Message = std::decay_t<decltype(message)>;
      all += topic + " " + std::string(Message::kName) + ";";
    });
    return all;
  };
  EXPECT_EQ(topics(sim::ScanSample{}), "eye/scan sensor_msgs/msg/LaserScan;");
  EXPECT_EQ(topics(sim::DepthSample{}),
            "eye/image_raw sensor_msgs/msg/Image;eye/camera_info sensor_msgs/msg/CameraInfo;");
  EXPECT_EQ(topics(sim::PoseSample{}), "eye/pose geometry_msgs/msg/PoseStamped;");
  EXPECT_EQ(topics(hal::RangeSample{}), "eye/range sensor_msgs/msg/Range;");
}

}  // namespace
}  // namespace rosflight::messages
