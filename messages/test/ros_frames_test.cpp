// SPDX-License-Identifier: BSD-3-Clause
#include "messages/ros_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.hpp"

namespace rosflight::messages {
namespace {

using sim::Quaternion;
using sim::Vector3;

/// Yaw, pitch, roll in degrees: body to NED.
Quaternion attitude(double yaw_deg, double pitch_deg, double roll_deg) {
  const auto about = [](double deg, const Vector3& axis) {
    return Quaternion(Eigen::AngleAxisd(deg * base::kRadPerDeg, axis));
  };
  return about(yaw_deg, Vector3::UnitZ()) * about(pitch_deg, Vector3::UnitY()) *
         about(roll_deg, Vector3::UnitX());
}

TEST(RosFrames, VectorsTurnAsQuaternionsDo) {
  const Vector3 v{1.5, -2.5, 3.5};
  EXPECT_TRUE((kEnuFromNed * v).isApprox(enu(v), 1e-15));
  EXPECT_TRUE((kFluFromFrd * v).isApprox(flu(v), 1e-15));
}

// REP-103: yaw 0 looks east, positive turns left; pitch is positive nose down.
TEST(RosFrames, HeadingAndTiltAreThoseOfRep103) {
  const auto look = [](const Quaternion& q_WB, const Vector3& v) {
    return Vector3(q_map_base(q_WB) * v);
  };
  EXPECT_TRUE(
      look(attitude(0, 0, 0), Vector3::UnitX()).isApprox(Vector3::UnitY(), 1e-12));     // north
  EXPECT_TRUE(q_map_base(attitude(90, 0, 0)).isApprox(Quaternion::Identity(), 1e-12));  // east
  EXPECT_TRUE(look(attitude(90, 0, 0), Vector3::UnitY()).isApprox(Vector3::UnitY(), 1e-12));
  EXPECT_GT(look(attitude(30, 20, 0), Vector3::UnitX()).z(), 0.3);  // nose up
  EXPECT_GT(look(attitude(30, 0, 20), Vector3::UnitY()).z(), 0.3);  // right wing down, left up
}

TEST(RosFrames, TheTreeLeadsFromTheMapToTheBody) {
  const sim::BodyState body{{3.0, 4.0, -5.0}, attitude(30, 10, 5), {}, {}};
  tf2_msgs::TFMessage moving;
  fill_transform({}, body, moving);
  const tf2_msgs::TFMessage fixed = fixed_transforms({});
  Vector3 nose{1.0, 0.0, 0.0};  // in base_link
  Vector3 left{0.0, 1.0, 0.0};
  std::string frame{kBaseFrame};
  for (const char* parent : {"body", "NED", "odom", "map"}) {
    const geometry_msgs::TransformStamped* edge = &moving.transforms.front();
    for (const auto& one : fixed.transforms) {
      if (one.child_frame_id == frame) edge = &one;
    }
    ASSERT_EQ(edge->child_frame_id, frame);
    ASSERT_EQ(edge->header.frame_id, parent);
    const auto& t = edge->transform;
    const Quaternion q{t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z};
    const Vector3 p{t.translation.x, t.translation.y, t.translation.z};
    nose = q * nose + p;
    left = q * left + p;
    frame = parent;
  }
  const auto pose = pose_message({}, body).pose;
  const Vector3 p_map{pose.position.x, pose.position.y, pose.position.z};
  EXPECT_EQ(p_map, Vector3(4.0, 3.0, 5.0));
  EXPECT_TRUE((nose - p_map).isApprox(q_map_base(body.q_WB) * Vector3::UnitX(), 1e-12));
  EXPECT_TRUE((left - p_map).isApprox(q_map_base(body.q_WB) * Vector3::UnitY(), 1e-12));
}

TEST(RosFrames, OdometryOfAnEstimateTurnsItsCovariances) {
  rosflight_log_msgs::Estimate in;
  in.position = {1.0F, 2.0F, -3.0F};
  in.velocity = {0.0F, 4.0F, -1.0F};  // east and up
  in.attitude = {static_cast<float>(kHalfSqrt2), 0.0F, 0.0F,
                 static_cast<float>(kHalfSqrt2)};  // nose east
  in.position_sigma = {0.5F, 0.25F, 2.0F};
  in.velocity_sigma = {0.125F, 0.5F, 1.0F};
  in.attitude_sigma = {0.25F, 0.5F, 1.0F};
  const nav_msgs::Odometry out = odometry_message({}, in);
  EXPECT_NEAR(out.twist.twist.linear.x, 4.0, 1e-6);  // forward
  EXPECT_NEAR(out.twist.twist.linear.z, 1.0, 1e-6);
  const auto diagonal = [](const std::array<double, 36>& c, std::size_t k) { return c[7 * k]; };
  EXPECT_NEAR(diagonal(out.pose.covariance, 0), 0.0625, 1e-6);  // east
  EXPECT_NEAR(diagonal(out.pose.covariance, 1), 0.25, 1e-6);
  EXPECT_NEAR(diagonal(out.pose.covariance, 2), 4.0, 1e-6);
  EXPECT_NEAR(diagonal(out.pose.covariance, 3), 0.0625, 1e-6);  // roll is about east here
  EXPECT_NEAR(diagonal(out.pose.covariance, 4), 0.25, 1e-6);
  EXPECT_NEAR(diagonal(out.twist.covariance, 0), 0.25, 1e-6);  // forward is east
  EXPECT_NEAR(diagonal(out.twist.covariance, 1), 1.0 / 64.0, 1e-6);
  EXPECT_NEAR(out.pose.covariance[1], 0.0, 1e-6);
}

TEST(RosFrames, OnlyAPositionIsAFix) {
  link::Gnss in;
  in.horizontal_accuracy_m = 1.5F;
  in.vertical_accuracy_m = 3.0F;
  const std::array<std::int8_t, 6> wanted{-1, -1, 0, 0, 0, -1};
  for (std::uint8_t kind = 0; kind < wanted.size(); ++kind) {
    in.fix = kind;
    EXPECT_EQ(fix_message({}, in).status.status, wanted[kind]) << int{kind};
  }
  EXPECT_EQ(fix_message({}, in).position_covariance[4], 2.25);
  EXPECT_EQ(fix_message({}, in).position_covariance[8], 9.0);
}

}  // namespace
}  // namespace rosflight::messages
