// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/children.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <map>
#include <stdexcept>

namespace rosflight::bench::faults {
namespace {

TEST(Children, WorkOnACopyOfTheProcess) {
  int value = 1;
  const std::string result = in_child([&value] {
    ++value;
    return std::to_string(value);
  });
  EXPECT_EQ(result, "2");
  EXPECT_EQ(value, 1);
}

TEST(Children, AnErrorIsThrownHereWithItsMessage) {
  try {
    in_child([]() -> std::string { throw std::runtime_error("no such\nphase"); });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no such phase");
  }
}

TEST(Children, AProcessThatEndsIsAnError) {
  EXPECT_THROW(in_child([]() -> std::string { _exit(3); }), std::runtime_error);
  EXPECT_THROW(in_children(
                   4, 2, [](std::size_t) -> std::string { _exit(3); },
                   [](std::size_t, const std::string&) {}),
               std::runtime_error);
}

TEST(Children, EachPieceOfWorkIsDoneOnce) {
  for (const unsigned children : {0U, 1U, 3U}) {
    std::map<std::size_t, std::string> results;
    in_children(
        100, children, [](std::size_t k) { return std::to_string(k * k); },
        [&results](std::size_t k, const std::string& result) {
          EXPECT_TRUE(results.emplace(k, result).second) << k;
        });
    ASSERT_EQ(results.size(), 100U);
    for (const auto& [k, result] : results) EXPECT_EQ(result, std::to_string(k * k));
  }
}

TEST(Children, TheMessageOfOneThatFailsIsThrown) {
  const auto work = [](std::size_t k) -> std::string {
    if (k == 7) throw std::runtime_error("seven");
    return "";
  };
  EXPECT_THROW(
      {
        try {
          in_children(20, 2, work, [](std::size_t, const std::string&) {});
        } catch (const std::runtime_error& error) {
          EXPECT_STREQ(error.what(), "seven");
          throw;
        }
      },
      std::runtime_error);
}

}  // namespace
}  // namespace rosflight::bench::faults
