// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/common/wide_counter.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rosflight::boards {
namespace {

/// A counter of 32 bits, with the true count beside it.
struct Counter {
  std::uint64_t count{0};
  std::uint32_t first{0};
  std::uint32_t shown() const { return static_cast<std::uint32_t>(first + count); }
  auto reader() const {
    return [this] { return shown(); };
  }
};

TEST(WideCounter, GoesOnAcrossTheWrapOfTheCounter) {
  for (const std::uint32_t first : {0U, 1U, 0x7FFF'FFFFU, 0x8000'0000U, 0xFFFF'FF00U}) {
    Counter counter{0, first};
    WideCounter wide;
    wide.start(counter.shown());
    for (int k = 0; k < 40; ++k) {
      ASSERT_EQ(wide.at(counter.reader()), counter.count) << "from " << first;
      wide.keep(counter.shown());
      ASSERT_EQ(wide.at(counter.reader()), counter.count);
      counter.count += 0x4000'0001U;
    }
  }
}

TEST(WideCounter, IsRightWhereverTheInterruptComes) {
  std::mt19937 random{7};
  std::uniform_int_distribution<std::uint64_t> passes{0, 0x7FFF'FFFFU};
  Counter counter{0, 0x1234'5678U};
  WideCounter wide;
  wide.start(counter.shown());
  for (int k = 0; k < 100'000; ++k) {
    counter.count += passes(random) / 2;
    // The interrupt comes after the half turns are read and before the counter is, late by as much as is allowed.
    const std::uint64_t found = wide.at([&] {
      counter.count += passes(random) / 2;
      wide.keep(counter.shown());
      return counter.shown();
    });
    ASSERT_EQ(found, counter.count);
  }
}

TEST(WideCounter, TooLateByHalfATurnIsWrong) {
  Counter counter{0, 0};
  WideCounter wide;
  wide.start(counter.shown());
  counter.count = 0x8000'0000U;
  EXPECT_EQ(wide.at(counter.reader()), counter.count);
  counter.count = 0x1'0000'0000U;
  EXPECT_NE(wide.at(counter.reader()), counter.count) << "this test judges at the stated limit";
}

}  // namespace
}  // namespace rosflight::boards
