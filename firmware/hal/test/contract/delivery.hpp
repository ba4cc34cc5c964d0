// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "firmware/hal/test/contract/samples.hpp"

/// What the suites of sources expect of a sample that a device has delivered: by default every bit of it, its stamp
/// included, and no other sample. The Traits of a device with a resolution and a clock of its own add
///
///     Sample expected(const Sample& delivered, hal::Time stamp);   // what a sample with this stamp shows of it;
///                                                                  // stamped in the middle of the allowed time
///     Sample tolerance();           // largest deviation of each field from that; the stamp's is half of that time
///
/// and those of a device that measures by itself, whether or not something is delivered,
///
///     hal::Time since();            // a sample with this stamp or a later one shows the last delivered sample
///     hal::Time period();           // between two samples
///     void pass(hal::Time time);    // the device goes on measuring for at least this time
namespace rosflight::hal::contract {

template <class Traits, class = void>
inline constexpr bool kHasResolution = false;
template <class Traits>
inline constexpr bool
    kHasResolution<Traits, std::void_t<decltype(std::declval<Traits&>().tolerance())>> = true;

template <class Traits, class = void>
inline constexpr bool kMeasuresByItself = false;
template <class Traits>
inline constexpr bool
    kMeasuresByItself<Traits, std::void_t<decltype(std::declval<Traits&>().since())>> = true;

// Whether a field is within its tolerance.
inline bool near(Time found, Time expected, Time tolerance) {
  return std::abs((found - expected).count()) <= tolerance.count();
}
inline bool near(double found, double expected, double tolerance) {
  return std::abs(found - expected) <= tolerance;  // false for NaN
}
inline bool near(float found, float expected, float tolerance) {
  return std::abs(found - expected) <= tolerance;
}
template <class Number, std::enable_if_t<std::is_integral_v<Number>, int> = 0>
bool near(Number found, Number expected, Number tolerance) {
  return std::llabs(std::int64_t{found} - std::int64_t{expected}) <= std::int64_t{tolerance};
}
template <class Enum, std::enable_if_t<std::is_enum_v<Enum>, int> = 0>
bool near(Enum found, Enum expected, Enum /*tolerance*/) {
  return found == expected;
}
template <std::size_t N>
bool near(const std::array<float, N>& found, const std::array<float, N>& expected,
          const std::array<float, N>& tolerance) {
  for (std::size_t k = 0; k < N; ++k) {
    if (!near(found[k], expected[k], tolerance[k])) return false;
  }
  return true;
}

template <class Fields, std::size_t... kIndex>
::testing::AssertionResult near(const Fields& found, const Fields& expected,
                                const Fields& tolerance, std::index_sequence<kIndex...> /*all*/) {
  ::testing::AssertionResult result = ::testing::AssertionSuccess();
  const auto compare = [&result](std::size_t index, const auto& a, const auto& b, const auto& t) {
    if (near(a, b, t)) return;
    result = ::testing::AssertionFailure()
             << "field " << index << ": found " << ::testing::PrintToString(a) << ", expected "
             << ::testing::PrintToString(b) << ", tolerance " << ::testing::PrintToString(t);
  };
  (compare(kIndex, std::get<kIndex>(found), std::get<kIndex>(expected),
           std::get<kIndex>(tolerance)),
   ...);
  return result;
}

/// Two numbers that are one time: counted from the second of the other sample.
inline GnssSample counted_as(GnssSample found, const GnssSample& expected) {
  const std::int64_t seconds = found.unix_s - expected.unix_s;
  if (std::llabs(seconds) > 1) return found;
  found.unix_s = expected.unix_s;
  found.unix_ns += static_cast<std::int32_t>(seconds * 1'000'000'000);
  return found;
}
template <class Sample>
const Sample& counted_as(const Sample& found, const Sample& /*expected*/) {
  return found;
}

/// What the suites of sources share.
template <class Traits>
class Delivery : public ::testing::Test {
 protected:
  using Measurement = typename Traits::Sample;

  ::testing::AssertionResult shows([[maybe_unused]] const Measurement& found,
                                   [[maybe_unused]] const Measurement& delivered) {
    if constexpr (kHasResolution<Traits>) {
      const Measurement expected = traits_.expected(delivered, found.stamp);
      const Measurement tolerance = traits_.tolerance();
      const Measurement counted = counted_as(found, expected);
      using Fields = decltype(fields(expected));
      return near(fields(counted), fields(expected), fields(tolerance),
                  std::make_index_sequence<std::tuple_size_v<Fields>>{});
    } else {
      if (fields(found) == fields(delivered)) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure()
             << "found " << ::testing::PrintToString(fields(found)) << ", delivered "
             << ::testing::PrintToString(fields(delivered));
    }
  }

  /// Polls the next sample that may show what was delivered last: a device that measures by itself has
  /// others, from before.
  bool poll_delivered(Measurement& sample) {
    constexpr int kMorePollsThanAQueueHolds = 100;
    for (int k = 0; k < kMorePollsThanAQueueHolds && traits_.role().poll(sample); ++k) {
      if constexpr (kMeasuresByItself<Traits>) {
        if (sample.stamp < traits_.since()) continue;
      }
      return true;
    }
    return false;
  }

  /// No sample comes twice, and a poll without one leaves the caller's variable alone. @param last  stamp of the
  /// sample that was polled; a device that measures by itself may have later ones.
  void expect_no_more(Time last) {
    const Measurement mine = make<Measurement>(8);
    Measurement sample = mine;
    for (int more = 0; traits_.role().poll(sample); ++more) {
      ASSERT_TRUE(kMeasuresByItself<Traits>) << "one sample was delivered, and another one came";
      ASSERT_GT(sample.stamp, last);
      ASSERT_LT(more, 100) << "samples without end";
      last = sample.stamp;
      sample = mine;
    }
    EXPECT_EQ(fields(sample), fields(mine));
  }

  Traits traits_;
};

}  // namespace rosflight::hal::contract
