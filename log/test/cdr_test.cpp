// SPDX-License-Identifier: BSD-3-Clause
// Byte strings below were made by ROS 2 Jazzy (rclpy 7.1.6, rmw_fastrtps_cpp 8.4.3) with
// serialize_message(); padding, which that leaves unset, is written as zeros, as ours is.
#include "log/cdr.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "log/serialize.hpp"

namespace rosflight::log {
namespace {

std::string hex(Bytes bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

TEST(Cdr, StringAndSequenceAsRosWritesThem) {
  CdrWriter out;
  out.begin();
  out.put(std::string_view("ab"));  // sensor_msgs/ChannelFloat32(name='ab', values=[1.5, -2.0])
  constexpr std::array<float, 2> kValues{1.5F, -2.0F};
  out.put_sequence(std::span<const float>(kValues));
  EXPECT_EQ(hex(out.bytes()), "000100000300000061620000020000000000c03f000000c0");
}

TEST(Cdr, RangeAsRosWritesIt) {
  CdrWriter out;
  out.begin();
  serialize(out, {1'767'225'600'900'001'000, "body"}, link::Range{1, 1.25F, 8.0F, 0.25F});
  // field_of_view is the lidar's 0.0349066 (0x3d0efa39).
  EXPECT_EQ(
      hex(out.bytes()),
      "0001000000b95569e8eca43505000000626f64790001000039fa0e3d0000803e000000410000a03f00000000");
}

TEST(Cdr, WrenchAsRosWritesIt) {
  CdrWriter out;
  out.begin();
  sim::Wrench wrench;
  wrench.force_B.x() = 10.5;
  wrench.torque_B.z() = -0.125;
  serialize_wrench(out, {1'767'225'600'900'001'000, "body"}, wrench);
  EXPECT_EQ(hex(out.bytes()),
            "0001000000b95569e8eca43505000000626f6479000000000000000000000000"
            "00002540000000000000000000000000000000000000000000000000000000000000000000000000"
            "0000c0bf");
}

TEST(Cdr, LogAsRosWritesIt) {
  CdrWriter out;
  out.begin();
  serialize_text(out, 1'000'000'002, link::Severity::kWarning, "fcu", "RC lost");
  EXPECT_EQ(hex(out.bytes()),
            "0001000001000000020000001e0000000400000066637500080000005243206c6f737400"
            "0100000000000000010000000000000000000000");
}

TEST(Cdr, EveryTypeIsAlignedToItsSizeBehindTheFourBytesOfEncapsulation) {
  // CORBA 3.3 part 2, table 9.1: 1, 2, 4 and 8 octets.
  CdrWriter out;
  out.begin();
  out.put(true);
  out.put(std::uint16_t{0x0203});
  out.put(std::uint8_t{0x04});
  out.put(std::int32_t{-2});
  out.put(std::int8_t{-1});
  out.put(1.0);
  out.put(std::array<std::uint8_t, 3>{7, 8, 9});
  out.put(std::int64_t{-3});
  EXPECT_EQ(hex(out.bytes()),
            "00010000"
            "01000302"
            "04000000"
            "feffffff"
            "ff000000"
            "000000000000f03f"
            "0708090000000000"
            "fdffffffffffffff");
}

TEST(Cdr, BooleansAreOneOrZero) {
  CdrWriter out;
  out.begin();
  out.put(true);
  out.put(false);
  EXPECT_EQ(hex(out.bytes()), "000100000100");
}

TEST(Cdr, EmptyStringHasItsNulAndEmptySequenceOnlyACount) {
  CdrWriter out;
  out.begin();
  out.put(std::string_view{});
  out.put_sequence(std::span<const double>{});
  EXPECT_EQ(hex(out.bytes()),
            "00010000"
            "0100000000000000"
            "00000000");
}

TEST(Cdr, BeginForgetsTheLastMessageAndGrowthKeepsIt) {
  CdrWriter out;
  const std::vector<double> many(1000, 1.0);
  out.begin();
  out.put_sequence(std::span<const double>(many));
  EXPECT_EQ(out.bytes().size(), 4U + 8U + 8000U);
  EXPECT_EQ(hex(out.bytes().last(8)), "000000000000f03f");
  out.begin();
  EXPECT_EQ(hex(out.bytes()), "00010000");
}

}  // namespace
}  // namespace rosflight::log
