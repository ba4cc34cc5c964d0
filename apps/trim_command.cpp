// SPDX-License-Identifier: BSD-3-Clause
#include "apps/trim_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <stdexcept>

#include "base/constants.hpp"
#include "flight/project_root.hpp"
#include "sim/fixedwing/trim.hpp"
#include "sim/registry.hpp"

namespace rosflight::apps {
namespace {

using base::kRadPerDeg;

void check(const char* option, double value, const config::Range& range) {
  if (range.contains(value)) return;
  throw config::Error(fmt::format("{}: found {}, allowed {}", option, value, range.text()));
}

sim::Vehicle open_vehicle(const TrimOptions& options) {
  sim::Registry registry;
  sim::register_physics(registry);
  registry.add_vehicles(flight::project_root() / "vehicles");
  sim::Vehicle vehicle = registry.open_vehicle(options.vehicle, options.overrides);
  if (vehicle.type() != "fixedwing") {
    throw config::Error(fmt::format("--vehicle: found {} of type {}, allowed one of type fixedwing",
                                    options.vehicle, vehicle.type()));
  }
  return vehicle;
}

sim::FlightCondition condition_of(const TrimOptions& options) {
  check("--speed", options.speed_m_s, config::Range::positive_up_to(200.0));
  check("--climb", options.climb_deg, config::Range::between(-60.0, 60.0));
  check("--height", options.height_m, config::Range::between(-500.0, 10000.0));
  const double radius = options.radius_m.value_or(0.0);
  if (options.radius_m && !config::Range::between(1.0, 1e6).contains(std::abs(radius))) {
    throw config::Error(fmt::format(
        "--radius: found {}, allowed 1 to 1000000 m, right turns positive, left ones negative",
        radius));
  }
  return {options.speed_m_s, options.climb_deg * kRadPerDeg, radius, options.height_m};
}

void print(const TrimOptions& options, const sim::Trim& trim, std::size_t rotors,
           std::ostream& out) {
  const sim::FlightCondition& c = trim.condition;
  fmt::print(
      out, "{} at {} m/s, {}{}, air of {:.4f} kg/m^3\n", options.vehicle, c.airspeed_m_s,
      options.climb_deg == 0.0 ? "level" : fmt::format("climbing by {} deg", options.climb_deg),
      c.turn_radius_m == 0.0
          ? std::string(", straight")
          : fmt::format(", turning {} with a radius of {} m",
                        c.turn_radius_m > 0.0 ? "right" : "left", std::abs(c.turn_radius_m)),
      trim.air.density_kg_m3);
  const auto row = [&out](const char* name, double value, const char* unit) {
    fmt::print(out, "  {:<22}{:>10.4f} {}\n", name, value, unit);
  };
  row("angle of attack", trim.alpha_rad / kRadPerDeg, "deg");
  row("roll", trim.roll_rad / kRadPerDeg, "deg");
  row("pitch", trim.pitch_rad / kRadPerDeg, "deg");
  row("throttle", trim.throttle, "");
  row("aileron", trim.deflection.aileron_rad / kRadPerDeg, "deg");
  row("elevator", trim.deflection.elevator_rad / kRadPerDeg, "deg");
  row("rudder", trim.deflection.rudder_rad / kRadPerDeg, "deg");
  for (std::size_t i = 0; i < rotors; ++i) row("rotor", trim.module_state[i], "rad/s");
  row("thrust", trim.thrust_N, "N");
  row("lift to drag", trim.lift_to_drag, "");
  fmt::print(out, "  {:<22}{:>10.1e} m/s^2, {:.1e} rad/s^2\n", "left over",
             trim.acceleration_B.norm(), trim.angular_acceleration_B.norm());
}

/// "doubles in 12.3 s" or "halves in ...".
std::string pace(const sim::Mode& mode) {
  if (mode.real_1_s == 0.0) return "stays";
  return fmt::format("{} in {:.2f} s", mode.real_1_s > 0.0 ? "doubles" : "halves",
                     std::numbers::ln2 / std::abs(mode.real_1_s));
}

void print(const sim::Mode& mode, const std::string& name, std::ostream& out) {
  if (mode.imaginary_rad_s > 0.0) {
    fmt::print(out, "  {:<16}{:>10.4f} +-{:>9.4f} i   {:>8.4f} rad/s  damping {:>6.3f}  {}\n", name,
               mode.real_1_s, mode.imaginary_rad_s, mode.frequency_rad_s(), mode.damping_ratio(),
               pace(mode));
  } else {
    fmt::print(out, "  {:<16}{:>10.4f}{:>49}{}\n", name, mode.real_1_s, "", pace(mode));
  }
}

}  // namespace

int trim_command(const TrimOptions& options, std::ostream& out) {
  const sim::FlightCondition condition = condition_of(options);
  const sim::Vehicle vehicle = open_vehicle(options);
  const sim::FixedWing forces(sim::read_fixed_wing(vehicle.root()));
  vehicle.finish();
  const sim::TrimVehicle subject{forces, vehicle.body(), vehicle.environment()};
  sim::Trim trim;
  try {
    trim = sim::find_trim(subject, condition);
  } catch (const std::runtime_error& error) {
    throw config::Error(fmt::format("--speed: found {}, allowed what {} can hold: this {}",
                                    options.speed_m_s, options.vehicle, error.what()));
  }
  const auto& propulsion = forces.parameters().propulsion;
  const bool instant = propulsion.motor.model == sim::MotorModel::kInstant;
  print(options, trim, instant ? 0 : propulsion.rotors.size(), out);

  fmt::print(out, "modes, eigenvalues [1/s] of small deviations\n");
  const sim::Mode* phugoid = nullptr;
  const std::vector<sim::Mode> modes = sim::find_modes(subject, trim);
  for (const sim::Mode& mode : modes) {
    print(mode, mode.name, out);
    if (mode.name == "phugoid" && mode.imaginary_rad_s > 0.0) phugoid = &mode;
  }
  const sim::Mode lanchester = sim::lanchester_phugoid(condition.airspeed_m_s, trim.lift_to_drag,
                                                       vehicle.environment().gravity_m_s2);
  print(lanchester, "(Lanchester)", out);
  if (phugoid != nullptr) {
    fmt::print(out, "  the phugoid's frequency is {:.3f} of Lanchester's\n",
               phugoid->frequency_rad_s() / lanchester.frequency_rad_s());
  } else {
    fmt::print(out, "  there is no oscillating phugoid to compare with Lanchester's\n");
  }
  return 0;
}

}  // namespace rosflight::apps
