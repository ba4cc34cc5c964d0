// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include "firmware/core/command.hpp"

/// A command manager with a pilot and a companion.
namespace rosflight::core {

using hal::milliseconds;
using link::OffboardMode;

inline constexpr auto kAngles = static_cast<std::uint8_t>(OffboardMode::kRollPitchYawrateThrottle);
inline constexpr auto kRates = static_cast<std::uint8_t>(OffboardMode::kRatesThrottle);
inline constexpr auto kPassThrough = static_cast<std::uint8_t>(OffboardMode::kPassThrough);
inline constexpr std::uint16_t kNobodyOffboard = 0x3C0;

class CommandTest : public testing::Test {
 protected:
  CommandTest() { command_.configure(config_); }

  void configure() { command_.configure(config_); }

  /// One pass with a new receiver frame.
  bool pass(std::int64_t after_ms = 20) {
    now_ += milliseconds(after_ms);
    return command_.update(now_, pilot_, true, failsafe_);
  }
  /// One pass between receiver frames.
  bool idle(std::int64_t after_ms) {
    now_ += milliseconds(after_ms);
    return command_.update(now_, pilot_, false, failsafe_);
  }
  bool offboard(std::uint8_t mode, std::array<float, 10> u, std::uint16_t ignore = 0,
                float thrust = 0.0f) {
    return command_.set_offboard(now_, {mode, ignore, u}, thrust);
  }
  /// A companion that has everything, in angle mode, with the throttle below the pilot's.
  void companion_flies() {
    pilot_.throttle = 0.9f;
    ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f, 1.0f, 2.0f, 3.0f, 4.0f}));
  }
  void set_switch(Switch s, bool on) { pilot_.on[static_cast<std::size_t>(s)] = on; }
  float combined(std::size_t k) const { return command_.combined().value[k]; }
  CommandType type(std::size_t k) const { return command_.combined().type[k]; }
  std::uint16_t word() const { return command_.override_word(); }

  CommandManager command_;
  CommandManager::Config config_;
  PilotInput pilot_;
  Time now_{milliseconds(10'000)};
  bool failsafe_{false};
};

}  // namespace rosflight::core
