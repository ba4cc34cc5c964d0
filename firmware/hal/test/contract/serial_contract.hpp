// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "firmware/hal/roles.hpp"

/// The contract of hal::Serial. Instantiate it with
///
///     struct Traits {
///       hal::Serial& role();                      // connected, no bytes in transit
///       void deliver(const std::vector<std::uint8_t>& bytes);  // the far end sends; returns when
///                                                 // the board can read all of it
///       std::vector<std::uint8_t> sent();         // transmits everything that is queued and
///                                                 // returns what the far end received
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, SerialContract, Traits);
///
/// Before sent() is called no byte may leave the transmit queue, so that a test can fill it.
namespace rosflight::hal::contract {

template <class Traits>
class SerialContract : public ::testing::Test {
 protected:
  using Bytes = std::vector<std::uint8_t>;
  /// A frame that carries its number and length in each byte's place.
  static Bytes frame(std::size_t size, std::size_t number) {
    Bytes bytes(size);
    for (std::size_t k = 0; k < size; ++k) {
      bytes[k] = static_cast<std::uint8_t>((number * 29 + k * 7 + size) & 0xFFu);
    }
    return bytes;
  }
  bool write(const Bytes& bytes, std::uint8_t qos = Serial::kOrdinary) {
    return traits_.role().write(bytes.data(), bytes.size(), qos);
  }
  Bytes read_all(std::size_t piece) {
    Bytes all;
    Bytes buffer(piece);
    while (const std::size_t n = traits_.role().read(buffer.data(), buffer.size())) {
      EXPECT_LE(n, piece);
      all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return all;
  }
  void SetUp() override { static_cast<void>(traits_.role().open(921600, 0)); }
  Traits traits_;
};
TYPED_TEST_SUITE_P(SerialContract);

TYPED_TEST_P(SerialContract, ReadsNothingWhenNothingWaits) {
  std::array<std::uint8_t, 8> buffer{1, 2, 3, 4, 5, 6, 7, 8};
  const auto mine = buffer;
  EXPECT_EQ(this->traits_.role().read(buffer.data(), buffer.size()), 0u);
  EXPECT_EQ(buffer, mine);
}

TYPED_TEST_P(SerialContract, ReadsEveryByteOnceAndInOrderInPiecesOfAnySize) {
  for (const std::size_t piece : std::array<std::size_t, 4>{1, 7, 128, 1000}) {
    const auto bytes = this->frame(600, piece);
    this->traits_.deliver(bytes);
    EXPECT_EQ(this->read_all(piece), bytes);
    EXPECT_TRUE(this->read_all(piece).empty());
  }
}

TYPED_TEST_P(SerialContract, NeverReadsMoreThanTheCapacity) {
  this->traits_.deliver(this->frame(20, 1));
  std::array<std::uint8_t, 8> buffer{};
  buffer[5] = buffer[6] = buffer[7] = 0xEE;
  EXPECT_LE(this->traits_.role().read(buffer.data(), 5), 5u);
  EXPECT_EQ(buffer[5], 0xEE);
  EXPECT_EQ(buffer[6], 0xEE);
  EXPECT_EQ(buffer[7], 0xEE);
}

TYPED_TEST_P(SerialContract, DeliversFramesOfOneUrgencyInOrder) {
  typename TestFixture::Bytes expected;
  for (unsigned k = 0; k < 10; ++k) {
    const auto frame = this->frame(12 + k * 5, k);
    ASSERT_TRUE(this->write(frame));
    expected.insert(expected.end(), frame.begin(), frame.end());
  }
  EXPECT_EQ(this->traits_.sent(), expected);
  EXPECT_TRUE(this->traits_.sent().empty());
}

TYPED_TEST_P(SerialContract, FramesOfDifferentUrgencyArriveWhole) {
  const auto slow = this->frame(40, 1);
  const auto fast = this->frame(60, 2);
  ASSERT_TRUE(this->write(slow, Serial::kOrdinary));
  ASSERT_TRUE(this->write(fast, Serial::kUrgent));
  const auto sent = this->traits_.sent();
  ASSERT_EQ(sent.size(), slow.size() + fast.size());
  EXPECT_NE(std::search(sent.begin(), sent.end(), slow.begin(), slow.end()), sent.end());
  EXPECT_NE(std::search(sent.begin(), sent.end(), fast.begin(), fast.end()), sent.end());
}

TYPED_TEST_P(SerialContract, TakesTheLargestFrameOfTheLink) {
  constexpr std::size_t kMaxMavlink1Frame = 263;
  ASSERT_GE(this->traits_.role().writable(), kMaxMavlink1Frame);
  const auto frame = this->frame(kMaxMavlink1Frame, 3);
  ASSERT_TRUE(this->write(frame));
  EXPECT_EQ(this->traits_.sent(), frame);
}

TYPED_TEST_P(SerialContract, AFullQueueDropsWholeFramesAndSaysSo) {
  typename TestFixture::Bytes expected;
  constexpr std::size_t kFrame = 100;
  unsigned k = 0;
  for (; k < 100'000; ++k) {
    const std::size_t room = this->traits_.role().writable();
    const auto frame = this->frame(kFrame, k);
    const bool taken = this->write(frame);
    ASSERT_EQ(taken, kFrame <= room);  // what writable() says is what write() takes
    if (!taken) break;
    ASSERT_LE(this->traits_.role().writable(), room - kFrame);
    expected.insert(expected.end(), frame.begin(), frame.end());
  }
  ASSERT_LT(k, 100'000u) << "the queue is finite";
  EXPECT_EQ(this->traits_.sent(), expected);
  // And with room again it goes on.
  const auto frame = this->frame(kFrame, k);
  EXPECT_TRUE(this->write(frame));
  EXPECT_EQ(this->traits_.sent(), frame);
}

TYPED_TEST_P(SerialContract, RefusesAFrameThatNeverFits) {
  const auto giant = this->frame(this->traits_.role().writable() + 1, 1);
  EXPECT_FALSE(this->write(giant));
  EXPECT_TRUE(this->traits_.sent().empty());
}

TYPED_TEST_P(SerialContract, BothDirectionsAreIndependent) {
  const auto out = this->frame(50, 1);
  const auto in = this->frame(70, 2);
  ASSERT_TRUE(this->write(out));
  this->traits_.deliver(in);
  EXPECT_EQ(this->read_all(64), in);
  EXPECT_EQ(this->traits_.sent(), out);
}

REGISTER_TYPED_TEST_SUITE_P(SerialContract, ReadsNothingWhenNothingWaits,
                            ReadsEveryByteOnceAndInOrderInPiecesOfAnySize,
                            NeverReadsMoreThanTheCapacity, DeliversFramesOfOneUrgencyInOrder,
                            FramesOfDifferentUrgencyArriveWhole, TakesTheLargestFrameOfTheLink,
                            AFullQueueDropsWholeFramesAndSaysSo, RefusesAFrameThatNeverFits,
                            BothDirectionsAreIndependent);

}  // namespace rosflight::hal::contract
