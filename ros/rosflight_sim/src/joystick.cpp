// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/joystick.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight_sim {

namespace {

constexpr ChannelSource axis(std::size_t index, double scale = 1.0) {
  return {ChannelSource::Kind::kAxis, index, scale, 0.0};
}
/// 0 released, 1 pressed.
constexpr ChannelSource button(std::size_t index) {
  return {ChannelSource::Kind::kButton, index, 1.0, 0.0};
}
/// -1 released, 1 pressed.
constexpr ChannelSource two_way(std::size_t index) {
  return {ChannelSource::Kind::kButton, index, 2.0, -1.0};
}

constexpr std::array<ChannelSource, kRcChannels> kSevenAxes{
    axis(0), axis(1), axis(2), axis(3), axis(4), axis(5), axis(6), ChannelSource{}};
constexpr std::array<ChannelSource, kRcChannels> kXbox{
    axis(3), axis(4), axis(1, -1.0), axis(0), button(0), button(1), button(2), button(3)};
constexpr std::array<ChannelSource, kRcChannels> kRealFlight{
    axis(0), axis(1), axis(2, -1.0), axis(4), two_way(4), two_way(0), two_way(1), two_way(2)};

constexpr std::array kMaps{
    JoystickMap{"Taranis", kSevenAxes},
    JoystickMap{"Xbox", kXbox},
    JoystickMap{"X-Box", kXbox},
    JoystickMap{"GREAT PLANES", kRealFlight},
    JoystickMap{"OpenTX RM TX16S Joystick", kSevenAxes},
    JoystickMap{"OpenTX Radiomaster Boxer Joystick", kSevenAxes},
};

double value(const ChannelSource& source, const StickState& state) {
  switch (source.kind) {
    case ChannelSource::Kind::kAxis:
      return source.scale * state.axis(source.index) + source.offset;
    case ChannelSource::Kind::kButton:
      return source.scale * state.button(source.index) + source.offset;
    case ChannelSource::Kind::kNone:
      break;
  }
  return 0.0;
}

}  // namespace

Pulses JoystickMap::pulses(const StickState& state) const {
  constexpr double kMiddle_us = 1500.0;
  constexpr double kHalfSpan_us = 500.0;
  Pulses pulses{};
  for (std::size_t i = 0; i < kRcChannels; ++i) {
    const double v = std::clamp(value(channels[i], state), -1.0, 1.0);
    pulses[i] = static_cast<std::uint16_t>(std::lround(kHalfSpan_us * v + kMiddle_us));
  }
  return pulses;
}

const JoystickMap* find_joystick_map(std::string_view device_name) {
  for (const JoystickMap& map : kMaps)
    if (device_name.find(map.name) != std::string_view::npos) return &map;
  return nullptr;
}

void Joystick::Close::operator()(SDL_Joystick* device) const {
  SDL_JoystickClose(device);
  SDL_QuitSubSystem(SDL_INIT_JOYSTICK);
}

std::optional<Joystick> Joystick::open(int index) {
  // There is no window that could have the focus, and signals are for ROS.
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  if (SDL_InitSubSystem(SDL_INIT_JOYSTICK) != 0) return std::nullopt;
  SDL_Joystick* const device = SDL_JoystickOpen(index);
  if (device == nullptr) {
    SDL_QuitSubSystem(SDL_INIT_JOYSTICK);
    return std::nullopt;
  }
  return Joystick{device};
}

std::string Joystick::name() const {
  const char* const name = SDL_JoystickName(device_.get());
  return name == nullptr ? "" : name;
}

bool Joystick::poll() {
  SDL_JoystickUpdate();
  if (SDL_JoystickGetAttached(device_.get()) == SDL_FALSE) return false;
  const auto count = [](int number) { return static_cast<std::size_t>(std::max(number, 0)); };
  state_.axes.resize(count(SDL_JoystickNumAxes(device_.get())));
  state_.buttons.resize(count(SDL_JoystickNumButtons(device_.get())));
  int number = 0;
  for (double& axis : state_.axes) {
    constexpr double kFull = 32767.0;
    axis = std::max(SDL_JoystickGetAxis(device_.get(), number++) / kFull, -1.0);
  }
  number = 0;
  for (double& button : state_.buttons) button = SDL_JoystickGetButton(device_.get(), number++);
  return true;
}

}  // namespace rosflight_sim
