// SPDX-License-Identifier: BSD-3-Clause
// What the receiver makes of bytes: whole, split, damaged, foreign and hostile.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "link/mavlink/checksum.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

namespace rosflight::link {
namespace {

using test::Bytes;
using test::decoded;
using test::describe;
using test::encoded;
using test::from_hex;
using test::random_message;

constexpr MavlinkCodec::Identity kFcu{1, MavlinkCodec::kFcuComponent};
constexpr MavlinkCodec::Identity kCompanion{1, MavlinkCodec::kCompanionComponent};
constexpr std::size_t kAlternatives = std::variant_size_v<Message>;

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

std::vector<std::string> described(const std::vector<Message>& messages) {
  std::vector<std::string> texts;
  texts.reserve(messages.size());
  for (const Message& message : messages) texts.push_back(describe(message));
  return texts;
}

TEST(MavlinkReceiver, EveryMessageSurvivesTheWayThereUnchanged) {
  std::mt19937_64 random(2);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    for (int run = 0; run < 200; ++run) {
      const Message sent = random_message(index, random);
      MavlinkCodec sender(run % 2 == 0 ? kFcu : kCompanion);
      MavlinkCodec receiver(kCompanion);
      const std::vector<Message> messages = decoded(receiver, encoded(sender, sent));
      ASSERT_EQ(messages.size(), 1u);
      ASSERT_EQ(describe(messages.front()), describe(sent));
    }
  }
}

TEST(MavlinkReceiver, AFrameMayBeSplitAnywhere) {
  std::mt19937_64 random(3);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    const Message sent = random_message(index, random);
    MavlinkCodec sender(kFcu);
    const Bytes frame = encoded(sender, sent);
    for (std::size_t split = 1; split < frame.size(); ++split) {
      MavlinkCodec receiver(kCompanion);
      const Codec::Decoded first = receiver.decode(frame.data(), split);
      EXPECT_EQ(first.consumed, split);
      EXPECT_FALSE(first.complete);
      const Codec::Decoded second = receiver.decode(frame.data() + split, frame.size() - split);
      EXPECT_EQ(second.consumed, frame.size() - split);
      ASSERT_TRUE(second.complete) << index << " split at " << split;
      EXPECT_EQ(describe(receiver.message()), describe(sent));
    }
  }
}

TEST(MavlinkReceiver, StopsBehindTheFirstOfTwoFramesBackToBack) {
  MavlinkCodec sender(kFcu);
  Bytes bytes = encoded(sender, Heartbeat{VehicleType::kFixedWing});
  const std::size_t first_size = bytes.size();
  append(bytes, encoded(sender, CommandAck{3, true}));
  MavlinkCodec receiver(kCompanion);
  const Codec::Decoded first = receiver.decode(bytes.data(), bytes.size());
  EXPECT_EQ(first.consumed, first_size);
  ASSERT_TRUE(first.complete);
  EXPECT_EQ(std::get<Heartbeat>(receiver.message()).type, VehicleType::kFixedWing);
  const Codec::Decoded second =
      receiver.decode(bytes.data() + first_size, bytes.size() - first_size);
  ASSERT_TRUE(second.complete);
  EXPECT_EQ(std::get<CommandAck>(receiver.message()).command, 3);
  EXPECT_EQ(receiver.counters().frames_received, 2u);
  EXPECT_EQ(receiver.counters().frames_dropped, 0u);
  EXPECT_EQ(receiver.counters().sequence_gaps, 0u);
}

TEST(MavlinkReceiver, NoBytesAreNoMessage) {
  MavlinkCodec receiver(kCompanion);
  const Codec::Decoded result = receiver.decode(nullptr, 0);
  EXPECT_EQ(result.consumed, 0u);
  EXPECT_FALSE(result.complete);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(receiver.message()));
}

TEST(MavlinkReceiver, ASingleWrongBitCostsThatFrameAndNoOther) {
  std::mt19937_64 random(4);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    MavlinkCodec sender(kFcu);
    Bytes good = encoded(sender, random_message(index, random));
    Bytes behind;
    std::vector<std::string> expected;
    // A wrong length byte can claim 255 bytes: only behind them is it known to be wrong.
    while (behind.size() < 2 * kMaxFrameBytes) {
      const Message message = random_message(1 + random() % (kAlternatives - 1), random);
      append(behind, encoded(sender, message));
      expected.push_back(describe(message));
    }
    for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << (bit % 8)));
      append(bytes, behind);
      MavlinkCodec receiver(kCompanion);
      ASSERT_EQ(described(decoded(receiver, bytes, 1 + bit % 50)), expected) << index << ' ' << bit;
    }
  }
}

TEST(MavlinkReceiver, ATruncatedFrameCostsNoOther) {
  std::mt19937_64 random(5);
  MavlinkCodec sender(kFcu);
  const Bytes cut = encoded(sender, random_message(7, random));
  const Message next = random_message(13, random);
  const Bytes whole = encoded(sender, next);
  for (std::size_t size = 0; size < cut.size(); ++size) {
    Bytes bytes(cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(size));
    append(bytes, whole);
    append(bytes, Bytes(kMaxFrameBytes, 0));  // silence, so that the claim of the cut frame ends
    MavlinkCodec receiver(kCompanion);
    ASSERT_EQ(described(decoded(receiver, bytes, 7)), std::vector{describe(next)}) << size;
  }
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

TEST(MavlinkReceiver, NoiseNeitherBecomesAMessageNorHidesOne) {
  // The chance that noise passes for a frame is 25/256 (known id) x 2^-16 per start byte, so 1e5
  // bytes of noise give 6e-4 messages; the seed is fixed.
  std::mt19937_64 random(6);
  MavlinkCodec sender(kFcu);
  Bytes bytes;
  std::vector<std::string> expected;
  for (int i = 0; i < 1000; ++i) {
    for (std::uint64_t left = random() % 200; left > 0; --left) {
      bytes.push_back(static_cast<std::uint8_t>(random()));
    }
    const Message message = random_message(1 + random() % (kAlternatives - 1), random);
    append(bytes, encoded(sender, message));
    expected.push_back(describe(message));
  }
  append(bytes, Bytes(kMaxFrameBytes, 0));
  MavlinkCodec receiver(kCompanion);
  EXPECT_EQ(described(decoded(receiver, bytes)), expected);
  EXPECT_EQ(receiver.counters().frames_received, 1000u);
  EXPECT_EQ(receiver.counters().sequence_gaps, 0u);
}

TEST(MavlinkReceiver, TheResultDoesNotDependOnHowBytesAreSplit) {
  std::mt19937_64 random(7);
  MavlinkCodec sender(kFcu);
  Bytes bytes;
  for (int i = 0; i < 300; ++i) {
    Bytes piece = encoded(sender, random_message(1 + random() % (kAlternatives - 1), random));
    if (i % 3 == 0) piece[random() % piece.size()] = static_cast<std::uint8_t>(random());
    if (i % 5 == 0) piece.resize(random() % piece.size());
    if (i % 7 == 0) piece.insert(piece.begin(), random() % 8, 0xFE);
    append(bytes, piece);
  }
  MavlinkCodec whole(kCompanion);
  const std::vector<std::string> expected = described(decoded(whole, bytes));
  EXPECT_GT(expected.size(), 100u);
  for (std::size_t chunk = 1; chunk <= 300; ++chunk) {
    MavlinkCodec receiver(kCompanion);
    ASSERT_EQ(described(decoded(receiver, bytes, chunk)), expected) << chunk;
    ASSERT_EQ(receiver.counters().frames_dropped, whole.counters().frames_dropped) << chunk;
    ASSERT_EQ(receiver.counters().sequence_gaps, whole.counters().sequence_gaps) << chunk;
  }
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

TEST(MavlinkReceiver, NotANumberPassesForTheReceiverToJudge) {
  MavlinkCodec sender(kCompanion);
  MavlinkCodec receiver(kFcu);
  OffboardControl control;
  control.u[3] = std::numeric_limits<float>::quiet_NaN();
  control.u[4] = -std::numeric_limits<float>::infinity();
  decoded(receiver, encoded(sender, control));
  const auto& got = std::get<OffboardControl>(receiver.message());
  EXPECT_TRUE(std::isnan(got.u[3]));
  EXPECT_EQ(got.u[4], -std::numeric_limits<float>::infinity());
}

TEST(MavlinkReceiver, ABooleanIsTrueForAnyNonZeroByte) {
  MavlinkCodec receiver(kCompanion);
  decoded(receiver, frame_of(189, 113, {1, 0x80}));
  EXPECT_TRUE(std::get<CommandAck>(receiver.message()).success);
  decoded(receiver, frame_of(189, 113, {1, 0}));
  EXPECT_FALSE(std::get<CommandAck>(receiver.message()).success);
}

TEST(MavlinkReceiver, CountsTheFramesMissingInTheSequence) {
  MavlinkCodec receiver(kCompanion);
  const auto feed = [&](std::uint8_t sequence) {
    decoded(receiver, frame_of(188, 249, {0}, sequence));
    return receiver.counters().sequence_gaps;
  };
  EXPECT_EQ(feed(200), 0u);  // a peer that runs already
  EXPECT_EQ(feed(201), 0u);
  EXPECT_EQ(feed(204), 2u);
  EXPECT_EQ(feed(255), 2u + 50u);
  EXPECT_EQ(feed(0), 52u);  // wrap without a gap
  EXPECT_EQ(feed(2), 53u);  // 1 is missing ...
  EXPECT_EQ(feed(1), 52u);  // ... and comes late: urgent frames overtake
  EXPECT_EQ(feed(3), 52u);
  EXPECT_EQ(feed(130), 52u + 126u);
}

}  // namespace
}  // namespace rosflight::link
