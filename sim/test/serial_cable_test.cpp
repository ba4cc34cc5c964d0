// SPDX-License-Identifier: BSD-3-Clause
#include "sim/serial_cable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace rosflight::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint8_t kUrgentQos = 0;
constexpr std::uint8_t kTimelyQos = 100;
constexpr std::uint8_t kOrdinaryQos = 255;

RandomStream stream() {
  return RandomSource{1}.stream("cable");
}

Bytes counting(std::size_t size, int start = 0) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::uint8_t>(start + static_cast<int>(i));
  return bytes;
}

bool push(SerialLine& line, std::int64_t t_us, const Bytes& bytes,
          std::uint8_t qos = kOrdinaryQos) {
  return line.push(Time{t_us}, bytes.data(), bytes.size(), qos);
}

Bytes pop(SerialLine& line, std::int64_t t_us) {
  Bytes bytes(100'000);
  bytes.resize(line.pop(Time{t_us}, bytes.data(), bytes.size()));
  return bytes;
}

TEST(SerialLine, BytesArriveWhenTheirLastBitIsThrough) {
  SerialLine line({}, stream());
  ASSERT_TRUE(push(line, 1000, counting(200)));
  // Byte n (from 1) of 10 bits at 921600 baud is there after n * 10.8507 us.
  std::size_t arrived = 0;
  for (std::int64_t t = 1000; t < 1000 + 2200; ++t) {
    arrived += pop(line, t).size();
    const auto expected = static_cast<std::size_t>((t - 1000) * 92160 / 1'000'000);
    ASSERT_EQ(arrived, std::min<std::size_t>(expected, 200)) << "at " << t;
  }
  EXPECT_EQ(arrived, 200U);
}

TEST(SerialLine, OtherFormatsHaveOtherByteTimes) {
  // 57 600 baud with parity and two stop bits: 12 bits, 208.33 us.
  SerialLine line({.baud = 57600, .frame_bits = 12}, stream());
  push(line, 0, counting(3));
  EXPECT_EQ(pop(line, 208).size(), 0U);
  EXPECT_EQ(pop(line, 209).size(), 1U);
  EXPECT_EQ(pop(line, 416).size(), 0U);
  EXPECT_EQ(pop(line, 417).size(), 1U);
  EXPECT_EQ(pop(line, 625).size(), 1U);
}

TEST(SerialLine, ThroughputIsExactForEver) {
  SerialLine line({}, stream());
  std::uint64_t received = 0;
  const Bytes frame = counting(100);
  constexpr std::int64_t kSeconds = 10;
  for (std::int64_t t = 0; t <= kSeconds * 1'000'000; t += 2500) {
    while (line.writable() >= frame.size()) push(line, t, frame);
    received += pop(line, t).size();
  }
  EXPECT_EQ(received, kSeconds * 92160U);
}

TEST(SerialLine, LengthOfTheStepsDoesNotMatter) {
  SerialLine fine({}, stream());
  SerialLine coarse({}, stream());
  push(fine, 0, counting(250));
  push(coarse, 0, counting(250));
  std::size_t in_small_steps = 0;
  for (std::int64_t t = 0; t <= 1999; t += 7) in_small_steps += pop(fine, t).size();
  in_small_steps += pop(fine, 1999).size();
  EXPECT_EQ(in_small_steps, pop(coarse, 1999).size());
}

TEST(SerialLine, AnIdleWireStartsWhenSomethingIsPushed) {
  SerialLine line({}, stream());
  push(line, 0, counting(1));
  EXPECT_EQ(pop(line, 500).size(), 1U);
  push(line, 505, counting(1));
  EXPECT_EQ(pop(line, 515).size(), 0U);
  EXPECT_EQ(pop(line, 516).size(), 1U);
}

TEST(SerialLine, KeepsBytesAndOrderAcrossTheRingsEnd) {
  SerialLine line({.transmit_capacity_bytes = {64, 64, 64}, .receive_capacity_bytes = 50},
                  stream());
  Bytes sent;
  Bytes received;
  std::int64_t t = 0;
  for (int i = 0; i < 200; ++i) {
    const Bytes frame = counting(static_cast<std::size_t>(1 + i % 37), i);
    t += 500;
    ASSERT_TRUE(push(line, t, frame));
    sent.insert(sent.end(), frame.begin(), frame.end());
    const Bytes got = pop(line, t);
    received.insert(received.end(), got.begin(), got.end());
  }
  const Bytes rest = pop(line, t + 10'000);
  received.insert(received.end(), rest.begin(), rest.end());
  EXPECT_EQ(received, sent);
  EXPECT_EQ(line.counters().frames_sent, 200U);
}

TEST(SerialLine, UrgentFramesOvertakeButNeverSplit) {
  SerialLine line({}, stream());
  push(line, 0, Bytes(10, 'a'), kOrdinaryQos);
  push(line, 0, Bytes(10, 'b'), kOrdinaryQos);
  push(line, 50, Bytes(3, 'T'), kTimelyQos);
  push(line, 50, Bytes(3, 'U'), kUrgentQos);
  push(line, 50, Bytes(3, 'V'), 1);
  const Bytes all = pop(line, 10'000);
  EXPECT_EQ(std::string(all.begin(), all.end()), "aaaaaaaaaaUUUTTTVVVbbbbbbbbbb");
}

TEST(SerialLine, AFrameThatDoesNotFitItsClassIsDroppedWholeAndCounted) {
  SerialLine line({.transmit_capacity_bytes = {20, 20, 50}}, stream());
  EXPECT_EQ(line.writable(), 50U);
  EXPECT_EQ(line.writable(kUrgentQos), 20U);
  EXPECT_TRUE(push(line, 0, counting(40)));
  EXPECT_EQ(line.writable(), 10U);
  EXPECT_FALSE(push(line, 0, counting(11)));
  EXPECT_TRUE(push(line, 0, counting(10)));
  EXPECT_EQ(line.writable(), 0U);
  EXPECT_TRUE(push(line, 0, counting(20), kUrgentQos));
  EXPECT_FALSE(push(line, 0, counting(1), kUrgentQos));
  EXPECT_FALSE(push(line, 0, {}, kTimelyQos));
  EXPECT_EQ(line.counters().frames_dropped, (std::array<std::uint64_t, 3>{1, 1, 1}));
  EXPECT_EQ(pop(line, 10'000).size(), 70U);
  EXPECT_EQ(line.writable(), 50U);
  EXPECT_EQ(line.queued(), 0U);
}

TEST(SerialLine, BytesOnTheWireStillTakeRoomUntilTheyAreThrough) {
  SerialLine line({}, stream());
  push(line, 0, counting(100));
  EXPECT_EQ(line.writable(), 4096U - 100U);
  line.advance(Time{543});  // 50 bytes take 542.5 us
  EXPECT_EQ(line.writable(), 4096U - 50U);
  EXPECT_EQ(line.queued(), 50U);
}

TEST(SerialLine, AFullReceiveQueueLosesBytesAndCountsThem) {
  SerialLine line({.receive_capacity_bytes = 30}, stream());
  push(line, 0, counting(50));
  EXPECT_EQ(pop(line, 10'000), counting(30));
  EXPECT_EQ(line.counters().bytes_overrun, 20U);
  EXPECT_EQ(line.counters().bytes_sent, 50U);
}

TEST(SerialLine, PopTakesNoMoreThanAskedFor) {
  SerialLine line({}, stream());
  push(line, 0, counting(10));
  EXPECT_EQ(line.waiting(Time{0}), 0U);
  EXPECT_EQ(line.waiting(Time{1000}), 10U);
  Bytes small(4);
  EXPECT_EQ(line.pop(Time{1000}, small.data(), small.size()), 4U);
  EXPECT_EQ(small, counting(4));
  EXPECT_EQ(pop(line, 1000), Bytes({4, 5, 6, 7, 8, 9}));
}

TEST(SerialLine, ACutLineSwallowsBytesAtItsRate) {
  SerialLine line({}, stream());
  push(line, 0, counting(100));
  line.advance(Time{543});
  line.set_cut(true);
  line.advance(Time{814});  // 75 bytes take 813.8 us
  line.set_cut(false);
  Bytes expected = counting(50);
  const Bytes end = counting(25, 75);
  expected.insert(expected.end(), end.begin(), end.end());
  EXPECT_EQ(pop(line, 10'000), expected);
  EXPECT_EQ(line.counters().bytes_vanished, 25U);
}

TEST(SerialLine, CorruptionHasItsProbabilityAndTurnsOneBit) {
  constexpr double kProbability = 0.01;
  SerialLine line({.corruption_per_byte = kProbability}, stream());
  const Bytes frame(200, 0x5A);
  std::uint64_t total = 0;
  std::uint64_t wrong = 0;
  for (std::int64_t t = 0; t < 3'000'000; t += 3000) {
    push(line, t, frame);
    for (const std::uint8_t byte : pop(line, t + 2900)) {
      ++total;
      if (byte == 0x5A) continue;
      ++wrong;
      const unsigned flipped = byte ^ 0x5AU;
      EXPECT_EQ(flipped & (flipped - 1U), 0U);
    }
  }
  EXPECT_EQ(total, 200'000U);
  EXPECT_EQ(line.counters().bytes_corrupted, wrong);
  // Binomial: 4 standard deviations of sqrt(n p (1 - p)) = 44.5.
  EXPECT_NEAR(static_cast<double>(wrong), 2000.0, 4.0 * 44.5);
}

TEST(SerialLine, CorruptionAtProbabilityOneHitsEveryByte) {
  SerialLine line({.corruption_per_byte = 1.0}, stream());
  push(line, 0, Bytes(300, 0));
  const Bytes got = pop(line, 10'000);
  EXPECT_EQ(got.size(), 300U);
  for (const std::uint8_t byte : got) EXPECT_NE(byte, 0);
}

TEST(SerialLine, TheSameStreamCorruptsTheSameBytes) {
  SerialLine::Config config{.corruption_per_byte = 0.1};
  SerialLine a(config, stream());
  SerialLine b(config, stream());
  SerialLine other(config, RandomSource{2}.stream("cable"));
  for (SerialLine* line : {&a, &b, &other}) push(*line, 0, counting(200));
  const Bytes from_a = pop(a, 10'000);
  EXPECT_EQ(from_a, pop(b, 10'000));
  EXPECT_NE(from_a, pop(other, 10'000));
}

TEST(SerialLine, NoiseCanBeginAndEnd) {
  SerialLine line({}, stream());
  const Bytes frame(300, 0);
  const auto wrong_at = [&](std::int64_t t) {
    push(line, t, frame);
    const Bytes got = pop(line, t + 10'000);
    EXPECT_EQ(got.size(), frame.size());
    return std::count_if(got.begin(), got.end(), [](std::uint8_t byte) { return byte != 0; });
  };
  EXPECT_EQ(wrong_at(0), 0);
  line.set_corruption(0.5);
  EXPECT_NEAR(static_cast<double>(wrong_at(20'000)), 150.0, 4.0 * 8.7);  // binomial, 4 sigma
  line.set_corruption(0.0);
  EXPECT_EQ(wrong_at(40'000), 0);
}

TEST(SerialLine, SurvivesTheLongestWait) {
  SerialLine line({}, stream());
  push(line, 0, counting(100));
  EXPECT_EQ(line.pop(Time::max(), Bytes(200).data(), 0), 0U);
  EXPECT_EQ(line.queued(), 0U);
}

TEST(SerialLine, RefusesNonsense) {
  EXPECT_THROW(SerialLine({.baud = 0}, stream()), std::invalid_argument);
  EXPECT_THROW(SerialLine({.frame_bits = 0}, stream()), std::invalid_argument);
  EXPECT_THROW(SerialLine({.transmit_capacity_bytes = {1, 0, 1}}, stream()), std::invalid_argument);
  EXPECT_THROW(SerialLine({.receive_capacity_bytes = 0}, stream()), std::invalid_argument);
  EXPECT_THROW(SerialLine({.corruption_per_byte = 1.5}, stream()), std::invalid_argument);
  EXPECT_THROW(SerialLine({.corruption_per_byte = std::nan("")}, stream()), std::invalid_argument);
}

TEST(SerialCable, DirectionsDoNotMeet) {
  SerialCable cable({}, RandomSource{1});
  push(cable.to_companion, 0, {1, 2});
  push(cable.to_board, 0, {3});
  cable.advance(Time{100});
  EXPECT_EQ(pop(cable.to_companion, 100), Bytes({1, 2}));
  EXPECT_EQ(pop(cable.to_board, 100), Bytes({3}));
  cable.set_cut(true);
  push(cable.to_companion, 100, {1});
  push(cable.to_board, 100, {1});
  EXPECT_TRUE(pop(cable.to_companion, 200).empty());
  EXPECT_TRUE(pop(cable.to_board, 200).empty());
}

}  // namespace
}  // namespace rosflight::sim
