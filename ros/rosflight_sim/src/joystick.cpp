// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rosflight_sim/src/joystick.hpp"

#include <fcntl.h>
#include <linux/joystick.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace rosflight::ros_sim {
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

void set(std::vector<double>& values, std::size_t index, double value) {
  if (index >= values.size()) values.resize(index + 1, 0.0);
  values[index] = value;
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

std::optional<Joystick> Joystick::open(const std::string& device) {
  base::FileDescriptor file{::open(device.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  if (!file.valid()) return std::nullopt;
  std::array<char, 128> name{};
  if (::ioctl(file.get(), JSIOCGNAME(name.size() - 1), name.data()) < 0) return std::nullopt;
  return Joystick{std::move(file), name.data()};
}

bool Joystick::poll() {
  js_event event{};
  ssize_t count = 0;
  while ((count = ::read(events_.get(), &event, sizeof event)) == sizeof event) {
    constexpr double kFull = 32767.0;
    if ((event.type & JS_EVENT_AXIS) != 0) {
      set(state_.axes, event.number, std::max(event.value / kFull, -1.0));
    } else if ((event.type & JS_EVENT_BUTTON) != 0) {
      set(state_.buttons, event.number, event.value != 0 ? 1.0 : 0.0);
    }
  }
  return count < 0 && (errno == EAGAIN || errno == EINTR);
}

}  // namespace rosflight::ros_sim
