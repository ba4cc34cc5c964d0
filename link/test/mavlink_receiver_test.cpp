// SPDX-License-Identifier: BSD-3-Clause
// What the receiver makes of MAVLink's own cases: lengths, unknown ids, false starts. What holds
// for every codec is in codec_contract.hpp.
#include <gtest/gtest.h>

#include "link/mavlink/checksum.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/frames.hpp"

namespace rosflight::link {
namespace {

using test::Bytes;
using test::decoded;
using test::encoded;
using test::from_hex;

constexpr MavlinkCodec::Identity kFcu{1, MavlinkCodec::kFcuComponent};
constexpr MavlinkCodec::Identity kCompanion{1, MavlinkCodec::kCompanionComponent};

/// A frame with a right checksum, whatever its payload.
Bytes frame_of(std::uint8_t id, std::uint8_t crc_extra, const Bytes& payload,
               std::uint8_t sequence = 0) {
  Bytes frame{0xFE, static_cast<std::uint8_t>(payload.size()), sequence, 1, 250, id};
  frame.insert(frame.end(), payload.begin(), payload.end());
  const std::uint16_t crc =
      mavlink::checksum_by_bytes(frame.data() + 1, frame.size() - 1, crc_extra);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

void append(Bytes& to, const Bytes& from) {
  to.insert(to.end(), from.begin(), from.end());
}

TEST(MavlinkReceiver, AFalseStartDoesNotHideTheFramesBehindIt) {
  // The header of a heartbeat that claims 255 bytes, then five good frames in calls of their own:
  // nothing can be decided until the claim is filled, and then all five must appear although they
  // came long ago.
  MavlinkCodec sender(kFcu);
  MavlinkCodec receiver(kCompanion);
  EXPECT_TRUE(decoded(receiver, from_hex("FE FF 00 01 FA 00")).empty());
  for (std::uint8_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(decoded(receiver, encoded(sender, CommandRequest{i})).empty());
  }
  const std::vector<Message> messages = decoded(receiver, Bytes(300, 0));
  ASSERT_EQ(messages.size(), 5u);
  for (std::uint8_t i = 0; i < 5; ++i) {
    EXPECT_EQ(std::get<CommandRequest>(messages[i]).command, i);
  }
  EXPECT_EQ(receiver.counters().frames_dropped, 1u);
}

TEST(MavlinkReceiver, AStartByteInPlaceOfTheLastChecksumByteStartsTheNextFrame) {
  MavlinkCodec sender(kFcu);
  Bytes bytes = encoded(sender, CommandRequest{1});
  bytes.pop_back();
  append(bytes, encoded(sender, CommandRequest{2}));
  MavlinkCodec receiver(kCompanion);
  const std::vector<Message> messages = decoded(receiver, bytes, 1);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(std::get<CommandRequest>(messages.front()).command, 2);
}

TEST(MavlinkReceiver, AStormOfStartBytesIsDroppedAndTheNextFrameTaken) {
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{5}, std::size_t{1000}}) {
    MavlinkCodec sender(kFcu);
    Bytes bytes(10'000, 0xFE);
    append(bytes, encoded(sender, CommandRequest{4}));
    // The last start bytes and the frame make a header that claims 254 bytes.
    append(bytes, Bytes(kMaxFrameBytes, 0));
    MavlinkCodec receiver(kCompanion);
    ASSERT_EQ(decoded(receiver, bytes, chunk).size(), 1u);
    EXPECT_EQ(receiver.counters().frames_dropped, 10'000u);
  }
}

TEST(MavlinkReceiver, AnUnknownIdIsDroppedEvenWithAChecksumThatFits) {
  MavlinkCodec receiver(kCompanion);
  EXPECT_TRUE(decoded(receiver, frame_of(185, 0, Bytes(12, 0))).empty());
  EXPECT_EQ(receiver.counters().frames_received, 0u);
  EXPECT_EQ(receiver.counters().frames_dropped, 1u);
}

TEST(MavlinkReceiver, AShortFrameIsExtendedWithZeros) {
  MavlinkCodec receiver(kCompanion);
  const Bytes start(8, 0x11);
  decoded(receiver, frame_of(111, 34, start));
  const auto& time = std::get<TimeSync>(receiver.message());
  EXPECT_EQ(time.tc1_ns, 0x1111111111111111);
  EXPECT_EQ(time.ts1_ns, 0);
  decoded(receiver, frame_of(193, 1, {}));
  const auto& aux = std::get<AuxCommand>(receiver.message());
  EXPECT_EQ(aux.type, AuxCommand{}.type);
  EXPECT_EQ(aux.value, AuxCommand{}.value);
}

TEST(MavlinkReceiver, ALongFrameIsCut) {
  for (const std::size_t size : {std::size_t{2}, std::size_t{255}}) {
    Bytes payload(size, 0xFE);
    payload[0] = 9;
    MavlinkCodec receiver(kCompanion);
    ASSERT_EQ(decoded(receiver, frame_of(188, 249, payload)).size(), 1u);
    EXPECT_EQ(std::get<CommandRequest>(receiver.message()).command, 9);
  }
}

TEST(MavlinkReceiver, NothingFollowsTheFirstNulOfAText) {
  Bytes payload(51, 'x');
  payload[0] = 6;
  payload[3] = 0;
  MavlinkCodec receiver(kCompanion);
  decoded(receiver, frame_of(253, 83, payload));
  EXPECT_EQ(std::get<StatusText>(receiver.message()).text, test::text<kTextLength>("xx"));

  StatusText dirty;
  dirty.text.fill('x');
  dirty.text[2] = 0;
  MavlinkCodec sender(kFcu);
  const Bytes frame = encoded(sender, dirty);
  EXPECT_EQ(Bytes(frame.begin() + 9, frame.begin() + 57), Bytes(48, 0));

  ParamSet set;
  set.name.fill('y');
  set.name[0] = 0;
  const Bytes set_frame = encoded(sender, set);
  EXPECT_EQ(Bytes(set_frame.begin() + 12, set_frame.begin() + 28), Bytes(16, 0));
}

TEST(MavlinkReceiver, ANameMayFillItsFieldButATextAlwaysEnds) {
  MavlinkCodec sender(kFcu);
  MavlinkCodec receiver(kCompanion);
  ParamValue value;
  value.name = test::text<kParamNameLength>("ABCDEFGHIJKLMNOP");
  decoded(receiver, encoded(sender, value));
  EXPECT_EQ(std::get<ParamValue>(receiver.message()).name, value.name);

  Bytes payload(50, 'v');
  decoded(receiver, frame_of(192, 134, payload));
  EXPECT_EQ(std::get<Version>(receiver.message()).text,
            test::text<kTextLength>(std::string(49, 'v')));
  Version full;
  full.text.fill('v');
  const Bytes frame = encoded(sender, full);
  EXPECT_EQ(frame[6 + 48], 'v');
  EXPECT_EQ(frame[6 + 49], 0);
}

TEST(MavlinkReceiver, ABooleanIsTrueForAnyNonZeroByte) {
  MavlinkCodec receiver(kCompanion);
  decoded(receiver, frame_of(189, 113, {1, 0x80}));
  EXPECT_TRUE(std::get<CommandAck>(receiver.message()).success);
  decoded(receiver, frame_of(189, 113, {1, 0}));
  EXPECT_FALSE(std::get<CommandAck>(receiver.message()).success);
}

}  // namespace
}  // namespace rosflight::link
