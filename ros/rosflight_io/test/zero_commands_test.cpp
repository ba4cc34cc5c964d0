// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/zero_commands.hpp"

#include <gtest/gtest.h>

namespace rosflight_io {
namespace {

using rosflight::link::OffboardControl;
using std::chrono::milliseconds;

constexpr std::uint8_t kPassThrough = 0, kAngles = 2;

OffboardControl lift(std::uint8_t mode = kPassThrough) {
  OffboardControl command;
  command.mode = mode;
  command.u[2] = -5.0F;
  return command;
}

/// Lines logged in `seconds` at 100 Hz, of which every `nth` is zero; their counts are added to `sum`.
int lines(ZeroCommands& watch, int from_s, int seconds, int nth, int& sum,
          std::uint8_t mode = kPassThrough) {
  int told = 0;
  for (int k = 0; k < 100 * seconds; ++k) {
    OffboardControl zero;
    zero.mode = mode;
    const int count =
        watch.take(k % nth == 0 ? zero : lift(mode), milliseconds(1000 * from_s + 10 * k));
    told += count > 0 ? 1 : 0;
    sum += count;
  }
  return told;
}

TEST(ZeroCommands, AreToldOnceASecondWithTheirNumber) {
  ZeroCommands watch;
  watch.set_armed(true);
  EXPECT_EQ(watch.take(lift(), milliseconds(0)), 0);
  int sum = 0;
  EXPECT_EQ(lines(watch, 1, 10, 10, sum), 10);
  EXPECT_NEAR(sum, 100, 10);
}

TEST(ZeroCommands, OnTheGroundDisarmedInOtherModesAndAfterTheLandingAreNotTold) {
  int sum = 0;
  ZeroCommands watch;
  EXPECT_EQ(lines(watch, 0, 10, 10, sum), 0) << "disarmed";
  watch.set_armed(true);
  EXPECT_EQ(lines(watch, 10, 10, 1, sum), 0) << "not yet flying";
  EXPECT_EQ(lines(watch, 20, 10, 10, sum, kAngles), 0);
  EXPECT_EQ(lines(watch, 30, 20, 1, sum), 5) << "5 s, then it has landed";
  watch.set_armed(false);
  EXPECT_EQ(lines(watch, 50, 10, 1, sum), 0);
}

}  // namespace
}  // namespace rosflight_io
