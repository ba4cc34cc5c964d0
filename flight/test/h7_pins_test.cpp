// SPDX-License-Identifier: BSD-3-Clause
// Output pins of the boards with an STM32H7, on the emulated chip, that are plain levels.
#include <gtest/gtest.h>

#include <string>

#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

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

}  // namespace
}  // namespace rosflight::flight::testing
