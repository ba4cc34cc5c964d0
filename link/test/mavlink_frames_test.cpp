// SPDX-License-Identifier: BSD-3-Clause
// Frames and constants of ROSflight 2.x, release 2.0.1: what its own generated code and pymavlink
// both produce.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <map>

#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/frames.hpp"

namespace rosflight::link {
namespace {

using test::Bytes;
using test::decoded;
using test::encoded;
using test::from_hex;
using test::text;
using test::to_hex;

constexpr MavlinkCodec::Identity kFcu{1, MavlinkCodec::kFcuComponent};
constexpr MavlinkCodec::Identity kCompanion{1, MavlinkCodec::kCompanionComponent};

struct Sample {
  const char* name;
  MavlinkCodec::Identity sender;
  Message message;
  const char* frame;
};

std::vector<Sample> samples() {
  return {
      {"heartbeat of a multirotor", kFcu, Heartbeat{VehicleType::kMultirotor},
       "FE 09 00 01 FA 00 00 00 00 00 02 00 00 00 02 6F 39"},
      {"heartbeat of a companion", kCompanion, Heartbeat{},
       "FE 09 00 01 32 00 00 00 00 00 00 00 00 00 02 75 C2"},
      {"parameter list request", kCompanion, ParamRequestList{1}, "FE 02 00 01 32 15 01 00 C5 2A"},
      {"parameter SYS_ID", kFcu,
       ParamValue{text<kParamNameLength>("SYS_ID"), ParamBits{1}, ParamType::kInt32, 333, 231},
       "FE 19 00 01 00 16 01 00 00 00 4D 01 E7 00 53 59 53 5F 49 44 00 00 00 00 00 00 00 00 00 00 "
       "06 28 A2"},
      {"version command", kCompanion, CommandRequest{10}, "FE 01 00 01 32 BC 0A 45 2A"},
      {"acknowledge", kFcu, CommandAck{10, true}, "FE 02 00 01 FA BD 0A 01 79 42"},
      {"time request", kCompanion, TimeSync{0, 1'000'000'000},
       "FE 10 00 01 32 6F 00 00 00 00 00 00 00 00 00 CA 9A 3B 00 00 00 00 33 05"},
      {"status", kFcu, Status{true, false, false, 0x3DC, 0x20, 2, 3, 150},
       "FE 0B 00 01 FA BF DC 03 03 00 96 00 01 00 00 20 02 E8 6D"},
      {"offboard command", kCompanion,
       OffboardControl{2, 0x3C3, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f, 0.0f, 0.0f, 0.0f, 0.0f}},
       "FE 2B 00 01 32 B4 00 00 00 00 00 00 00 00 00 00 00 3F CD CC CC 3D CD CC 4C BE 9A 99 99 3E "
       "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 C3 03 02 AB B5"},
      {"inertial sample", kFcu,
       Imu{123'456'789, {0.0f, 0.0f, -9.80665f}, {0.01f, -0.02f, 0.03f}, 300.0f},
       "FE 24 00 01 FA B5 15 CD 5B 07 00 00 00 00 00 00 00 00 00 00 00 00 0A E8 1C C1 0A D7 23 3C "
       "0A D7 A3 BC 8F C2 F5 3C 00 00 96 43 B9 CD"},
  };
}

TEST(MavlinkFrames, EncodesTheSampleFramesByteForByte) {
  for (const Sample& sample : samples()) {
    MavlinkCodec codec(sample.sender);
    EXPECT_EQ(to_hex(encoded(codec, sample.message)), sample.frame) << sample.name;
  }
}

TEST(MavlinkFrames, DecodesTheSampleFramesAndReproducesThem) {
  for (const Sample& sample : samples()) {
    MavlinkCodec receiver(kCompanion);
    const std::vector<Message> messages = decoded(receiver, from_hex(sample.frame));
    ASSERT_EQ(messages.size(), 1u) << sample.name;
    EXPECT_EQ(messages.front().index(), sample.message.index()) << sample.name;
    MavlinkCodec again(sample.sender);
    EXPECT_EQ(to_hex(encoded(again, messages.front())), sample.frame) << sample.name;
  }
}

TEST(MavlinkFrames, DecodesTheFieldsOfAStatus) {
  MavlinkCodec codec(kCompanion);
  decoded(codec, from_hex("FE 0B 00 01 FA BF DC 03 03 00 96 00 01 00 00 20 02 E8 6D"));
  const auto& status = std::get<Status>(codec.message());
  EXPECT_TRUE(status.armed);
  EXPECT_FALSE(status.failsafe);
  EXPECT_FALSE(status.offboard);
  EXPECT_EQ(status.rc_override, 0x3DC);
  EXPECT_EQ(status.error_code, 0x20);
  EXPECT_EQ(status.control_mode, 2);
  EXPECT_EQ(status.sensor_errors, 3);
  EXPECT_EQ(status.loop_time_us, 150);
}

TEST(MavlinkFrames, DecodesTheFieldsOfAnInertialSample) {
  MavlinkCodec codec(kCompanion);
  decoded(codec, from_hex("FE 24 00 01 FA B5 15 CD 5B 07 00 00 00 00 00 00 00 00 00 00 00 00 0A E8 "
                          "1C C1 0A D7 23 3C 0A D7 A3 BC 8F C2 F5 3C 00 00 96 43 B9 CD"));
  const auto& imu = std::get<Imu>(codec.message());
  EXPECT_EQ(imu.time_boot_us, 123'456'789u);
  EXPECT_EQ(imu.accel_m_s2, (std::array<float, 3>{0.0f, 0.0f, -9.80665f}));
  EXPECT_EQ(imu.gyro_rad_s, (std::array<float, 3>{0.01f, -0.02f, 0.03f}));
  EXPECT_EQ(imu.temperature_K, 300.0f);
}

struct Layout {
  std::uint8_t id;
  std::size_t payload;
  std::uint8_t crc_extra;
  Message message;
};

std::vector<Layout> layouts() {
  return {{0, 9, 50, Heartbeat{}},
          {20, 20, 214, ParamRequestRead{}},
          {21, 2, 159, ParamRequestList{}},
          {22, 25, 220, ParamValue{}},
          {23, 23, 168, ParamSet{}},
          {31, 32, 246, Attitude{}},
          {65, 42, 118, RcChannels{}},
          {111, 16, 34, TimeSync{}},
          {180, 43, 90, OffboardControl{}},
          {181, 36, 67, Imu{}},
          {182, 12, 218, Mag{}},
          {183, 12, 206, Baro{}},
          {184, 12, 169, DiffPressure{}},
          {187, 13, 60, Range{}},
          {188, 1, 249, CommandRequest{}},
          {189, 2, 113, CommandAck{}},
          {190, 64, 181, OutputRaw{}},
          {191, 11, 12, Status{}},
          {192, 50, 134, Version{}},
          {193, 70, 1, AuxCommand{}},
          {195, 16, 65, ExternalAttitude{}},
          {196, 16, 10, HardError{}},
          {197, 66, 221, Gnss{}},
          {199, 8, 48, BatteryStatus{}},
          {253, 51, 83, StatusText{}},
          {236, 6, 164, MotorTest{}},
          {237, 2, 114, ReportRequest{}},
          {238, 69, 133, CheckResult{}},
          {239, 92, 2, Counters{}},
          {228, 7, 52, RecordRequest{}},
          {229, 77, 44, RecordPart{}}};
}

/// CRC-16/MCRF4XX bit by bit, from its definition.
std::uint16_t crc_by_bits(const Bytes& bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x8408u : 0u);
  }
  return static_cast<std::uint16_t>(crc);
}

TEST(MavlinkFrames, EveryMessageHasTheLengthAndChecksumSeedOfRelease2) {
  ASSERT_EQ(layouts().size(), std::variant_size_v<Message> - 1);
  for (const Layout& layout : layouts()) {
    MavlinkCodec codec(kFcu);
    const Bytes frame = encoded(codec, layout.message);
    ASSERT_EQ(frame.size(), layout.payload + 8) << int{layout.id};
    EXPECT_EQ(frame[1], layout.payload) << int{layout.id};
    EXPECT_EQ(frame[5], layout.id);
    Bytes covered(frame.begin() + 1, frame.end() - 2);
    covered.push_back(layout.crc_extra);
    const std::uint16_t crc = crc_by_bits(covered);
    EXPECT_EQ(frame[frame.size() - 2], crc & 0xFF) << int{layout.id};
    EXPECT_EQ(frame[frame.size() - 1], crc >> 8) << int{layout.id};
  }
}

TEST(MavlinkFrames, OnlyParametersOfAnFcuComeFromComponentZero) {
  for (const Layout& layout : layouts()) {
    MavlinkCodec fcu({7, MavlinkCodec::kFcuComponent});
    EXPECT_EQ(encoded(fcu, layout.message)[3], 7);
    EXPECT_EQ(encoded(fcu, layout.message)[4], layout.id == 22 ? 0 : 250) << int{layout.id};
    MavlinkCodec other({7, 50});
    EXPECT_EQ(encoded(other, layout.message)[4], 50) << int{layout.id};
  }
}

/// An FCU sends and understands exactly what a whole codec does, as far as its direction goes.
TEST(MavlinkFrames, AnFcuHasTheMessagesOfItsDirection) {
  int sent = 0;
  int received = 0;
  for (const Layout& layout : layouts()) {
    MavlinkCodec all(kFcu);
    MavlinkCodec fcu(kFcu, mavlink::fcu_messages());
    const Bytes frame = encoded(all, layout.message);
    Frame made;
    if (fcu.encode(layout.message, made)) {
      ++sent;
      EXPECT_EQ(Bytes(made.bytes.begin(), made.bytes.begin() + static_cast<long>(made.size)), frame)
          << int{layout.id};
    } else {
      EXPECT_EQ(made.size, 0u);
    }
    const Codec::Decoded result = fcu.decode(frame.data(), frame.size());
    EXPECT_TRUE(result.complete && result.consumed == frame.size()) << int{layout.id};
    EXPECT_EQ(fcu.counters().frames_received, 1u);
    EXPECT_EQ(fcu.counters().frames_dropped, 0u);
    if (std::holds_alternative<std::monostate>(fcu.message())) continue;
    ++received;
    EXPECT_EQ(fcu.message().index(), layout.message.index());
  }
  EXPECT_EQ(sent, 21);
  EXPECT_EQ(received, 12);
}

TEST(MavlinkFrames, ANewSystemIdHoldsFromTheNextFrame) {
  MavlinkCodec codec(kFcu);
  codec.set_system_id(42);
  EXPECT_EQ(encoded(codec, Heartbeat{})[3], 42);
}

TEST(MavlinkFrames, SequenceNumbersAreSharedByAllMessagesAndWrap) {
  MavlinkCodec codec(kFcu);
  for (unsigned i = 0; i < 600; ++i) {
    const Message message = i % 2 == 0 ? Message{Heartbeat{}} : Message{ParamValue{}};
    ASSERT_EQ(encoded(codec, message)[2], i % 256);
  }
  EXPECT_EQ(codec.counters().frames_sent, 600u);
}

TEST(MavlinkFrames, NothingIsNotEncoded) {
  MavlinkCodec codec(kFcu);
  Frame frame;
  frame.size = 5;
  EXPECT_FALSE(codec.encode(std::monostate{}, frame));
  EXPECT_EQ(frame.size, 0u);
  EXPECT_EQ(codec.counters().frames_sent, 0u);
  EXPECT_EQ(encoded(codec, Heartbeat{})[2], 0);
}

TEST(MavlinkFrames, TheCodecIsSmall) {
  EXPECT_LE(sizeof(MavlinkCodec), 450u);
}

}  // namespace
}  // namespace rosflight::link
