// SPDX-License-Identifier: BSD-3-Clause
#include "apps/mixer_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <filesystem>
#include <ostream>

#include "companion/parameter_file.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::apps {

int mixer_command(const MixerOptions& options, std::ostream& out) {
  const bool exists = std::filesystem::exists(options.output);
  if (exists && !options.append && !options.force) {
    throw config::Error(fmt::format(
        "{}: exists; use --append to add to it or --force to replace it", options.output));
  }
  const flight::FrameConfig frame = flight::read_frame(options.input);
  companion::ParameterSet set;
  if (exists && options.append) set = companion::read_parameter_file(options.output);
  for (companion::NamedValue& entry : flight::mixer_parameters(frame, options.target)) {
    std::erase_if(set,
                  [&entry](const companion::NamedValue& old) { return old.name == entry.name; });
    set.push_back(std::move(entry));
  }
  companion::write_parameter_file(options.output, set, "");

  const flight::FrameQuality quality = flight::frame_quality(frame, flight::frame_matrix(frame));
  const flight::HoverCheck hover = flight::hover_check(frame);
  fmt::print(out, "{} motors, rank {} of 6, condition {:.1f}\n", frame.rotors.size(), quality.rank,
             quality.condition);
  fmt::print(out, "thrust gain kT {:.6e} N s^2, torque gain kQ {:.6e} N m s^2\n",
             frame.thrust_gain_N_s2(), frame.torque_gain_Nm_s2());
  fmt::print(out, "hover: {:.1f} rad/s ({:.0f} rpm), {:.2f} V, throttle {:.3f}\n",
             hover.speed_rad_s, hover.speed_rad_s * 60.0 / 6.283185307179586, hover.voltage_V,
             hover.throttle);
  fmt::print(out, "full throttle: {:.1f} N, thrust to weight {:.2f}\n", hover.max_thrust_N,
             hover.thrust_to_weight);
  if (hover.throttle > 0.8 || hover.thrust_to_weight < 1.5) {
    fmt::print(out, "warning: little thrust is left for control\n");
  }
  fmt::print(out, "{} parameters in {}\n", set.size(), options.output);
  return 0;
}

}  // namespace rosflight::apps
