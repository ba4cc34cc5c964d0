// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <optional>

#include "rosflight_sim/joystick.hpp"
#include "rosflight_sim/keyboard.hpp"

namespace rosflight_sim {
namespace {

using Time = KeyboardSticks::Time;

Pulses pulses_of(const char* device, const StickState& state) {
  const JoystickMap* map = find_joystick_map(device);
  return map == nullptr ? Pulses{} : map->pulses(state);
}

// Tables of ROSflight 2.x's simulator, one number per column.
TEST(JoystickMaps, SevenAxesOfTransmitters) {
  const StickState state{{-1.0, -0.5, 0.0, 0.5, 1.0, -1.0, 0.25}, {}};
  const Pulses expected{1000, 1250, 1500, 1750, 2000, 1000, 1625, 1500};
  EXPECT_EQ(pulses_of("FrSky Taranis Joystick", state), expected);
  EXPECT_EQ(pulses_of("OpenTX RM TX16S Joystick", state), expected);
  EXPECT_EQ(pulses_of("OpenTX Radiomaster Boxer Joystick", state), expected);
}

TEST(JoystickMaps, XboxThrottleIsTurnedRoundAndButtonsAreHalfWay) {
  const StickState state{{0.2, -1.0, 0.0, 0.4, -0.6}, {1.0, 0.0, 1.0, 0.0}};
  const Pulses expected{1700, 1200, 2000, 1600, 2000, 1500, 2000, 1500};
  EXPECT_EQ(pulses_of("Microsoft X-Box 360 pad", state), expected);
  EXPECT_EQ(pulses_of("Xbox Wireless Controller", state), expected);
}

TEST(JoystickMaps, RealFlightButtonsAreTwoWay) {
  const StickState state{{0.1, 0.2, 0.3, 0.9, 0.4}, {1.0, 0.0, 1.0, 0.0, 1.0}};
  const Pulses expected{1550, 1600, 1350, 1700, 2000, 2000, 1000, 2000};
  EXPECT_EQ(pulses_of("GREAT PLANES InterLink-X", state), expected);
}

TEST(JoystickMaps, AnUnknownDeviceHasNone) {
  EXPECT_EQ(find_joystick_map("Flight Yoke 3000"), nullptr);
}

TEST(JoystickMaps, WhatADeviceDoesNotHaveIsInTheMiddle) {
  EXPECT_EQ(pulses_of("Taranis", {}), (Pulses{1500, 1500, 1500, 1500, 1500, 1500, 1500, 1500}));
}

TEST(Joystick, TakesAxesAndButtonsAndNoticesTheEnd) {
  ASSERT_EQ(SDL_InitSubSystem(SDL_INIT_JOYSTICK), 0) << SDL_GetError();
  const int index = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, 3, 4, 0);
  ASSERT_GE(index, 0) << SDL_GetError();
  std::optional<Joystick> joystick = Joystick::open(index);
  ASSERT_TRUE(joystick);
  EXPECT_FALSE(joystick->name().empty());
  EXPECT_TRUE(joystick->poll());
  SDL_Joystick* const device = SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(index));
  SDL_JoystickSetVirtualAxis(device, 2, 32767);
  SDL_JoystickSetVirtualAxis(device, 0, -32768);
  SDL_JoystickSetVirtualButton(device, 3, 1);
  EXPECT_TRUE(joystick->poll());
  EXPECT_EQ(joystick->state().axis(2), 1.0);
  EXPECT_EQ(joystick->state().axis(0), -1.0);
  EXPECT_EQ(joystick->state().axis(1), 0.0);
  EXPECT_EQ(joystick->state().button(3), 1.0);
  EXPECT_EQ(joystick->state().axis(9), 0.0);
  SDL_JoystickDetachVirtual(index);
  EXPECT_FALSE(joystick->poll());
  joystick.reset();
  SDL_QuitSubSystem(SDL_INIT_JOYSTICK);
}

TEST(Joystick, ThereAreNotSoMany) {
  EXPECT_FALSE(Joystick::open(99));
}

TEST(Keyboard, KeysGoWhereTheirLabelsSay) {
  KeyboardSticks sticks{1.0};
  sticks.stroke('h', Time{0});  // roll left
  sticks.stroke('k', Time{0});  // nose down: stick forward is 1000
  sticks.stroke('d', Time{0});  // nose left
  const Pulses p = sticks.pulses(Time{1});
  EXPECT_EQ(p[0], 1000);
  EXPECT_EQ(p[1], 1000);
  EXPECT_EQ(p[3], 1000);
  sticks.stroke('l', Time{2});
  sticks.stroke('j', Time{2});
  sticks.stroke('f', Time{2});
  const Pulses q = sticks.pulses(Time{3});
  EXPECT_EQ(q[0], 2000);
  EXPECT_EQ(q[1], 2000);
  EXPECT_EQ(q[3], 2000);
}

TEST(Keyboard, ADeflectionEndsSoonAfterTheLastStroke) {
  KeyboardSticks sticks{0.4};
  sticks.stroke('l', Time{0});
  EXPECT_EQ(sticks.pulses(Time{599})[0], 1700);
  EXPECT_EQ(sticks.pulses(Time{600})[0], 1500);
  sticks.stroke('l', Time{1000});
  for (int t = 1500; t <= 3000; t += 33) sticks.stroke('l', Time{t});  // held down
  EXPECT_EQ(sticks.pulses(Time{3100})[0], 1700);
  EXPECT_EQ(sticks.pulses(Time{3120})[0], 1500);
}

TEST(Keyboard, ThrottleHoldsAndStopsAtItsEnds) {
  KeyboardSticks sticks{1.0};
  EXPECT_EQ(sticks.pulses(Time{0})[2], 1000);
  sticks.stroke('s', Time{0});
  EXPECT_EQ(sticks.pulses(Time{0})[2], 1000);
  for (int i = 0; i < 50; ++i) sticks.stroke('a', Time{i});
  EXPECT_EQ(sticks.pulses(Time{9999})[2], 1500);
  for (int i = 0; i < 100; ++i) sticks.stroke('a', Time{i});
  EXPECT_EQ(sticks.pulses(Time{9999})[2], 2000);
}

TEST(Keyboard, SwitchesFlip) {
  KeyboardSticks sticks{1.0};
  EXPECT_EQ(sticks.pulses(Time{0})[4], 1000);  // disarmed
  EXPECT_EQ(sticks.pulses(Time{0})[5], 2000);  // override
  EXPECT_EQ(sticks.pulses(Time{0})[6], 2000);  // angles
  for (const char key : {'t', 'r', 'm', '?'}) sticks.stroke(key, Time{0});
  EXPECT_EQ(sticks.pulses(Time{0})[4], 2000);
  EXPECT_EQ(sticks.pulses(Time{0})[5], 1000);
  EXPECT_EQ(sticks.pulses(Time{0})[6], 1000);
}

}  // namespace
}  // namespace rosflight_sim
