// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/linux_system.hpp"

#include <gtest/gtest.h>

namespace rosflight::boards {
namespace {

struct HandClock final : hal::Clock {
  hal::Time now() const override { return time; }
  hal::Time time{};
};

TEST(LinuxSystem, CountsPassesThatAWatchdogWouldNotHaveWaitedFor) {
  HandClock clock;
  LinuxSystem system(clock);
  for (const int ms : {5000, 5100, 5200, 5301, 5302, 9000}) {
    clock.time = hal::milliseconds(ms);
    system.feed_watchdog();
  }
  EXPECT_EQ(system.passes(), 6u);
  EXPECT_EQ(system.watchdog_count(), 2u);  // 101 ms and 3698 ms; the first has none before it
}

TEST(LinuxSystem, ARestartBeginsWithoutARequestAndWithAFreshWatchdog) {
  HandClock clock;
  LinuxSystem system(clock);
  clock.time = hal::milliseconds(5000);
  system.feed_watchdog();
  system.start_sensors();
  system.reset(true);
  EXPECT_TRUE(system.reset_requested());
  system.restarted();
  EXPECT_FALSE(system.reset_requested());
  EXPECT_FALSE(system.sensors_started());
  clock.time = hal::Time{0};
  system.feed_watchdog();
  EXPECT_EQ(system.watchdog_count(), 0u);
}

TEST(LinuxClock, StartsAtZeroWithEachBootAndKnowsOtherMoments) {
  LinuxClock clock;
  const hal::Time before = LinuxClock::steady();
  clock.boot();
  const hal::Time after = LinuxClock::steady();
  EXPECT_LE(clock.at(before), hal::Time{0});
  EXPECT_GE(clock.at(after), hal::Time{0});
  EXPECT_EQ(clock.at(after + hal::milliseconds(5)) - clock.at(after), hal::milliseconds(5));
}

}  // namespace
}  // namespace rosflight::boards
