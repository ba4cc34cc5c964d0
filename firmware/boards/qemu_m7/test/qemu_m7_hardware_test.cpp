// SPDX-License-Identifier: BSD-3-Clause
// What the emulated board adds to the contracts; runs on the processor itself.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/boards/qemu_m7/startup.hpp"
#include "firmware/boards/qemu_m7/test/crossed_uarts.hpp"
#include "firmware/core/test/arithmetic_contract.hpp"

namespace rosflight::boards::m7 {
namespace {

TEST(HardwareClock, GoesOnAcrossTheWrapOfTheHardware) {
  constexpr std::uint32_t kBeforeWrap = 10u * (kClock_Hz / 1000u);  // 10 ms
  reg(kCycleCounter) = 0u - kBeforeWrap;
  HardwareClock clock;
  const hal::Time begin = clock.now();
  EXPECT_LT(begin, hal::milliseconds(10));
  EXPECT_GT(cycles(), 0x8000'0000u) << "before the wrap";
  hal::Time last = begin;
  while (cycles() > 0x8000'0000u) {
    const hal::Time now = clock.now();
    ASSERT_GE(now, last);
    last = now;
  }
  clock.keep();
  spend(hal::milliseconds(5));
  const hal::Time after = clock.now();
  EXPECT_GE(after - begin, hal::milliseconds(14));
  EXPECT_LT(after - begin, hal::milliseconds(60'000)) << "and not by a turn of the counter, 171 s";
}

TEST(Uart, AnUrgentFrameOvertakesWaitingOnes) {
  CrossedUarts uarts;
  ASSERT_TRUE(uarts.near.open(921'600, 0));
  const std::vector<std::uint8_t> slow(300, 's');
  const std::vector<std::uint8_t> timely(20, 't');
  const std::vector<std::uint8_t> urgent(30, 'u');
  ASSERT_TRUE(uarts.near.write(slow.data(), slow.size(), hal::Serial::kOrdinary));
  ASSERT_TRUE(uarts.near.write(timely.data(), timely.size(), hal::Serial::kTimely));
  ASSERT_TRUE(uarts.near.write(urgent.data(), urgent.size(), hal::Serial::kUrgent));
  const std::vector<std::uint8_t> sent = uarts.sent();
  ASSERT_EQ(sent.size(), 350u);
  EXPECT_EQ(sent[0], 'u');
  EXPECT_EQ(sent[30], 't');
  EXPECT_EQ(sent[50], 's');
}

TEST(Uart, RefusesRatesThatTheClockCannotGive) {
  CrossedUarts uarts;
  EXPECT_TRUE(uarts.near.open(1'500'000, 0));
  EXPECT_FALSE(uarts.near.open(1'600'000, 0));
  EXPECT_FALSE(uarts.near.open(0, 0));
  EXPECT_FALSE(uarts.near.open(921'600, 1));
}

TEST(Uart, LongPacketsInBothDirectionsLoseNothing) {
  // A receive handler that reads before it acknowledges stops for good here (see on_receive()).
  CrossedUarts uarts;
  ASSERT_TRUE(uarts.near.open(921'600, 0));
  for (int round = 0; round < 30; ++round) {
    std::vector<std::uint8_t> out(100);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::uint8_t>(k + 3u);
    ASSERT_TRUE(uarts.near.write(out.data(), out.size(), hal::Serial::kOrdinary));
    uarts.deliver(out);
    std::vector<std::uint8_t> in(200);
    in.resize(uarts.near.read(in.data(), in.size()));
    ASSERT_EQ(in, out) << round;
    ASSERT_EQ(uarts.sent(), out) << round;
  }
  EXPECT_EQ(uarts.near.counters().overruns, 0u);
}

__attribute__((noinline)) std::uint32_t dig(std::uint32_t depth) {
  volatile std::uint32_t room[64] = {};
  room[depth % 64] = depth;
  return depth == 0 ? room[0] : dig(depth - 1) + room[depth % 64];
}

TEST(Stack, HighWaterMarkFollowsTheDepth) {
  const std::uint32_t before = stack_high_water();
  EXPECT_GT(before, 0u);
  EXPECT_LT(before, stack_size());
  const std::uint32_t levels = (stack_size() - before) / 512;
  ASSERT_GT(levels, 4u);
  dig(before / 256 + levels);  // over 256 bytes each
  EXPECT_GT(stack_high_water(), before);
  EXPECT_LE(stack_high_water(), stack_size());
}

TEST(Processor, ComputesInSingleAndDoublePrecision) {
  volatile float two_f = 2.0f;
  volatile double two = 2.0;
  EXPECT_EQ(std::sqrt(static_cast<float>(two_f)), 1.41421354f);
  EXPECT_EQ(std::sqrt(static_cast<double>(two)), 1.4142135623730951);
}

}  // namespace
}  // namespace rosflight::boards::m7

extern "C" int target_main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
