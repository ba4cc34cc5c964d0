// SPDX-License-Identifier: BSD-3-Clause
#include "link/detect/detecting_codec.hpp"

#include <gtest/gtest.h>

#include <random>

#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

namespace rosflight::link {
namespace {

using test::Bytes;
using test::decoded;
using test::encoded;
using Protocol = DetectingCodec::Protocol;

constexpr MavlinkCodec::Identity kFcu{1, MavlinkCodec::kFcuComponent};

TEST(DetectingCodec, SpeaksMavlinkUntilItHearsLean) {
  DetectingCodec companion;
  MavlinkCodec mavlink(kFcu);
  LeanCodec lean;
  EXPECT_EQ(companion.protocol(), Protocol::kUnknown);
  EXPECT_EQ(decoded(mavlink, encoded(companion, Heartbeat{})).size(), 1u);
  EXPECT_EQ(decoded(companion, encoded(lean, Heartbeat{})).size(), 1u);
  EXPECT_EQ(companion.protocol(), Protocol::kLean);
  const std::vector<Message> first = decoded(lean, encoded(companion, CommandRequest{10}));
  ASSERT_EQ(first.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<Heartbeat>(first[0]));
  EXPECT_EQ(std::get<CommandRequest>(first[1]).command, 10);
  EXPECT_EQ(decoded(lean, encoded(companion, CommandRequest{10})).size(), 1u);
  EXPECT_EQ(lean.counters().sequence_gaps, 0u);
  EXPECT_TRUE(decoded(mavlink, encoded(companion, Heartbeat{})).empty());
}

TEST(DetectingCodec, ItsMavlinkIsThatOfACompanion) {
  DetectingCodec companion;
  MavlinkCodec plain({1, MavlinkCodec::kCompanionComponent});
  MavlinkCodec fcu(kFcu);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(encoded(companion, Heartbeat{}), encoded(plain, Heartbeat{}));
    decoded(companion, encoded(fcu, Heartbeat{}));
  }
  EXPECT_EQ(companion.protocol(), Protocol::kMavlink);
}

TEST(DetectingCodec, NoiseDecidesNothing) {
  DetectingCodec companion;
  std::mt19937_64 random(1);
  Bytes noise(50'000);
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
  EXPECT_TRUE(decoded(companion, noise).empty());
  EXPECT_EQ(companion.protocol(), Protocol::kUnknown);
}

/// Frames of `fcu` until the companion understands; how many bytes that took.
std::size_t bytes_until_heard(DetectingCodec& companion, Codec& fcu) {
  std::size_t sent = 0;
  while (sent < 10 * DetectingCodec::kMaxBytesWithoutMessage) {
    const Bytes frame = encoded(fcu, CommandAck{1, true});
    sent += frame.size();
    if (!decoded(companion, frame).empty()) return sent;
  }
  return sent;
}

TEST(DetectingCodec, FollowsAnFcuThatWasExchanged) {
  DetectingCodec companion;
  MavlinkCodec mavlink(kFcu);
  LeanCodec lean;
  for (int round = 0; round < 2; ++round) {
    EXPECT_LE(bytes_until_heard(companion, lean),
              DetectingCodec::kMaxBytesWithoutMessage + kMaxFrameBytes);
    EXPECT_EQ(companion.protocol(), Protocol::kLean);
    EXPECT_LE(bytes_until_heard(companion, mavlink),
              DetectingCodec::kMaxBytesWithoutMessage + kMaxFrameBytes);
    EXPECT_EQ(companion.protocol(), Protocol::kMavlink);
  }
}

TEST(DetectingCodec, KeepsItsProtocolThroughNoiseBelowItsLimit) {
  DetectingCodec companion;
  LeanCodec lean;
  decoded(companion, encoded(lean, Heartbeat{}));
  for (int i = 0; i < 10; ++i) {
    decoded(companion, Bytes(DetectingCodec::kMaxBytesWithoutMessage - 100, 0xFE));
    EXPECT_EQ(decoded(companion, encoded(lean, Heartbeat{})).size(), 1u);
    EXPECT_EQ(companion.protocol(), Protocol::kLean);
  }
}

}  // namespace
}  // namespace rosflight::link
