// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/buzzer.hpp"

#include <gtest/gtest.h>

#include <string>

namespace rosflight::boards::parts {
namespace {

constexpr Buzzer::Inputs kOnGround{false, false, false, false};
constexpr Buzzer::Inputs kFlying{true, false, false, false};
constexpr Buzzer::Inputs kFailsafe{true, true, false, false};
constexpr Buzzer::Inputs kLowBattery{true, false, true, false};

/// Steps every 10 ms.
class Sounding {
 public:
  explicit Sounding(hal::Time begin = hal::milliseconds(5000)) : now_{begin} {}
  /// One letter for each 100 ms: the tone at its beginning, L of 2000, M of 2500, H of 4000 Hz, or a dot; ? if
  /// it changed meanwhile.
  std::string sounds(const Buzzer::Inputs& inputs, int tenths) {
    std::string letters;
    for (int k = 0; k < 10 * tenths; ++k) {
      const char tone = letter(buzzer_.step(inputs, now_));
      now_ += hal::milliseconds(10);
      if (k % 10 == 0) {
        letters += tone;
      } else if (letters.back() != tone) {
        letters.back() = '?';
      }
    }
    return letters;
  }

 private:
  static char letter(std::uint32_t period_us) {
    constexpr std::uint32_t kSecond_us = 1'000'000;
    if (period_us == 0) return '.';
    const std::uint32_t Hz = kSecond_us / period_us;
    return Hz == 2000 ? 'L' : Hz == 2500 ? 'M' : Hz == 4000 ? 'H' : '?';
  }
  Buzzer buzzer_;
  hal::Time now_;
};

TEST(Buzzer, IsSilentOnTheGroundWhateverIsWrong) {
  Sounding s;
  EXPECT_EQ(s.sounds(kOnGround, 15), "...............");
  EXPECT_EQ(s.sounds({false, true, true, false}, 15), "...............");
}

TEST(Buzzer, ArmingIsOneLongBeepAndDisarmingTwoShortOnes) {
  Sounding s;
  static_cast<void>(s.sounds(kOnGround, 3));
  EXPECT_EQ(s.sounds(kFlying, 12), "MMMMM.......");
  EXPECT_EQ(s.sounds(kOnGround, 12), "M.M.........");
}

TEST(Buzzer, AStartAfterAFaultIsThreeShortBeeps) {
  Sounding s;
  EXPECT_EQ(s.sounds({false, false, false, true}, 10), "L.L.L.....");
  Sounding rearmed;
  EXPECT_EQ(rearmed.sounds({true, false, false, true}, 10), "L.L.L.....")
      << "armed from the start on: nobody armed it now";
}

TEST(Buzzer, ConditionsSoundWhileTheyLastInFlight) {
  Sounding s;
  static_cast<void>(s.sounds(kOnGround, 3));
  EXPECT_EQ(s.sounds(kFailsafe, 20), "MMMMMHHHHH.....HHHHH") << "behind the signal of arming";
  EXPECT_EQ(s.sounds(kFlying, 15), "...............");
  EXPECT_EQ(s.sounds(kLowBattery, 20), "H.........H.........");
  EXPECT_EQ(s.sounds({true, true, true, false}, 10), "HHHHH.....") << "failsafe goes first";
}

TEST(Buzzer, AnEventEndsTheSignalBefore) {
  Sounding s;
  static_cast<void>(s.sounds(kOnGround, 3));
  EXPECT_EQ(s.sounds(kFlying, 2), "MM");
  EXPECT_EQ(s.sounds(kOnGround, 6), "M.M...");
  EXPECT_EQ(s.sounds(kFailsafe, 7), "MMMMMHH");
  EXPECT_EQ(s.sounds(kOnGround, 6), "M.M...");
}

TEST(Buzzer, SoundsAfterMoreMicrosecondsThan32BitsHold) {
  Sounding s{hal::Time{(std::int64_t{3} << 32) - 200'000}};
  EXPECT_EQ(s.sounds(kOnGround, 1), ".");
  EXPECT_EQ(s.sounds(kFlying, 12), "MMMMM.......");
}

}  // namespace
}  // namespace rosflight::boards::parts
