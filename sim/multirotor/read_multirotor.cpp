// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include "sim/modules.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"

namespace rosflight::sim {
namespace {

using config::Range;
using config::Section;

const Range kCoefficient = Range::between(-1.0, 1.0);

template <std::size_t N>
std::array<double, N> fixed(const std::vector<double>& values) {
  std::array<double, N> out{};
  std::copy_n(values.begin(), N, out.begin());
  return out;
}

Vector3 vector3(const Section& section, std::string_view key, Range range) {
  const auto v = section.numbers(key, 3, range);
  return {v[0], v[1], v[2]};
}

std::vector<RotorParameters> read_layout(const Section& rotors) {
  const auto list = rotors.sections("layout");
  if (list.empty() || list.size() > kMaxRotors) {
    throw rotors.error("layout", std::to_string(list.size()) + " rotors",
                       "1 to " + std::to_string(kMaxRotors));
  }
  std::vector<RotorParameters> all;
  for (const Section& entry : list) {
    RotorParameters r;
    r.output = static_cast<std::size_t>(entry.integer("output", 0, hal::kOutputs - 1));
    for (const auto& other : all) {
      if (other.output == r.output)
        throw entry.error("output", entry.raw("output") + " again", "each output once");
    }
    r.p_B = vector3(entry, "position_m", Range::between(-20.0, 20.0));
    const Vector3 direction = vector3(entry, "thrust_direction", Range::between(-1.0, 1.0));
    // Written with few decimals; anything farther from a unit vector is a slip.
    if (std::abs(direction.norm() - 1.0) > 1e-3) {
      throw entry.error("thrust_direction",
                        "a vector of length " + config::number_text(direction.norm()),
                        "a unit vector");
    }
    r.e_B = direction.normalized();
    r.spin = static_cast<double>(entry.integer("spin", -1, 1));
    if (r.spin == 0.0) throw entry.error("spin", "0", "-1 or 1");
    all.push_back(r);
  }
  return all;
}

PropellerParameters read_propeller(const Section& section, bool needs_inertia) {
  PropellerParameters p;
  p.diameter_m = section.number("diameter_m", Range::positive_up_to(5.0));
  p.thrust = fixed<3>(section.numbers("thrust_coefficients", 3, kCoefficient));
  p.torque = fixed<3>(section.numbers("torque_coefficients", 3, kCoefficient));
  if (p.thrust[0] <= 0.0)
    throw section.error("thrust_coefficients", config::number_text(p.thrust[0]), "a first one > 0");
  if (p.torque[0] <= 0.0)
    throw section.error("torque_coefficients", config::number_text(p.torque[0]), "a first one > 0");
  const Range inertia = Range::positive_up_to(10.0);
  p.inertia_kg_m2 = needs_inertia ? section.number("inertia_kg_m2", inertia)
                                  : section.number("inertia_kg_m2", inertia, 0.0);
  p.descent_limit = section.number("descent_limit", Range::between(0.0, 1.0), p.descent_limit);
  return p;
}

MotorParameters read_motor(const Section& section) {
  MotorParameters m;
  m.model = section.choice<MotorModel>("model", {{"electrical", MotorModel::kElectrical},
                                                 {"first_order", MotorModel::kFirstOrder},
                                                 {"instant", MotorModel::kInstant}});
  m.torque_constant_Nm_A = section.number("torque_constant_Nm_A", Range::positive_up_to(10.0));
  m.resistance_ohm = section.number("resistance_ohm", Range::positive_up_to(100.0));
  m.no_load_current_A = section.number("no_load_current_A", Range::between(0.0, 100.0));
  const Range time = Range::between(0.002, 10.0);  // shorter ones need smaller steps than 2.5 ms
  if (m.model == MotorModel::kFirstOrder) {
    m.time_constant_s = section.number("time_constant_s", time);
  } else {
    section.number("time_constant_s", time, 0.05);
  }
  m.current_limit_A =
      section.number("current_limit_A", Range::positive_up_to(1e4), m.current_limit_A);
  m.active_braking = section.boolean("active_braking", m.active_braking);
  return m;
}

BatteryParameters read_battery(const Section& section) {
  enum class Model { kCell, kConstant };
  BatteryParameters b;
  b.constant = section.choice<Model>("model", {{"cells", Model::kCell},
                                               {"constant", Model::kConstant}}) == Model::kConstant;
  b.avionics_current_A = section.number("avionics_current_A", Range::between(0.0, 100.0), 0.0);
  b.constant_voltage_V = section.number("constant_voltage_V", Range::positive_up_to(1000.0), 0.0);
  if (b.constant && b.constant_voltage_V == 0.0)
    throw section.error("constant_voltage_V", "nothing", "a number > 0");
  if (!b.constant || section.has("cells")) {
    b.cells = static_cast<double>(section.integer("cells", 1, 100));
    b.capacity_As = 3600.0 * section.number("capacity_Ah", Range::positive_up_to(1e4));
    b.initial_charge = section.number("initial_charge", Range::between(0.0, 1.0), b.initial_charge);
    b.resistance_ohm = section.number("resistance_ohm", Range::between(0.0, 10.0));
    b.open_circuit_cell_V =
        section.numbers("open_circuit_cell_V", Section::kAnyCount, Range::positive_up_to(10.0));
    if (b.open_circuit_cell_V.size() < 2) {
      throw section.error("open_circuit_cell_V",
                          std::to_string(b.open_circuit_cell_V.size()) + " values", "two or more");
    }
  }
  return b;
}

AeroParameters read_aero(const Section& section) {
  AeroParameters a;
  a.drag_area_m2 = vector3(section, "drag_area_m2", Range::between(0.0, 100.0));
  a.rotor_drag_s_m = section.number("rotor_drag_s_m", Range::between(0.0, 1.0), 0.0);
  a.ground_effect = section.choice<GroundEffect>(
      "ground_effect", {{"none", GroundEffect::kNone},
                        {"cheeseman_bennett", GroundEffect::kCheesemanBennett},
                        {"polynomial", GroundEffect::kPolynomial}});
  if (a.ground_effect == GroundEffect::kPolynomial) {
    a.ground_effect_polynomial =
        fixed<5>(section.numbers("ground_effect_polynomial", 5, Range::any()));
  }
  return a;
}

}  // namespace

MultirotorParameters read_propulsion(const Section& vehicle) {
  MultirotorParameters p;
  p.aero.ground_effect = GroundEffect::kNone;
  const Section rotors = vehicle.section("rotors");
  p.rotors = read_layout(rotors);
  p.flow = rotors.choice<RotorFlow>("flow",
                                    {{"hub", RotorFlow::kHub},
                                     {"reference", RotorFlow::kReference},
                                     {"airspeed", RotorFlow::kAirspeed}},
                                    RotorFlow::kHub);
  const Section motor = rotors.section("motor");
  p.motor = read_motor(motor);
  p.propeller =
      read_propeller(rotors.section("propeller"), p.motor.model == MotorModel::kElectrical);
  const Section battery = vehicle.section("battery");
  p.battery = read_battery(battery);
  if (p.motor.model == MotorModel::kInstant && !p.battery.constant) {
    throw motor.error("model", "instant with a battery of cells",
                      "electrical, first_order, or battery.model constant");
  }
  rotors.finish();
  battery.finish();
  return p;
}

MultirotorParameters read_multirotor(const Section& vehicle) {
  MultirotorParameters p = read_propulsion(vehicle);
  p.aero = read_aero(vehicle.section("aero"));
  vehicle.section("aero").finish();
  return p;
}

}  // namespace rosflight::sim
