// SPDX-License-Identifier: BSD-3-Clause
// Small hardware of the boards with an STM32H7, on the emulated chip: pins that are plain levels, LEDs, the buzzer, and the flash of
// the parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using Breakdown = Autopilot::Breakdown;

const boards::stm32h7::FromChip& pins_of(Rig& rig) {
  return chip_of(rig).process().from_chip();
}

void command(Rig& rig, std::initializer_list<std::pair<std::size_t, float>> servos) {
  link::AuxCommand command;
  for (const auto& [channel, value] : servos) {
    command.type[channel] = static_cast<std::uint8_t>(link::AuxType::kServo);
    command.value[channel] = value;
  }
  EXPECT_EQ(rig.flight->session().offboard().send(command), companion::SendStatus::kSent);
  rig.run_for(0.1);
}

/// Board, and rate of the channels beside the level, on the same timer.
using Beside = std::tuple<const char*, const char*>;
class LevelBeside : public ::testing::TestWithParam<Beside> {};
INSTANTIATE_TEST_SUITE_P(Rates, LevelBeside,
                         ::testing::Combine(::testing::Values("pixracer_pro", "varmint"),
                                            ::testing::Values("50", "300000")),
                         [](const auto& beside) {
                           return std::string(std::get<0>(beside.param)) + "At" +
                                  std::get<1>(beside.param) + "Hz";
                         });

TEST_P(LevelBeside, FollowsAuxiliaryCommandsAndServosToo) {
  constexpr std::size_t kLevel = 4, kServo = 5;
  constexpr double kStep = 1e-3;  // a throttle of 11 bits, or 0.3 us of a pulse
  FlightChoice choice = on_board({}, std::get<0>(GetParam()));
  choice.mission = "hop";
  choice.overrides = {"firmware.PRI_MIXER_OUT_4=3"};
  for (const char* const channel : {"5", "6", "7"}) {
    choice.overrides.push_back(std::string("firmware.PRI_MIXER_PWM_") + channel + "=" +
                               std::get<1>(GetParam()));
  }
  Rig rig{choice};
  const auto expect = [&rig](float level, double servo) {
    EXPECT_EQ(pins_of(rig).levels, 1U << kLevel) << "and no other pin is a level";
    EXPECT_EQ(pins_of(rig).outputs[kLevel], level);
    EXPECT_NEAR(pins_of(rig).outputs[kServo], servo, kStep);
  };
  rig.run_until(4.0);
  expect(0.0F, 0.0);
  command(rig, {{kLevel, 1.0F}, {kServo, 0.5F}});
  expect(1.0F, 0.75);
  command(rig, {{kLevel, 0.0F}, {kServo, -0.5F}});
  expect(0.0F, 0.25);
  command(rig, {{kLevel, 0.5F}});
  expect(1.0F, 0.5);
  rig.run_until(12.0);
  ASSERT_TRUE(view_of(rig).armed);
  expect(1.0F, 0.5);
  command(rig, {});
  expect(0.0F, 0.5);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

struct Beep {
  double begin_s, duration_s;
  std::uint32_t Hz;
};

/// Steps until `end`, or the flight has ended, and adds the beeps that ended meanwhile.
class Listener {
 public:
  explicit Listener(Rig& rig) : rig_{rig} {}
  void step() {
    rig_.flight->step();
    const double now_s = sim::to_seconds(rig_.flight->now());
    const std::uint32_t Hz = pins_of(rig_).buzzer_Hz;
    if (Hz == Hz_) return;
    if (Hz_ != 0) beeps.push_back({begin_s_, now_s - begin_s_, Hz_});
    begin_s_ = now_s;
    Hz_ = Hz;
  }
  void run_until(double t_s) {
    while (rig_.flight->now() < at_s(t_s)) step();
  }
  /// Beeps that began within a time, as letters: s for a tenth of a second, l for half a second.
  std::string of(double from_s, double to_s, std::uint32_t Hz) const {
    std::string letters;
    for (const Beep& beep : beeps) {
      if (beep.begin_s < from_s || beep.begin_s >= to_s) continue;
      const bool is_short = std::abs(beep.duration_s - 0.1) < 0.02;
      const bool is_long = std::abs(beep.duration_s - 0.5) < 0.02;
      letters += beep.Hz != Hz ? 'x' : is_short ? 's' : is_long ? 'l' : '?';
    }
    return letters;
  }
  std::vector<Beep> beeps;

 private:
  Rig& rig_;
  double begin_s_{0.0};
  std::uint32_t Hz_{0};
};

TEST(PixracerPro, SoundsItsBuzzerAtArmingFailsafeFaultAndDisarming) {
  constexpr double kSilence_s = 20.0, kHang_s = 30.0;
  Rig rig{on_board({"rc_silence@20:2"})};
  Listener listener{rig};
  while (!view_of(rig).armed && rig.flight->now() < at_s(15.0)) listener.step();
  const double armed_s = sim::to_seconds(rig.flight->now());
  ASSERT_TRUE(view_of(rig).armed);
  EXPECT_EQ(listener.beeps.size(), 0U) << "silent on the ground";
  listener.run_until(kHang_s);
  ASSERT_FALSE(listener.beeps.empty());
  EXPECT_EQ(listener.of(0.0, kSilence_s, 2500), "l");
  EXPECT_NEAR(listener.beeps.front().begin_s, armed_s, 0.02);
  EXPECT_EQ(listener.of(kSilence_s, kHang_s, 4000), "ll") << "2 s without the radio";
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kHang);
  listener.run_until(kHang_s + 3.0);
  EXPECT_EQ(listener.of(kHang_s, kHang_s + 3.0, 2000), "sss");
  while (view_of(rig).armed && rig.flight->now() < at_s(120.0)) listener.step();
  const double disarmed_s = sim::to_seconds(rig.flight->now());
  EXPECT_EQ(listener.of(kHang_s + 3.0, disarmed_s - 0.1, 0), "") << "silent in flight";
  listener.run_until(disarmed_s + 2.0);
  EXPECT_EQ(listener.of(disarmed_s - 0.1, disarmed_s + 2.0, 2500), "ss");
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
}

TEST(Varmint, HasNoBuzzer) {
  Rig rig{on_board({}, "varmint")};
  Listener listener{rig};
  listener.run_until(8.0);
  ASSERT_TRUE(view_of(rig).armed);
  EXPECT_EQ(listener.beeps.size(), 0U);
}

class LedsOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, LedsOf, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

/// As the wiring of the emulated board has them: it says by itself which level lights them.
TEST_P(LedsOf, ShowArmingAndThePilotsOverride) {
  constexpr auto kOverride = static_cast<std::size_t>(hal::Led::kOverride);
  constexpr auto kStatus = static_cast<std::size_t>(hal::Led::kStatus);
  FlightChoice choice = on_board({}, GetParam());
  choice.mission = "hop";
  Rig rig{choice};
  ASSERT_TRUE(rig.reach(Stage::kArm));
  ASSERT_FALSE(view_of(rig).armed);
  EXPECT_EQ(pins_of(rig).leds[kStatus], 0) << "disarmed, no error";
  EXPECT_EQ(pins_of(rig).leds[kOverride], 1) << "the pilot commands";
  ASSERT_TRUE(rig.reach_mission());
  ASSERT_TRUE(view_of(rig).armed);
  EXPECT_EQ(pins_of(rig).leds[kStatus], 1);
  EXPECT_EQ(pins_of(rig).leds[kOverride], 0) << "the companion commands";
}

/// After the restart the sector out of force is not blank, so the storage has something to erase.
TEST(Varmint, LeavesItsFlashAloneWhileArmed) {
  Rig rig{on_board({}, "varmint")};
  rig.run_until(20.0);
  ASSERT_TRUE(view_of(rig).armed);
  const std::uint64_t before = pins_of(rig).flash_operations;
  ASSERT_GT(before, 0U) << "parameters were stored before the flight";
  chip_of(rig).inject(boards::stm32h7::HardwareFault::kDamagedFlash);
  rig.run_for(0.01);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kCrash);
  rig.run_for(3.0);
  ASSERT_EQ(chip_of(rig).figures()->resets, 1U);
  ASSERT_TRUE(view_of(rig).armed);
  EXPECT_EQ(pins_of(rig).flash_operations, before) << "armed";
  rig.flight->run();
  ASSERT_TRUE(rig.completed()) << rig.flight->runner().failure();
  rig.run_for(3.0);
  ASSERT_FALSE(view_of(rig).armed);
  EXPECT_GT(pins_of(rig).flash_operations, before) << "disarmed";
}

}  // namespace
}  // namespace rosflight::flight::testing
