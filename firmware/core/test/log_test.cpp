// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/log.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace rosflight::core {
namespace {

std::string str(const Text& text) {
  return text.chars().data();
}
std::string str(float value, int decimals) {
  return str(Text().add(value, decimals));
}

TEST(Text, WritesIntegers) {
  const auto text = [](std::int32_t v) { return str(Text().add(v)); };
  EXPECT_EQ(text(0), "0");
  EXPECT_EQ(text(-1), "-1");
  EXPECT_EQ(text(1234567890), "1234567890");
  EXPECT_EQ(text(std::numeric_limits<std::int32_t>::max()), "2147483647");
  EXPECT_EQ(text(std::numeric_limits<std::int32_t>::min()), "-2147483648");
}

TEST(Text, WritesHexadecimalNumbers) {
  EXPECT_EQ(str(Text().add_hex(0)), "0x0");
  EXPECT_EQ(str(Text().add_hex(0x08001234)), "0x8001234");
  EXPECT_EQ(str(Text().add_hex(0xFFFFFFFFu)), "0xFFFFFFFF");
}

TEST(Text, RoundsDecimals) {
  EXPECT_EQ(str(0.0f, 0), "0");
  EXPECT_EQ(str(12.34f, 1), "12.3");
  EXPECT_EQ(str(12.36f, 1), "12.4");
  EXPECT_EQ(str(-0.05f, 3), "-0.050");
  EXPECT_EQ(str(0.999f, 2), "1.00");  // carry into the whole part
  EXPECT_EQ(str(9.96f, 1), "10.0");
  EXPECT_EQ(str(2.5f, 0), "3");
  EXPECT_EQ(str(1.000001f, 6), "1.000001");
  EXPECT_EQ(str(1.5e9f, 1), "1500000000.0");
}

TEST(Text, SaysWhatIsNoNumber) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(str(std::numeric_limits<float>::quiet_NaN(), 2), "nan");
  EXPECT_EQ(str(kInf, 2), "huge");
  EXPECT_EQ(str(-kInf, 2), "-huge");
  EXPECT_EQ(str(3.0e9f, 2), "huge");
}

TEST(Text, TakesNamesWithAndWithoutNul) {
  link::ParamName name{};
  std::string("OFFBOARD_TIMEOUT").copy(name.data(), name.size());
  EXPECT_EQ(str(Text("No ").add(name).add("!")), "No OFFBOARD_TIMEOUT!");
  link::ParamName shorter{'P', 'I', 'D', '\0', 'X'};
  EXPECT_EQ(str(Text().add(shorter)), "PID");
}

TEST(Text, IsCutAt49CharactersAndNulPadded) {
  const std::string fits(49, 'a');
  EXPECT_EQ(str(Text(fits.c_str())), fits);
  EXPECT_EQ(str(Text(std::string(50, 'b').c_str())), std::string(49, 'b'));
  EXPECT_EQ(str(Text(fits.c_str()).add(12345)), fits);
  EXPECT_EQ(str(Text(std::string(47, 'c').c_str()).add(12345)), std::string(47, 'c') + "12");
  const Text text("abc");
  for (std::size_t k = 3; k < text.chars().size(); ++k) EXPECT_EQ(text.chars()[k], '\0') << k;
}

TEST(Log, GivesTextsInOrderWithTheirSeverity) {
  Log log;
  EXPECT_TRUE(log.empty());
  log.info("one");
  log.warning("two");
  log.error("three");
  log.critical("four");
  const std::pair<Severity, const char*> expected[] = {{Severity::kInfo, "one"},
                                                       {Severity::kWarning, "two"},
                                                       {Severity::kError, "three"},
                                                       {Severity::kCritical, "four"}};
  for (const auto& [severity, words] : expected) {
    ASSERT_FALSE(log.empty());
    const link::StatusText text = log.pop();
    EXPECT_EQ(text.severity, severity);
    EXPECT_STREQ(text.text.data(), words);
  }
  EXPECT_TRUE(log.empty());
  EXPECT_EQ(log.lost(), 0u);
}

TEST(Log, KeepsTheNewest25AndCountsTheLost) {
  Log log;
  for (std::int32_t k = 0; k < 60; ++k) log.info(Text().add(k));
  EXPECT_EQ(log.lost(), 35u);
  for (int k = 35; k < 60; ++k) {
    ASSERT_FALSE(log.empty());
    EXPECT_EQ(std::to_string(k), log.pop().text.data());
  }
  EXPECT_TRUE(log.empty());
}

TEST(Log, GoesRoundItsRingManyTimes) {
  Log log;
  std::int32_t in = 0;
  std::int32_t out = 0;
  for (int round = 0; round < 40; ++round) {
    for (int k = 0; k < 7; ++k) log.info(Text().add(in++));
    while (!log.empty()) EXPECT_EQ(std::to_string(out++), log.pop().text.data());
  }
  EXPECT_EQ(out, in);
  EXPECT_EQ(log.lost(), 0u);
}

TEST(RateLimit, AllowsTheFirstAndThenOnePerPeriod) {
  RateLimit limit(hal::milliseconds(1000));
  EXPECT_TRUE(limit.allow(hal::milliseconds(0)));
  EXPECT_FALSE(limit.allow(hal::milliseconds(0)));
  EXPECT_FALSE(limit.allow(hal::milliseconds(999)));
  EXPECT_TRUE(limit.allow(hal::milliseconds(1000)));
  EXPECT_FALSE(limit.allow(hal::milliseconds(1999)));
  EXPECT_TRUE(limit.allow(hal::milliseconds(5000)));
}

}  // namespace
}  // namespace rosflight::core
