// SPDX-License-Identifier: BSD-3-Clause
// Byte strings below were made by ROS 2 Jazzy (rclpy 7.1.6, rmw_fastrtps_cpp 8.4.3) with
// serialize_message(); padding, which that leaves unset, is written as zeros, as ours is.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "messages/link.hpp"
#include "messages/simulation.hpp"
#include "messages/utf8.hpp"

namespace rosflight::messages {
namespace {

template <class Message>
std::string hex(const Message& message) {
  CdrWriter out;
  out.begin();
  serialize(out, message);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : out.bytes()) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

const std_msgs::Header kHeader{stamp_of(1'767'225'600'900'001'000), "body"};

TEST(Cdr, RangeAsRosWritesIt) {
  auto range = to_message(link::Range{1, 1.25F, 8.0F, 0.25F});
  range.header = kHeader;
  // field_of_view is the lidar's 0.0349066 (0x3d0efa39).
  EXPECT_EQ(
      hex(range),
      "0001000000b95569e8eca43505000000626f64790001000039fa0e3d0000803e000000410000a03f00000000");
}

TEST(Cdr, WrenchAsRosWritesIt) {
  sim::Wrench wrench;
  wrench.force_B.x() = 10.5;
  wrench.torque_B.z() = -0.125;
  auto message = to_message(wrench);
  message.header = kHeader;
  EXPECT_EQ(hex(message),
            "0001000000b95569e8eca43505000000626f6479000000000000000000000000"
            "00002540000000000000000000000000000000000000000000000000000000000000000000000000"
            "0000c0bf");
}

TEST(Cdr, LogAsRosWritesIt) {
  auto log = to_message(link::Severity::kWarning, "fcu", "RC lost");
  log.stamp = stamp_of(1'000'000'002);
  EXPECT_EQ(hex(log),
            "0001000001000000020000001e0000000400000066637500080000005243206c6f737400"
            "0100000000000000010000000000000000000000");
}

TEST(Cdr, StringsHaveTheirNulAndSequencesTheirCount) {
  CdrWriter out;
  out.begin();
  out.put(std::string_view("ab"));  // sensor_msgs/ChannelFloat32(name='ab', values=[1.5, -2.0])
  out.put(std::vector<float>{1.5F, -2.0F});
  const std::vector<std::uint8_t> expected{0, 1, 0, 0, 3, 0, 0,    0,    'a', 'b', 0, 0,
                                           2, 0, 0, 0, 0, 0, 0xC0, 0x3F, 0,   0,   0, 0xC0};
  EXPECT_EQ(std::vector<std::uint8_t>(out.bytes().begin(), out.bytes().end()), expected);
  EXPECT_EQ(hex(std_msgs::String{}), "000100000100000000");
}

TEST(Cdr, ValuesOfOneSizeBehindAnotherAreAligned) {
  // CORBA 3.3 part 2, table 9.1: 1, 2, 4 and 8 octets. "a" ends at 14, the uint8 at 15.
  rosflight_log_msgs::ParamSet message;
  message.header.frame_id = "a";
  message.target_system = 7;
  message.name = "b";
  message.type = 9;
  message.value = 1.0;
  message.bits = 3;
  EXPECT_EQ(hex(message),
            "00010000"
            "0000000000000000"  // stamp
            "020000006100"      // "a"
            "0700"              // target_system, 1 byte of padding
            "020000006200"      // "b"
            "0900"
            "000000000000f03f"
            "03000000");
}

TEST(Cdr, BeginForgetsTheLastMessageAndGrowthKeepsIt) {
  CdrWriter out;
  rosflight_log_msgs::RawFrames message;
  message.data.assign(1000, 0x55);
  serialize(out, message);
  EXPECT_EQ(out.bytes().size(), 4U + 8U + 5U + 3U + 4U + 4U + 4U + 4U + 1000U);
  EXPECT_EQ(out.bytes().back(), 0x55);
  out.begin();
  EXPECT_EQ(out.bytes().size(), 4U);
}

TEST(Schema, InnerTypesFollowBehindTheirSeparator) {
  const std::string line(80, '=');
  EXPECT_EQ(geometry_msgs::Vector3Stamped::schema(),
            "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n" + line +
                "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
}

TEST(Schema, ATypeUsedTwiceIsDefinedOnce) {
  const std::string text(rosflight_msgs::SimState::schema());
  const std::string wanted = "MSG: geometry_msgs/Vector3\n";
  const std::size_t first = text.find(wanted);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find(wanted, first + 1), std::string::npos);
}

TEST(Struct, ConstantsAndDefaultsAreThoseOfTheDefinition) {
  EXPECT_EQ(rosflight_msgs::Command::IGNORE_VALUE9, 512);
  EXPECT_EQ(sensor_msgs::Imu{}.orientation.w, 1.0);
  EXPECT_EQ(rosflight_msgs::GNSS::kName, "rosflight_msgs/msg/GNSS");
}

TEST(Struct, CopyTakesEveryFieldToAnyStructWithTheSameFields) {
  struct Other {
    struct {
      struct {
        std::int32_t sec;
        std::uint32_t nanosec;
      } stamp;
      std::string frame_id;
    } header;
    float voltage, current;
  } other{};
  const rosflight_msgs::BatteryStatus from{kHeader, 14.5F, 2.25F};
  rosflight_msgs::BatteryStatus back;
  rosflight_msgs::BatteryStatus::copy(from, other);
  rosflight_msgs::BatteryStatus::copy(other, back);
  EXPECT_EQ(other.current, 2.25F);
  EXPECT_EQ(hex(back), hex(from));
}

TEST(EulerAngles, QuarterTurnsAndTheLimitOfPitch) {
  const float h = std::sqrt(0.5F);
  const auto expect = [](const std::array<double, 3>& angles, double roll, double pitch,
                         double yaw) {
    EXPECT_NEAR(angles[0], roll, 1e-6);  // Single precision in.
    EXPECT_NEAR(angles[1], pitch, 1e-6);
    EXPECT_NEAR(angles[2], yaw, 1e-6);
  };
  expect(euler_angles({h, h, 0, 0}), M_PI_2, 0, 0);
  expect(euler_angles({h, 0, 0, h}), 0, 0, M_PI_2);
  expect(euler_angles({std::cos(0.25F), 0, std::sin(0.25F), 0}), 0, 0.5, 0);
  // Slightly more than a unit quaternion must not give a NaN at pitch 90 degrees.
  EXPECT_NEAR(euler_angles({h * 1.001F, 0, h * 1.001F, 0})[1], M_PI_2, 1e-6);
}

TEST(CleanUtf8, KeepsGoodTextAndReplacesTheRest) {
  EXPECT_EQ(clean_utf8("a\tb\n\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x81"),
            "a\tb\n\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x81");
  EXPECT_EQ(clean_utf8("a\x1B[31m\r\x7F"), "a?[31m??");
  EXPECT_EQ(clean_utf8("\xC0\xAF"), "??");            // Overlong.
  EXPECT_EQ(clean_utf8("\xED\xA0\x80"), "???");       // Surrogate.
  EXPECT_EQ(clean_utf8("\xF4\x90\x80\x80"), "????");  // Past U+10FFFF.
  EXPECT_EQ(clean_utf8("\xE2\x82"), "??");            // Cut short.
  EXPECT_EQ(clean_utf8(std::string_view("ab\0cd", 5)), "ab");
}

}  // namespace
}  // namespace rosflight::messages
