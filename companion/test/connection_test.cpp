// SPDX-License-Identifier: BSD-3-Clause
#include "companion/connection.hpp"

#include <gtest/gtest.h>

#include "companion/version.hpp"

namespace rosflight::companion {
namespace {

using namespace std::chrono_literals;

TEST(Connection, NeedsAHeartbeatAndThenAnyMessage) {
  Connection connection;
  EXPECT_FALSE(connection.received(1s, false));
  EXPECT_FALSE(connection.connected());
  EXPECT_TRUE(connection.received(2s, true));
  EXPECT_FALSE(connection.received(3s, true));
  EXPECT_FALSE(connection.received(4s, false));
  EXPECT_FALSE(connection.expired(5999ms));
  EXPECT_EQ(connection.next_due(), 6s);
  EXPECT_TRUE(connection.expired(6s));
  EXPECT_FALSE(connection.connected());
  EXPECT_FALSE(connection.expired(7s));  // reported once
  EXPECT_FALSE(connection.received(8s, false));
  EXPECT_TRUE(connection.received(8s, true));
}

TEST(Connection, RestartIsTwoStampsRunningThatLieBack) {
  Connection connection;
  EXPECT_FALSE(connection.fcu_clock(100s));
  EXPECT_FALSE(connection.fcu_clock(99900ms));  // order of two messages
  EXPECT_FALSE(connection.fcu_clock(50s));      // a late datagram
  EXPECT_FALSE(connection.fcu_clock(101s));
  EXPECT_FALSE(connection.fcu_clock(300ms));
  EXPECT_TRUE(connection.fcu_clock(302ms));
  EXPECT_FALSE(connection.fcu_clock(305ms));
  EXPECT_FALSE(connection.fcu_clock(10s));
}

TEST(Version, FirstTwoNumbersCount) {
  EXPECT_EQ(parse_version("v2.0.1-12-gabcdef12"), (MajorMinor{2, 0}));
  EXPECT_EQ(parse_version("2.13"), (MajorMinor{2, 13}));
  for (const char* bad :
       {"", "v", "2", "2.", "v2.x", ".5", "-2.0", "2.-1", "99999999999.0", "abcdef12"}) {
    EXPECT_FALSE(parse_version(bad)) << bad;
  }
  EXPECT_EQ(compare_versions("2.0", "v2.0.7"), VersionMatch::kSame);
  EXPECT_EQ(compare_versions("2.0", "v2.1.0"), VersionMatch::kDiffers);
  EXPECT_EQ(compare_versions("2.0", "v1.0.0"), VersionMatch::kDiffers);
  EXPECT_EQ(compare_versions("2.0", "unknown"), VersionMatch::kUnreadable);
}

}  // namespace
}  // namespace rosflight::companion
