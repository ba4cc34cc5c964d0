// SPDX-License-Identifier: BSD-3-Clause
#include "apps/mixer_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <ostream>

#include "base/constants.hpp"
#include "companion/parameter_file.hpp"
#include "config/strict_yaml.hpp"
#include "flight/project_root.hpp"
#include "sim/registry.hpp"

namespace rosflight::apps {
namespace {

sim::Vehicle open_vehicle(const std::string& name_or_path) {
  sim::Registry registry;
  registry.add_vehicles(flight::project_root() / "vehicles");
  return registry.open_vehicle(name_or_path, {});
}

void print_check(const flight::FrameConfig& frame, std::ostream& out) {
  const flight::FrameQuality quality = flight::frame_quality(frame, flight::frame_matrix(frame));
  const flight::HoverCheck hover = flight::hover_check(frame);
  fmt::print(out, "{} motors, rank {} of 6, condition {:.1f}\n", frame.rotors.size(), quality.rank,
             quality.condition);
  fmt::print(out, "thrust gain kT {:.6e} N s^2, torque gain kQ {:.6e} N m s^2\n",
             frame.thrust_gain_N_s2(), frame.torque_gain_Nm_s2());
  fmt::print(out, "hover: {:.1f} rad/s ({:.0f} rpm), {:.2f} V, throttle {:.3f}\n",
             hover.speed_rad_s, hover.speed_rad_s * 30.0 / base::kPi, hover.voltage_V,
             hover.throttle);
  fmt::print(out, "full throttle: {:.1f} N, thrust to weight {:.2f}\n", hover.max_thrust_N,
             hover.thrust_to_weight);
  if (hover.throttle > 0.8 || hover.thrust_to_weight < 1.5) {
    fmt::print(out, "warning: little thrust is left for control\n");
  }
}

/// Gains of the attitude loops in newton metres: P = J w^2, D = 2 z w J, and P = J w_yaw.
void print_gains(const sim::Matrix3& inertia_kg_m2, std::ostream& out) {
  constexpr double kBandwidth_rad_s = 10.0;
  constexpr double kDamping = 0.7;
  constexpr double kYawBandwidth_rad_s = 4.0;
  fmt::print(out,
             "gains to start with, from the inertia ({:g} rad/s, damping {:g}; yaw {:g} rad/s):\n",
             kBandwidth_rad_s, kDamping, kYawBandwidth_rad_s);
  const char* const kAxes[] = {"ROLL", "PITCH"};
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double inertia = inertia_kg_m2(k, k);
    fmt::print(out, "  PID_{0}_ANG_P: {1:.3g}  # N m/rad\n  PID_{0}_ANG_D: {2:.3g}  # N m s/rad\n",
               kAxes[k], inertia * kBandwidth_rad_s * kBandwidth_rad_s,
               2.0 * kDamping * kBandwidth_rad_s * inertia);
  }
  fmt::print(out, "  PID_YAW_RATE_P: {:.3g}  # N m s/rad\n",
             inertia_kg_m2(2, 2) * kYawBandwidth_rad_s);
}

}  // namespace

int mixer_command(const MixerOptions& options, std::ostream& out) {
  if (options.vehicle.empty() && options.input.empty()) {
    throw config::Error("mixer: found neither --vehicle nor --param-file, allowed one of them");
  }
  const bool exists = std::filesystem::exists(options.output);
  if (exists && !options.append && !options.force) {
    throw config::Error(fmt::format(
        "{}: exists; use --append to add to it or --force to replace it", options.output));
  }
  std::optional<sim::Vehicle> vehicle;
  if (!options.vehicle.empty()) vehicle = open_vehicle(options.vehicle);
  const flight::FrameConfig frame =
      vehicle ? flight::vehicle_frame(*vehicle) : flight::read_frame(options.input);
  companion::ParameterSet set;
  if (exists && options.append) set = companion::read_parameter_file(options.output);
  for (companion::NamedValue& entry : flight::mixer_parameters(frame, options.target)) {
    std::erase_if(set,
                  [&entry](const companion::NamedValue& old) { return old.name == entry.name; });
    set.push_back(std::move(entry));
  }
  companion::write_parameter_file(options.output, set, "");
  print_check(frame, out);
  if (vehicle) print_gains(vehicle->body().inertia_kg_m2, out);
  fmt::print(out, "{} parameters in {}\n", set.size(), options.output);
  return 0;
}

}  // namespace rosflight::apps
