// SPDX-License-Identifier: BSD-3-Clause
#include "companion/time_sync.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "companion/test/fake_fcu.hpp"

namespace rosflight::companion::test {
namespace {

using namespace std::chrono_literals;

/// Two clocks and a path between them.
struct World {
  Time true_offset{123456789ns};  ///< Companion - FCU at time zero.
  double drift{0.0};              ///< Companion seconds gained per FCU second.
  std::function<Time()> delay_up{[] { return 300us; }};
  std::function<Time()> delay_down{[] { return 300us; }};

  Time companion_of(Time fcu) const {
    return fcu + true_offset + Time{std::llround(drift * static_cast<double>(fcu.count()))};
  }
  Time fcu_of(Time companion) const {
    const double fcu = static_cast<double>((companion - true_offset).count()) / (1.0 + drift);
    return Time{std::llround(fcu)};
  }
  TimeSync::Answer exchange(TimeSync& sync, Time sent) const {
    const link::TimeSync request = sync.request(sent);
    const Time fcu = fcu_of(sent + delay_up());
    const Time fcu_us{fcu.count() / 1000 * 1000};  // the FCU's clock ticks in microseconds
    return sync.answer({fcu_us.count(), request.ts1_ns}, companion_of(fcu) + delay_down());
  }
  Time error(const TimeSync& sync, Time fcu) const {
    return std::chrono::abs(sync.to_companion(fcu) - companion_of(fcu));
  }
};

TEST(TimeSync, SymmetricDelaysGiveTheOffsetToTheTickOfTheFcuClock) {
  World world;
  TimeSync sync;
  EXPECT_FALSE(sync.synchronised());
  EXPECT_EQ(world.exchange(sync, 1s), TimeSync::Answer::kAccepted);
  ASSERT_TRUE(sync.synchronised());
  EXPECT_LE(world.error(sync, 2s), 1us);
  EXPECT_EQ(sync.figures().round_trip, 600us);
  EXPECT_EQ(sync.figures().error_bound, 300us);
}

// Half of the round trip bounds the error, and here reaches it: all of the delay is on the way
// down.
TEST(TimeSync, ErrorOfOneSidedDelayIsWithinTheBound) {
  World world;
  world.delay_up = [] { return 0us; };
  world.delay_down = [] { return 4ms; };
  TimeSync sync;
  world.exchange(sync, 1s);
  EXPECT_LE(world.error(sync, 2s), sync.figures().error_bound + 1us);
  EXPECT_GE(world.error(sync, 2s), sync.figures().error_bound - 1us);
}

// Queues delay most answers by up to 8 ms, one way only; a few pass at once. Figures after 30 s.
TEST(TimeSync, MinimumDelayRuleBeatsTheReferenceRuleUnderQueueing) {
  const auto worst = [](TimeSync::Rule rule) {
    World world;
    Random random(7);
    world.delay_down = [&random] {
      const double u = random.uniform();
      return 300us + Time{static_cast<std::int64_t>(u < 0.2 ? 0.0 : u * 8e6)};
    };
    TimeSync sync(rule);
    Time worst_error{};
    for (int i = 0; i < 600; ++i) {
      const Time now = 1s + i * 100ms;
      world.exchange(sync, now);
      if (i > 300) {
        worst_error = std::max(worst_error, world.error(sync, world.fcu_of(now)));
      }
    }
    return worst_error;
  };
  EXPECT_LT(worst(TimeSync::Rule::kMinimumDelay), 20us);
  EXPECT_GT(worst(TimeSync::Rule::kRosflight2), 2ms);
}

TEST(TimeSync, DriftOfACrystalIsFoundAndFollowed) {
  World world;
  world.drift = 80e-6;
  Random random(3);
  world.delay_up = [&random] {
    return 200us + Time{static_cast<std::int64_t>(random.uniform() * 1e5)};
  };
  TimeSync sync;
  for (int i = 0; i < 300; ++i) {
    world.exchange(sync, 1s + i * 100ms);
  }
  EXPECT_NEAR(sync.figures().drift_ppm, 80.0, 10.0);
  // Without drift in the model the offset of a 16 s window would be 0.6 ms behind.
  EXPECT_LE(world.error(sync, world.fcu_of(31s)), 100us);
}

TEST(TimeSync, OneLateAnswerIsNoJump) {
  World world;
  TimeSync sync;
  for (int i = 0; i < 50; ++i) {
    world.exchange(sync, 1s + i * 100ms);
  }
  world.delay_down = [] { return 900ms; };
  EXPECT_EQ(world.exchange(sync, 7s), TimeSync::Answer::kAccepted);
  EXPECT_LE(world.error(sync, 7s), 2us);
  EXPECT_EQ(sync.figures().jumps, 0U);
}

TEST(TimeSync, AJumpOfTheFcuClockIsTakenAtTheSecondContradiction) {
  World world;
  TimeSync sync;
  for (int i = 0; i < 50; ++i) {
    world.exchange(sync, 1s + i * 100ms);
  }
  world.true_offset += 2s;
  EXPECT_EQ(world.exchange(sync, 7s), TimeSync::Answer::kIgnored);
  EXPECT_EQ(world.exchange(sync, 7100ms), TimeSync::Answer::kJumped);
  EXPECT_LE(world.error(sync, 7s), 1us);
  EXPECT_EQ(sync.figures().jumps, 1U);
}

// A frame whose checksum fits by chance: one wrong clock must not move stamps.
TEST(TimeSync, ASingleWildClockIsIgnored) {
  World world;
  TimeSync sync;
  for (int i = 0; i < 50; ++i) {
    world.exchange(sync, 1s + i * 100ms);
  }
  const auto request = sync.request(7s);
  EXPECT_EQ(sync.answer({987654321987654321, request.ts1_ns}, 7s + 600us),
            TimeSync::Answer::kIgnored);
  EXPECT_EQ(world.exchange(sync, 7100ms), TimeSync::Answer::kAccepted);
  EXPECT_LE(world.error(sync, 7s), 2us);
}

TEST(TimeSync, OnlyOwnAnswersCountAndEachOnce) {
  TimeSync sync;
  EXPECT_EQ(sync.answer({5000, 0}, 1s), TimeSync::Answer::kIgnored);  // nothing asked yet
  const auto request = sync.request(2s);
  EXPECT_EQ(sync.answer({0, request.ts1_ns}, 2s + 1ms), TimeSync::Answer::kIgnored);  // a request
  EXPECT_EQ(sync.answer({-5, request.ts1_ns}, 2s + 1ms), TimeSync::Answer::kIgnored);
  EXPECT_EQ(sync.answer({std::numeric_limits<std::int64_t>::max(), request.ts1_ns}, 2s + 1ms),
            TimeSync::Answer::kIgnored);
  EXPECT_EQ(sync.answer({5000, request.ts1_ns + 1}, 2s + 1ms), TimeSync::Answer::kIgnored);
  EXPECT_EQ(sync.answer({5000, request.ts1_ns}, 1s),
            TimeSync::Answer::kIgnored);  // before it was sent
  EXPECT_EQ(sync.answer({5000, request.ts1_ns}, 2s + 3s),
            TimeSync::Answer::kIgnored);  // too old to help
  EXPECT_EQ(sync.answer({5000, request.ts1_ns}, 2s + 1ms), TimeSync::Answer::kAccepted);
  EXPECT_EQ(sync.answer({5000, request.ts1_ns}, 2s + 1ms), TimeSync::Answer::kIgnored);  // doubled
  EXPECT_EQ(sync.figures().answers, 1U);
  EXPECT_EQ(sync.figures().ignored, 8U);
}

TEST(TimeSync, ResetTakesTheNextAnswerAsItIs) {
  World world;
  TimeSync sync;
  world.exchange(sync, 1s);
  world.true_offset += 500s;
  sync.reset();
  EXPECT_FALSE(sync.synchronised());
  EXPECT_EQ(world.exchange(sync, 600s), TimeSync::Answer::kAccepted);
  EXPECT_LE(world.error(sync, 600s), 1us);
}

// The rule of ROSflight 2.x, by hand: offsets 0, then 1 ms: 0.95 * 1 ms; then 20 ms off: taken
// directly.
TEST(TimeSync, ReferenceRuleFiltersAndJumps) {
  TimeSync sync(TimeSync::Rule::kRosflight2);
  const auto exchange = [&sync](Time at, Time offset) {
    const auto request = sync.request(at);
    sync.answer({(at - offset).count(), request.ts1_ns}, at);
  };
  exchange(1s, 0ms);
  exchange(2s, 1ms);
  EXPECT_EQ(sync.to_companion(5s) - 5s, 950us);
  exchange(3s, 20ms);
  EXPECT_EQ(sync.to_companion(5s) - 5s, 20ms);
  EXPECT_EQ(sync.figures().jumps, 1U);
}

}  // namespace
}  // namespace rosflight::companion::test
