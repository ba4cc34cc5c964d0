// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

/// What every codec promises, whatever its frames look like. Instantiate with
///
///     struct Traits {
///       static SomeCodec fcu();        // the two ends of a link, fresh
///       static OtherCodec companion();
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Name, CodecContract, Traits);
namespace rosflight::link::contract {

using test::Bytes;
using test::decoded;
using test::describe;
using test::encoded;
using test::random_message;

inline constexpr std::size_t kAlternatives = std::variant_size_v<Message>;

inline void append(Bytes& to, const Bytes& from) {
  to.insert(to.end(), from.begin(), from.end());
}

inline std::vector<std::string> described(const std::vector<Message>& messages) {
  std::vector<std::string> texts;
  texts.reserve(messages.size());
  for (const Message& message : messages) texts.push_back(describe(message));
  return texts;
}

inline Message any_message(std::mt19937_64& random) {
  return random_message(1 + random() % (kAlternatives - 1), random);
}

template <class Traits>
class CodecContract : public ::testing::Test {
 protected:
  /// What the companion makes of a message of the FCU.
  static Message sent_over(const Message& message) {
    auto fcu = Traits::fcu();
    auto companion = Traits::companion();
    const std::vector<Message> messages = decoded(companion, encoded(fcu, message));
    EXPECT_EQ(messages.size(), 1u);
    return messages.empty() ? Message{} : messages.front();
  }
};
TYPED_TEST_SUITE_P(CodecContract);

TYPED_TEST_P(CodecContract, EveryMessageSurvivesTheWayThereUnchanged) {
  std::mt19937_64 random(2);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    for (int run = 0; run < 200; ++run) {
      const Message sent = random_message(index, random);
      ASSERT_EQ(describe(this->sent_over(sent)), describe(sent));
    }
  }
}

TYPED_TEST_P(CodecContract, EveryMessageSurvivesTheWayBackUnchanged) {
  std::mt19937_64 random(12);
  auto fcu = TypeParam::fcu();
  auto companion = TypeParam::companion();
  // The first thing said may be more than was asked for.
  decoded(companion, encoded(fcu, Heartbeat{}));
  decoded(fcu, encoded(companion, Heartbeat{}));
  for (int run = 0; run < 2000; ++run) {
    const Message sent = any_message(random);
    const std::vector<Message> messages = decoded(fcu, encoded(companion, sent));
    ASSERT_EQ(messages.size(), 1u);
    ASSERT_EQ(describe(messages.front()), describe(sent));
  }
}

TYPED_TEST_P(CodecContract, AFrameIsNeverLongerThanItsBuffer) {
  std::mt19937_64 random(11);
  auto fcu = TypeParam::fcu();
  for (int run = 0; run < 2000; ++run) {
    const std::size_t size = encoded(fcu, any_message(random)).size();
    ASSERT_GT(size, 0u);
    ASSERT_LE(size, kMaxFrameBytes);
  }
}

TYPED_TEST_P(CodecContract, NothingIsNotEncoded) {
  auto fcu = TypeParam::fcu();
  Frame frame;
  frame.size = 5;
  EXPECT_FALSE(fcu.encode(std::monostate{}, frame));
  EXPECT_EQ(frame.size, 0u);
  EXPECT_EQ(fcu.counters().frames_sent, 0u);
}

TYPED_TEST_P(CodecContract, AFrameMayBeSplitAnywhere) {
  std::mt19937_64 random(3);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    const Message sent = random_message(index, random);
    auto fcu = TypeParam::fcu();
    const Bytes frame = encoded(fcu, sent);
    for (std::size_t split = 1; split < frame.size(); ++split) {
      auto companion = TypeParam::companion();
      const Codec::Decoded first = companion.decode(frame.data(), split);
      EXPECT_EQ(first.consumed, split);
      EXPECT_FALSE(first.complete);
      const Codec::Decoded second = companion.decode(frame.data() + split, frame.size() - split);
      EXPECT_EQ(second.consumed, frame.size() - split);
      ASSERT_TRUE(second.complete) << index << " split at " << split;
      EXPECT_EQ(describe(companion.message()), describe(sent));
    }
  }
}

TYPED_TEST_P(CodecContract, StopsBehindTheFirstOfTwoFramesBackToBack) {
  auto fcu = TypeParam::fcu();
  Bytes bytes = encoded(fcu, Heartbeat{VehicleType::kFixedWing});
  const std::size_t first_size = bytes.size();
  append(bytes, encoded(fcu, CommandAck{3, true}));
  auto companion = TypeParam::companion();
  const Codec::Decoded first = companion.decode(bytes.data(), bytes.size());
  EXPECT_EQ(first.consumed, first_size);
  ASSERT_TRUE(first.complete);
  EXPECT_EQ(std::get<Heartbeat>(companion.message()).type, VehicleType::kFixedWing);
  const Codec::Decoded second =
      companion.decode(bytes.data() + first_size, bytes.size() - first_size);
  ASSERT_TRUE(second.complete);
  EXPECT_EQ(std::get<CommandAck>(companion.message()).command, 3);
  EXPECT_EQ(companion.counters().frames_received, 2u);
  EXPECT_EQ(companion.counters().frames_dropped, 0u);
  EXPECT_EQ(companion.counters().sequence_gaps, 0u);
}

TYPED_TEST_P(CodecContract, NoBytesAreNoMessage) {
  auto companion = TypeParam::companion();
  const Codec::Decoded result = companion.decode(nullptr, 0);
  EXPECT_EQ(result.consumed, 0u);
  EXPECT_FALSE(result.complete);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(companion.message()));
  EXPECT_EQ(companion.mismatch(), nullptr);
}

TYPED_TEST_P(CodecContract, ASingleWrongBitCostsThatFrameAndNoOther) {
  std::mt19937_64 random(4);
  for (std::size_t index = 1; index < kAlternatives; ++index) {
    auto fcu = TypeParam::fcu();
    Bytes good = encoded(fcu, random_message(index, random));
    Bytes behind;
    std::vector<std::string> expected;
    // A wrong length may claim a whole buffer: only behind that is it known to be wrong.
    while (behind.size() < 2 * kMaxFrameBytes) {
      const Message message = any_message(random);
      append(behind, encoded(fcu, message));
      expected.push_back(describe(message));
    }
    for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << (bit % 8)));
      append(bytes, behind);
      auto companion = TypeParam::companion();
      ASSERT_EQ(described(decoded(companion, bytes, 1 + bit % 50)), expected)
          << index << ' ' << bit;
    }
  }
}

TYPED_TEST_P(CodecContract, ATruncatedFrameCostsNoOther) {
  std::mt19937_64 random(5);
  auto fcu = TypeParam::fcu();
  const Bytes cut = encoded(fcu, random_message(7, random));
  const Message next = random_message(13, random);
  const Bytes whole = encoded(fcu, next);
  for (std::size_t size = 0; size < cut.size(); ++size) {
    Bytes bytes(cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(size));
    append(bytes, whole);
    append(bytes, Bytes(kMaxFrameBytes, 0));  // silence, so that any claim of the cut frame ends
    auto companion = TypeParam::companion();
    ASSERT_EQ(described(decoded(companion, bytes, 7)), std::vector{describe(next)}) << size;
  }
}

TYPED_TEST_P(CodecContract, NoiseNeitherBecomesAMessageNorHidesOne) {
  // Noise passes for a frame with a chance below 2^-16 per start byte, one byte in 256: 1e5 bytes
  // of noise give less than 6e-3 messages; the seed is fixed.
  std::mt19937_64 random(6);
  auto fcu = TypeParam::fcu();
  Bytes bytes;
  std::vector<std::string> expected;
  for (int i = 0; i < 1000; ++i) {
    for (std::uint64_t left = random() % 200; left > 0; --left) {
      bytes.push_back(static_cast<std::uint8_t>(random()));
    }
    const Message message = any_message(random);
    append(bytes, encoded(fcu, message));
    expected.push_back(describe(message));
  }
  append(bytes, Bytes(kMaxFrameBytes, 0));
  auto companion = TypeParam::companion();
  EXPECT_EQ(described(decoded(companion, bytes)), expected);
  EXPECT_EQ(companion.counters().frames_received, 1000u);
  EXPECT_EQ(companion.counters().sequence_gaps, 0u);
  EXPECT_GT(companion.counters().frames_dropped, 0u);
}

TYPED_TEST_P(CodecContract, TheResultDoesNotDependOnHowBytesAreSplit) {
  std::mt19937_64 random(7);
  auto fcu = TypeParam::fcu();
  Bytes bytes;
  for (int i = 0; i < 300; ++i) {
    Bytes piece = encoded(fcu, any_message(random));
    const std::uint8_t start = piece.front();
    if (i % 3 == 0) piece[random() % piece.size()] = static_cast<std::uint8_t>(random());
    if (i % 5 == 0) piece.resize(random() % piece.size());
    if (i % 7 == 0) piece.insert(piece.begin(), random() % 8, start);
    append(bytes, piece);
  }
  auto whole = TypeParam::companion();
  const std::vector<std::string> expected = described(decoded(whole, bytes));
  EXPECT_GT(expected.size(), 100u);
  for (std::size_t chunk = 1; chunk <= 300; ++chunk) {
    auto companion = TypeParam::companion();
    ASSERT_EQ(described(decoded(companion, bytes, chunk)), expected) << chunk;
    ASSERT_EQ(companion.counters().frames_dropped, whole.counters().frames_dropped) << chunk;
    ASSERT_EQ(companion.counters().sequence_gaps, whole.counters().sequence_gaps) << chunk;
  }
}

TYPED_TEST_P(CodecContract, NothingFollowsTheFirstNulOfAText) {
  StatusText dirty;
  dirty.text.fill('x');
  dirty.text[2] = 0;
  EXPECT_EQ(std::get<StatusText>(this->sent_over(dirty)).text, test::text<kTextLength>("xx"));
  ParamSet set;
  set.name.fill('y');
  set.name[0] = 0;
  EXPECT_EQ(std::get<ParamSet>(this->sent_over(set)).name, ParamName{});
  // Not even on the wire.
  auto one = TypeParam::fcu();
  auto other = TypeParam::fcu();
  StatusText clean;
  clean.text = test::text<kTextLength>("xx");
  EXPECT_EQ(encoded(one, dirty), encoded(other, clean));
}

TYPED_TEST_P(CodecContract, ANameMayFillItsFieldButATextAlwaysEnds) {
  ParamValue value;
  value.name = test::text<kParamNameLength>("ABCDEFGHIJKLMNOP");
  EXPECT_EQ(std::get<ParamValue>(this->sent_over(value)).name, value.name);
  Version full;
  full.text.fill('v');
  EXPECT_EQ(std::get<Version>(this->sent_over(full)).text,
            test::text<kTextLength>(std::string(49, 'v')));
}

TYPED_TEST_P(CodecContract, NotANumberPassesForTheReceiverToJudge) {
  OffboardControl control;
  control.u[3] = std::numeric_limits<float>::quiet_NaN();
  control.u[4] = -std::numeric_limits<float>::infinity();
  const auto got = std::get<OffboardControl>(this->sent_over(control));
  EXPECT_TRUE(std::isnan(got.u[3]));
  EXPECT_EQ(got.u[4], -std::numeric_limits<float>::infinity());
}

TYPED_TEST_P(CodecContract, CountsTheFramesMissingInTheSequence) {
  auto fcu = TypeParam::fcu();
  auto companion = TypeParam::companion();
  std::vector<Bytes> frames;  // frame i has number i modulo 256
  frames.reserve(700);
  for (std::size_t i = 0; i < 700; ++i) frames.push_back(encoded(fcu, CommandAck{}));
  EXPECT_EQ(fcu.counters().frames_sent, 700u);
  const auto feed = [&](std::size_t number) {
    EXPECT_EQ(decoded(companion, frames[number]).size(), 1u);
    return companion.counters().sequence_gaps;
  };
  EXPECT_EQ(feed(200), 0u);  // a peer that runs already
  EXPECT_EQ(feed(201), 0u);
  EXPECT_EQ(feed(204), 2u);
  EXPECT_EQ(feed(255), 2u + 50u);
  EXPECT_EQ(feed(256), 52u);  // wrap without a gap
  EXPECT_EQ(feed(258), 53u);  // 257 is missing ...
  EXPECT_EQ(feed(257), 52u);  // ... and comes late: urgent frames overtake
  EXPECT_EQ(feed(259), 52u);
  EXPECT_EQ(feed(386), 52u + 126u);
  EXPECT_EQ(companion.counters().frames_received, 9u);
}

TYPED_TEST_P(CodecContract, ANewSystemIdDisturbsNobody) {
  auto fcu = TypeParam::fcu();
  auto companion = TypeParam::companion();
  fcu.set_system_id(42);
  EXPECT_EQ(decoded(companion, encoded(fcu, Heartbeat{})).size(), 1u);
}

TYPED_TEST_P(CodecContract, TwoLinksInOneProcessNeverMeet) {
  auto fcu = TypeParam::fcu();
  auto other_fcu = TypeParam::fcu();
  auto companion = TypeParam::companion();
  auto other_companion = TypeParam::companion();
  const Bytes frame = encoded(fcu, CommandAck{1, true});
  const Bytes other_frame = encoded(other_fcu, CommandAck{2, true});
  for (std::size_t i = 0; i < frame.size(); ++i) {
    companion.decode(frame.data() + i, 1);
    other_companion.decode(other_frame.data() + i, 1);
  }
  EXPECT_EQ(std::get<CommandAck>(companion.message()).command, 1);
  EXPECT_EQ(std::get<CommandAck>(other_companion.message()).command, 2);
}

REGISTER_TYPED_TEST_SUITE_P(
    CodecContract, EveryMessageSurvivesTheWayThereUnchanged,
    EveryMessageSurvivesTheWayBackUnchanged, AFrameIsNeverLongerThanItsBuffer, NothingIsNotEncoded,
    AFrameMayBeSplitAnywhere, StopsBehindTheFirstOfTwoFramesBackToBack, NoBytesAreNoMessage,
    ASingleWrongBitCostsThatFrameAndNoOther, ATruncatedFrameCostsNoOther,
    NoiseNeitherBecomesAMessageNorHidesOne, TheResultDoesNotDependOnHowBytesAreSplit,
    NothingFollowsTheFirstNulOfAText, ANameMayFillItsFieldButATextAlwaysEnds,
    NotANumberPassesForTheReceiverToJudge, CountsTheFramesMissingInTheSequence,
    ANewSystemIdDisturbsNobody, TwoLinksInOneProcessNeverMeet);

}  // namespace rosflight::link::contract
