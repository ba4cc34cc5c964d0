// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/transmit_queue.hpp"

#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"

namespace rosflight::boards {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool push(TransmitQueue& queue, const Bytes& frame, std::uint8_t qos = hal::Serial::kOrdinary) {
  return queue.push(frame.data(), frame.size(), qos);
}

Bytes take(TransmitQueue& queue, std::size_t capacity) {
  Bytes bytes(capacity);
  bytes.resize(queue.take(bytes.data(), capacity));
  return bytes;
}

TEST(TransmitQueue, UrgentBeforeTimelyBeforeOrdinary) {
  TransmitQueue queue(100);
  ASSERT_TRUE(push(queue, {1, 1}, hal::Serial::kOrdinary));
  ASSERT_TRUE(push(queue, {2}, hal::Serial::kTimely));
  ASSERT_TRUE(push(queue, {3, 3, 3}, hal::Serial::kUrgent));
  ASSERT_TRUE(push(queue, {4}, hal::Serial::kUrgent));
  ASSERT_TRUE(push(queue, {5}, 77));
  EXPECT_EQ(take(queue, 100), (Bytes{3, 3, 3, 4, 2, 5, 1, 1}));
  EXPECT_TRUE(queue.empty());
}

TEST(TransmitQueue, GivesWholeFramesOnly) {
  TransmitQueue queue(100);
  ASSERT_TRUE(push(queue, {1, 1, 1}));
  ASSERT_TRUE(push(queue, {2, 2, 2}));
  EXPECT_EQ(take(queue, 5), (Bytes{1, 1, 1}));
  EXPECT_EQ(take(queue, 2), Bytes{});
  EXPECT_EQ(take(queue, 3), (Bytes{2, 2, 2}));
}

TEST(TransmitQueue, BoundsAllClassesTogether) {
  TransmitQueue queue(10);
  ASSERT_TRUE(push(queue, Bytes(6, 1), hal::Serial::kOrdinary));
  EXPECT_FALSE(push(queue, Bytes(5, 2), hal::Serial::kUrgent));
  EXPECT_EQ(queue.room(), 4u);
  EXPECT_TRUE(push(queue, Bytes(4, 3), hal::Serial::kUrgent));
  EXPECT_EQ(take(queue, 10), (Bytes{3, 3, 3, 3, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(queue.room(), 10u);
}

TEST(TransmitQueue, RefusesNothingAndTooMuch) {
  TransmitQueue queue(4096);
  EXPECT_FALSE(push(queue, {}));
  EXPECT_FALSE(push(queue, Bytes(TransmitQueue::kMaxFrame + 1)));
  EXPECT_TRUE(push(queue, Bytes(TransmitQueue::kMaxFrame)));
}

TEST(TransmitQueue, FramesOfOneByteFillItToTheBrimAgainAndAgain) {
  constexpr std::size_t kCapacity = 37;
  TransmitQueue queue(kCapacity);
  std::uint8_t next = 0;
  for (int round = 0; round < 50; ++round) {
    Bytes expected;
    for (std::size_t k = 0; k < kCapacity; ++k) {
      ASSERT_TRUE(push(queue, {next}));
      expected.push_back(next++);
    }
    ASSERT_FALSE(push(queue, {next}));
    ASSERT_EQ(take(queue, kCapacity), expected);
  }
}

TEST(TransmitQueue, ForgetsWhatItIsToldToForget) {
  TransmitQueue queue(10);
  ASSERT_TRUE(push(queue, {1, 2, 3}));
  queue.clear();
  EXPECT_EQ(queue.room(), 10u);
  EXPECT_EQ(take(queue, 10), Bytes{});
}

}  // namespace
}  // namespace rosflight::boards
