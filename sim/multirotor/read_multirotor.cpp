// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "config/table.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/modules.hpp"
#include "sim/multirotor/inflow.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::sim {
namespace {

using config::kDeg;
using config::kDegPerS;
using config::Range;
using config::Row;
using config::Section;
using config::Table;
using config::Whole;

/// Unit vectors are written with few decimals; anything farther from one is a slip.
constexpr double kUnitTolerance = 1e-3;

const Range kCoefficient = Range::between(-1.0, 1.0);

bool first_is_positive(const std::array<double, 3>& coefficients) {
  return coefficients[0] > 0.0;
}

Table<TiltParameters> tilt_table() {
  using T = TiltParameters;
  using R = Row<T>;
  return {
      R{"output", &T::output, "", Whole{0, hal::kOutputs - 1},
        "of the firmware, drives the servo; each output once, rotors included"}
          .needed(),
      R{"axis", &T::axis_B, "", Range::between(-1.0, 1.0),
        "that a positive angle turns the thrust direction about, right-handed"}
          .needed()
          .must("a unit vector",
                [](const T& t) { return std::abs(t.axis_B.norm() - 1.0) <= kUnitTolerance; }),
      R{"travel_deg", &T::travel_rad, kDeg, Range::positive_up_to(90.0), "at either end"}.needed(),
      // Shorter ones need smaller steps than 2.5 ms.
      R{"time_constant_s", &T::time_constant_s, "s", Range::between(0.002, 1.0), "of the servo"}
          .needed(),
      R{"rate_limit_deg_s", &T::rate_limit_rad_s, kDegPerS, Range::positive_up_to(1e5),
        "of the servo"}
          .needed()};
}

Table<RotorParameters> rotor_table() {
  using P = RotorParameters;
  using R = Row<P>;
  return {R{"output", &P::output, "", Whole{0, hal::kOutputs - 1},
            "of the firmware, drives it; each output once"}
              .needed(),
          R{"position_m", &P::p_B, "m", Range::between(-20.0, 20.0), "hub, from the centre of mass"}
              .needed(),
          R{"thrust_direction", &P::e_B, "", Range::between(-1.0, 1.0), "(0, 0, -1): upright"}
              .needed()
              .must("a unit vector",
                    [](const P& p) { return std::abs(p.e_B.norm() - 1.0) <= kUnitTolerance; }),
          R{"spin", &P::spin, "", Range::between(-1.0, 1.0),
            "its drag turns the body along spin times thrust direction: -1 on an upright rotor "
            "turns the nose right"}
              .needed()
              .only("-1 or 1", [](double spin) { return std::abs(spin) == 1.0; }),
          R{"tilt", &P::tilt, tilt_table(), "A servo that turns the thrust direction."}};
}

Table<FlappingParameters> flapping_table() {
  using F = FlappingParameters;
  using R = Row<F>;
  return {R{"tip_pitch_deg", &F::tip_pitch_rad, kDeg, Range::between(0.0, 45.0),
            "of the blade; of a propeller of pitch p atan(p/(pi D))"}
              .needed(),
          R{"hub_stiffness_Nm_rad", &F::hub_stiffness_Nm_rad, "N m/rad",
            Range::between(0.0, 1000.0), "torque on the hub per tilt of the disc"}
              .needed()};
}

Table<PropellerParameters> propeller_table() {
  using P = PropellerParameters;
  using R = Row<P>;
  return {R{"diameter_m", &P::diameter_m, "m", Range::positive_up_to(5.0), ""}.needed(),
          R{"thrust_coefficients", &P::thrust, "", kCoefficient,
            "polynomial in the advance ratio, constant first"}
              .needed()
              .must("a first one > 0", [](const P& p) { return first_is_positive(p.thrust); }),
          R{"torque_coefficients", &P::torque, "", kCoefficient,
            "polynomial in the advance ratio, constant first"}
              .needed()
              .must("a first one > 0", [](const P& p) { return first_is_positive(p.torque); }),
          R{"inertia_kg_m2", &P::inertia_kg_m2, "kg m^2", Range::positive_up_to(10.0),
            "with the motor's bell"}
              .if_absent("needed with motor.model electrical"),
          {"descent_limit", &P::descent_limit, "", Range::between(0.0, 1.0),
           "advance ratio below which thrust grows no more in descent (vortex ring)"},
          {"flapping", &P::flapping, flapping_table(),
           "The disc tilts back in the air across it, which is drag besides aero.rotor_drag_s_m."}};
}

Table<MotorParameters> motor_table() {
  using M = MotorParameters;
  using R = Row<M>;
  return {
      R{"model",
        &M::model,
        {{"electrical", MotorModel::kElectrical},
         {"first_order", MotorModel::kFirstOrder},
         {"instant", MotorModel::kInstant}},
        "instant: as ROSflight 2.x, with a constant battery"}
          .needed(),
      R{"torque_constant_Nm_A", &M::torque_constant_Nm_A, "N m/A", Range::positive_up_to(10.0),
        "60/(2 pi KV)"}
          .needed(),
      R{"resistance_ohm", &M::resistance_ohm, "ohm", Range::positive_up_to(100.0),
        "winding, speed controller and leads"}
          .needed(),
      R{"no_load_current_A", &M::no_load_current_A, "A", Range::between(0.0, 100.0), ""}.needed(),
      // Shorter ones need smaller steps than 2.5 ms.
      R{"time_constant_s", &M::time_constant_s, "s", Range::between(0.002, 10.0),
        "of the model first_order only"}
          .needed_if("with the model first_order",
                     [](const M& m) { return m.model == MotorModel::kFirstOrder; }),
      R{"current_limit_A", &M::current_limit_A, "A", Range::positive_up_to(1e4), ""}.if_absent(
          "none"),
      {"active_braking", &M::active_braking,
       "the speed controller may push the rotor below its speed without load"}};
}

}  // namespace

Table<MultirotorParameters> rotor_parameters() {
  using M = MultirotorParameters;
  using R = Row<M>;
  return {{"layout", &M::rotors, rotor_table(), Whole{1, kMaxRotors}, "one entry per rotor"},
          {"flow",
           &M::flow,
           {{"hub", RotorFlow::kHub},
            {"reference", RotorFlow::kReference},
            {"airspeed", RotorFlow::kAirspeed}},
           "air that a rotor meets. hub: at each rotor; reference: at the centre of mass, as "
           "multirotors of ROSflight 2.x; airspeed: whatever its direction, as its fixed wings"},
          {"inflow",
           &M::inflow,
           {{"axial", RotorInflow::kAxial}, {"momentum", RotorInflow::kMomentum}},
           "momentum: air across a rotor takes its downwash away, so that it needs less power in "
           "forward "
           "flight; with flow hub and motor.model electrical"},
          R{"motor", &M::motor, motor_table()}.needed(),
          R{"propeller", &M::propeller, propeller_table()}.needed()};
}

Table<BatteryParameters> battery_parameters() {
  using B = BatteryParameters;
  using R = Row<B>;
  const std::string when = "with the model cells";
  const auto cells = [](const B& b) { return !b.constant || b.cells > 0.0; };
  return {
      R{"model",
        &B::constant,
        {{"cells", false}, {"constant", true}},
        "constant: a source without resistance and end"}
          .needed(),
      {"avionics_current_A", &B::avionics_current_A, "A", Range::between(0.0, 100.0),
       "drawn besides the motors"},
      R{"constant_voltage_V", &B::constant_voltage_V, "V", Range::positive_up_to(1000.0), ""}
          .needed_if("with the model constant", [](const B& b) { return b.constant; }),
      R{"cells", &B::cells, "", Whole{1, 100}, "in series"}.needed_if(
          when, [](const B& b) { return !b.constant; }),
      R{"capacity_Ah", &B::capacity_As, config::Unit{"Ah", 3600.0}, Range::positive_up_to(1e4), ""}
          .needed_if(when, cells),
      {"initial_charge", &B::initial_charge, "", Range::between(0.0, 1.0),
       "fraction of the capacity"},
      R{"resistance_ohm", &B::resistance_ohm, "ohm", Range::between(0.0, 10.0),
        "of the pack with its leads"}
          .needed_if(when, cells),
      R{"open_circuit_cell_V", &B::open_circuit_cell_V, "V", Range::positive_up_to(10.0),
        "of a cell at rest, at equal steps of charge from empty to full"}
          .needed_if(when, cells)
          .must("two or more", [](const B& b) { return b.open_circuit_cell_V.size() != 1; })};
}

Table<AeroParameters> aero_parameters() {
  using A = AeroParameters;
  using R = Row<A>;
  return {R{"drag_area_m2", &A::drag_area_m2, "m^2", Range::between(0.0, 100.0),
            "C_D A along body x, y, z"}
              .needed(),
          {"rotor_drag_s_m", &A::rotor_drag_s_m, "s/m", Range::between(0.0, 1.0),
           "force in the rotor plane per thrust and speed of the air in that plane"},
          R{"ground_effect",
            &A::ground_effect,
            {{"none", GroundEffect::kNone},
             {"cheeseman_bennett", GroundEffect::kCheesemanBennett},
             {"polynomial", GroundEffect::kPolynomial}},
            "polynomial: as ROSflight 2.x"}
              .needed(),
          R{"ground_effect_polynomial", &A::ground_effect_polynomial, "N/m^4 ... N", Range::any(),
            "lift over the height, highest power first"}
              .needed_if("with the ground effect polynomial",
                         [](const A& a) { return a.ground_effect == GroundEffect::kPolynomial; })};
}

namespace {

/// Makes directions exact, and rejects an output that drives two things.
void check_layout(const std::vector<Section>& layout, std::vector<RotorParameters>& rotors) {
  std::vector<std::size_t> taken;
  const auto take = [&taken](const Section& section, std::size_t output) {
    if (std::find(taken.begin(), taken.end(), output) != taken.end())
      throw section.error("output", section.raw("output") + " again", "each output once");
    taken.push_back(output);
  };
  for (std::size_t i = 0; i < layout.size(); ++i) {
    rotors[i].e_B.normalize();
    take(layout[i], rotors[i].output);
  }
  for (std::size_t i = 0; i < layout.size(); ++i) {
    if (!rotors[i].tilt) continue;
    rotors[i].tilt->axis_B.normalize();
    take(layout[i].section("tilt"), rotors[i].tilt->output);
  }
}

void check_inflow(const Section& rotors, const MultirotorParameters& p) {
  if (p.inflow == RotorInflow::kAxial) return;
  if (p.flow != RotorFlow::kHub || p.motor.model != MotorModel::kElectrical) {
    throw rotors.error("inflow", "momentum",
                       "axial, or momentum with flow hub and motor.model electrical");
  }
  const PropellerParameters& propeller = p.propeller;
  if (!(lift_slope_m3(propeller.diameter_m, propeller.thrust[0], propeller.thrust[1]) > 0.0)) {
    throw rotors.error(
        "inflow", "momentum",
        "axial, or a propeller whose thrust falls in a climb, no faster than momentum "
        "theory has it");
  }
}

}  // namespace

MultirotorParameters read_propulsion(const Section& vehicle) {
  MultirotorParameters p;
  p.aero.ground_effect = GroundEffect::kNone;
  const Section rotors = vehicle.section("rotors");
  static const Table<MultirotorParameters> rotor_table = rotor_parameters();
  rotor_table.read(rotors, p);
  const auto layout = rotors.sections("layout");
  check_layout(layout, p.rotors);
  const Section motor = rotors.section("motor");
  const Section propeller = rotors.section("propeller");
  if (p.motor.model == MotorModel::kElectrical && !propeller.has("inertia_kg_m2"))
    throw propeller.error("inertia_kg_m2", "nothing", "a number > 0 with motor.model electrical");
  const Section battery = vehicle.section("battery");
  static const Table<BatteryParameters> battery_table = battery_parameters();
  battery_table.read(battery, p.battery);
  if (p.motor.model == MotorModel::kInstant && !p.battery.constant) {
    throw motor.error("model", "instant with a battery of cells",
                      "electrical, first_order, or battery.model constant");
  }
  check_inflow(rotors, p);
  const Vector3 centre_B = centre_of_mass(vehicle);
  for (RotorParameters& rotor : p.rotors) rotor.p_B -= centre_B;
  p.aero.centre_B = -centre_B;
  rotors.finish();
  battery.finish();
  return p;
}

MultirotorParameters read_multirotor(const Section& vehicle) {
  MultirotorParameters p = read_propulsion(vehicle);
  const Section aero = vehicle.section("aero");
  static const Table<AeroParameters> aero_table = aero_parameters();
  aero_table.read(aero, p.aero);
  aero.finish();
  return p;
}

}  // namespace rosflight::sim
