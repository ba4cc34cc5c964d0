// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <SDL.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rosflight_sim {

/// Axes -1..1 and buttons 0 or 1 of a controller; what it does not have reads 0.
struct StickState {
  std::vector<double> axes;
  std::vector<double> buttons;

  double axis(std::size_t i) const { return i < axes.size() ? axes[i] : 0.0; }
  double button(std::size_t i) const { return i < buttons.size() ? buttons[i] : 0.0; }
};

inline constexpr std::size_t kRcChannels = 8;
using Pulses = std::array<std::uint16_t, kRcChannels>;

/// Where a channel of a controller comes from: value = scale * input + offset, -1..1.
struct ChannelSource {
  enum class Kind : std::uint8_t { kNone, kAxis, kButton };
  Kind kind{Kind::kNone};
  std::size_t index{};
  double scale{1.0};
  double offset{0.0};
};

/// Aileron, elevator, throttle, rudder, four switches.
struct JoystickMap {
  std::string_view name;
  std::array<ChannelSource, kRcChannels> channels;

  /// round(500 value + 1500), 1000..2000.
  Pulses pulses(const StickState& state) const;
};

/// The map of a controller by the name that the system gives it; nothing for an unknown one.
/// Controllers and axes of ROSflight 2.x's simulator.
const JoystickMap* find_joystick_map(std::string_view device_name);

/// A controller, by SDL: axes and buttons are numbered as in ROSflight 2.x, which uses SDL too. Never blocks. One thread.
class Joystick {
 public:
  /// @param index  From 0, in the order of SDL. @returns nothing if there are not so many.
  static std::optional<Joystick> open(int index);

  std::string name() const;
  /// Takes what has happened since. @returns false once the device has gone.
  bool poll();
  const StickState& state() const { return state_; }

 private:
  struct Close {
    void operator()(SDL_Joystick* device) const;
  };
  explicit Joystick(SDL_Joystick* device) : device_{device} {}

  std::unique_ptr<SDL_Joystick, Close> device_;
  StickState state_;
};

}  // namespace rosflight_sim
