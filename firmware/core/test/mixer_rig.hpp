// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/mixer.hpp"
#include "firmware/core/mixer_frames.hpp"
#include "firmware/core/test/test_values.hpp"

/// Mixers, commands and conditions for the mixer's tests.
namespace rosflight::core::mixer_rig {

using Inputs = std::array<float, kAxes>;

inline Mixer make_mixer(MixerId id, const Mixer::Config& config = {}) {
  Mixer m;
  m.configure(config);
  m.set_header(frame_header(id));
  m.primary() = m.secondary() = frame_gains(id);
  m.set_valid(true);
  return m;
}

inline Mixer custom_mixer(const std::array<OutputType, kChannels>& types,
                          const Mixer::Config& config = {}) {
  Mixer m;
  m.configure(config);
  MixerHeader header;
  header.type = types;
  m.set_header(header);
  m.set_valid(true);
  return m;
}

inline Mixer::Conditions armed(std::uint16_t primary_axes = 0x3FF) {
  Mixer::Conditions c;
  c.armed = true;
  c.battery_V = 24.0f;
  c.primary_axes = primary_axes;
  c.companion_present = true;
  return c;
}
inline Mixer::Conditions disarmed() {
  Mixer::Conditions c = armed();
  c.armed = false;
  return c;
}

/// Forces and torques of a multirotor.
inline Inputs wrench(float fz, float qx = 0, float qy = 0, float qz = 0) {
  return {0, 0, fz, qx, qy, qz};
}

inline void expect_near(const hal::OutputValues& out, std::initializer_list<float> expected) {
  std::size_t k = 0;
  for (const float value : expected) {
    EXPECT_NEAR(out[k], value, 1e-5f) << "channel " << k;
    ++k;
  }
}

inline link::AuxCommand aux(std::size_t channel, link::AuxType type, float value) {
  link::AuxCommand command;
  command.type[channel] = static_cast<std::uint8_t>(type);
  command.value[channel] = value;
  return command;
}

}  // namespace rosflight::core::mixer_rig
