// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/vehicle_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "autonomy/estimation/read_estimator.hpp"
#include "firmware/core/mixer_frames.hpp"
#include "firmware/core/motor_model.hpp"
#include "firmware/core/parameters.hpp"
#include "flight/vehicle/frame.hpp"
#include "flight/vehicle/quadplane_setup.hpp"
#include "sim/environment/magnetic_model.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::flight {
namespace {

using companion::ParameterValue;

/// The one propeller and motor that autonomy's thrust curve knows, in the air at the origin.
autonomy::multirotor::RotorData rotor_data(const sim::MultirotorParameters& rotors,
                                           const sim::EnvironmentParameters& environment) {
  autonomy::multirotor::RotorData data;
  data.count = static_cast<int>(rotors.rotors.size());
  data.thrust_coefficient = rotors.propeller.thrust[0];
  data.torque_coefficient = rotors.propeller.torque[0];
  data.diameter_m = rotors.propeller.diameter_m;
  data.motor_constant = rotors.motor.torque_constant_Nm_A;
  data.resistance_ohm = rotors.motor.resistance_ohm;
  data.no_load_current_A = rotors.motor.no_load_current_A;
  const sim::Battery battery(rotors.battery);
  data.supply_voltage_V = battery.open_circuit_V(battery.initial_charge_As());
  data.air_density_kg_m3 =
      sim::Atmosphere(environment.atmosphere).at(environment.origin.altitude_m).density_kg_m3;
  return data;
}

/// Gain of the mixer in force from input `axis` to output `channel`.
double mixer_gain(const companion::ParameterSet& firmware, int axis, std::size_t channel) {
  const auto id = static_cast<std::int32_t>(firmware_value(firmware, "PRIMARY_MIXER"));
  if (!core::is_predefined(id))
    return firmware_value(firmware, fmt::format("PRI_MIXER_{}_{}", axis, channel));
  const core::MixerGains gains = core::frame_gains(static_cast<core::MixerId>(id));
  return static_cast<double>(gains(static_cast<Eigen::Index>(channel), axis));
}

/// Rotors that can be watched: of more than four, since four are needed to fly at all, which nothing
/// but the primary mixer drives.
autonomy::multirotor::RotorWatchConfig rotor_watch(const sim::Vehicle& vehicle,
                                                   const sim::MultirotorParameters& rotors,
                                                   const companion::ParameterSet& firmware) {
  autonomy::multirotor::RotorWatchConfig watch;
  watch.inertia_kg_m2 = vehicle.body().inertia_kg_m2;
  watch.rotor_inertia_kg_m2 = rotors.propeller.inertia_kg_m2;
  constexpr std::size_t kNeeded = 4;
  const bool one_mixer = firmware_value(firmware, "SECONDARY_MIXER") >= core::kFirstNoMixer;
  if (rotors.rotors.size() <= kNeeded || !one_mixer) return watch;
  for (const sim::RotorParameters& rotor : rotors.rotors) {
    if (rotor.tilt || rotor.output >= core::kChannels) return {};
    const auto gain = [&](int axis) { return mixer_gain(firmware, axis, rotor.output); };
    watch.rotors.push_back(
        {rotor.p_B, rotor.e_B, rotor.spin, rotor.output, {-gain(2), gain(3), gain(4), gain(5)}});
  }
  return watch;
}

/// Height of the centre of mass over its lowest point of contact.
double height_at_rest_m(const sim::Vehicle& vehicle) {
  double lowest_m = 0.0;
  for (const sim::Vector3& contact : vehicle.ground().contacts_B) {
    lowest_m = std::max(lowest_m, contact.z());
  }
  return lowest_m;
}

/// What the air does to the accelerometer; nothing is known of a plugin's forces.
autonomy::estimation::AirModel air_model(const sim::Vehicle& vehicle) {
  autonomy::estimation::AirModel air;
  const double mass_kg = vehicle.body().mass_kg;
  if (is_fixed_wing(vehicle) || is_quadplane(vehicle)) {
    const sim::AirframeParameters wing = sim::read_fixed_wing(vehicle.root()).airframe;
    air.side_area_m2_kg = std::max(0.0, -wing.side.beta) * wing.area_m2 / mass_kg;
    // In hover and in transitions rotors carry what the wing does not: the accelerometer does not show its lift.
    if (is_fixed_wing(vehicle))
      air.lift = {wing.area_m2 / mass_kg, wing.lift.zero, wing.lift.alpha};
    // The share of separated flow is a logistic function of the angle of attack: 1 % of it so many scales below the stall.
    constexpr double kScales = 4.5;
    if (wing.stall_sharpness > 0.0) {
      air.lift.linear_rad = std::max(0.0, wing.stall_angle_rad - kScales / wing.stall_sharpness);
    }
  } else if (vehicle.root().has("rotors")) {
    const sim::AeroParameters aero = sim::read_multirotor(vehicle.root()).aero;
    air.rotor_drag_s_m = aero.rotor_drag_s_m;
    air.drag_area_m2_kg = 0.5 * aero.drag_area_m2.head<2>().sum() / mass_kg;
  }
  return air;
}

/// A parameter as the section `firmware` gives it, typed and in range.
companion::NamedValue written_parameter(const config::Section& section, const std::string& name) {
  const std::size_t index = core::Parameters::find(core::padded_name(name.c_str()));
  if (name.size() > link::kParamNameLength || index == core::kParamCount) {
    throw section.error(name, section.raw(name), "the name of a firmware parameter");
  }
  const auto id = static_cast<core::Param>(index);
  const core::ParamRow& row = core::Parameters::row(id);
  const double number = section.number(name, config::Range::any());
  const bool whole = row.type == link::ParamType::kInt32;
  const bool fits = std::abs(number) < 2147483648.0;
  const core::ParamValue value =
      whole ? core::ParamValue{fits ? static_cast<std::int32_t>(number) : 0}
            : core::ParamValue{static_cast<float>(number)};
  if (!fits || (whole && number != std::trunc(number)) || !core::Parameters::in_range(id, value)) {
    throw section.error(
        name, section.raw(name),
        fmt::format("{}{} to {}", whole ? "a whole number from " : "", row.min, row.max));
  }
  return {name, whole ? ParameterValue::of(value.i) : ParameterValue::of(value.f)};
}

/// Value of PRIMARY_MIXER in a vehicle file: the custom mixer of the vehicle's own rotors.
constexpr const char* kGeometry = "geometry";

/// Parameters that `PRIMARY_MIXER: geometry` alone decides.
bool is_computed(const std::string& name) {
  return name.starts_with("PRI_MIXER_") || name == "USE_MOTOR_PARAM";
}

}  // namespace

double wmm2025_declination(const autonomy::estimation::GnssSample& fix) {
  const sim::MagneticModel model = sim::wmm2025();
  const double year = sim::decimal_year(static_cast<std::int64_t>(fix.unix_s));
  const sim::Vector3 field_W =
      model.field_W_T(fix.position, std::clamp(year, model.epoch(), model.end()));
  return std::atan2(field_W.y(), field_W.x());
}

bool is_fixed_wing(const sim::Vehicle& vehicle) {
  return vehicle.type() == "fixedwing";
}

namespace {
autonomy::BatteryConfig battery_facts(const sim::BatteryParameters& battery) {
  autonomy::BatteryConfig out;
  if (battery.constant) return out;  // never ends
  constexpr double kSecondsPerHour = 3600.0;
  out.cells = battery.cells;
  out.capacity_Ah = battery.capacity_As / kSecondsPerHour;
  out.resistance_ohm = battery.resistance_ohm;
  return out;
}
}  // namespace

sim::MultirotorParameters read_rotors(const sim::Vehicle& vehicle) {
  if (is_fixed_wing(vehicle)) return sim::read_fixed_wing(vehicle.root()).propulsion;
  if (is_quadplane(vehicle)) return sim::read_quadplane(vehicle.root()).propulsion;
  return sim::read_multirotor(vehicle.root());
}

companion::ParameterSet read_firmware_parameters(const sim::Vehicle& vehicle) {
  const config::Section& section = vehicle.firmware();
  const bool from_geometry = section.raw("PRIMARY_MIXER") == kGeometry;
  companion::ParameterSet set;
  for (const std::string& name : section.keys()) {
    if (from_geometry && is_computed(name)) {
      throw section.error(name, section.raw(name),
                          "none: PRIMARY_MIXER: geometry computes it from the section rotors");
    }
    if (from_geometry && name == "PRIMARY_MIXER") continue;
    set.push_back(written_parameter(section, name));
  }
  if (!vehicle.root().has("rotors")) return set;  // forces of a plugin
  if (from_geometry && is_quadplane(vehicle)) {
    for (const companion::NamedValue& entry : quadplane_mixers(vehicle)) {
      if (entry.name == "PRIMARY_MIXER" || !section.has(entry.name)) set.push_back(entry);
    }
    return set;
  }
  const companion::ParameterSet known =
      from_geometry ? mixer_parameters(vehicle_frame(vehicle), MixerTarget::kPrimary)
                    : motor_parameters(propulsion_frame(vehicle));
  for (const companion::NamedValue& entry : known) {
    if (entry.name == "PRIMARY_MIXER" || !section.has(entry.name)) set.push_back(entry);
  }
  return set;
}

double firmware_value(const companion::ParameterSet& set, const std::string& name) {
  for (const companion::NamedValue& entry : set) {
    if (entry.name == name) return entry.value.number();
  }
  const std::size_t index = core::Parameters::find(core::padded_name(name.c_str()));
  const core::ParamRow& row = core::Parameters::row(static_cast<core::Param>(index));
  return row.type == link::ParamType::kInt32 ? static_cast<double>(row.initial.i)
                                             : static_cast<double>(row.initial.f);
}

autonomy::multirotor::AutonomyConfig read_multirotor_autonomy(
    const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors,
    const companion::ParameterSet& firmware) {
  autonomy::multirotor::VehicleFacts facts;
  facts.mass_kg = vehicle.body().mass_kg;
  facts.gravity_m_s2 = vehicle.environment().gravity_m_s2;
  facts.rotors = rotor_data(rotors, vehicle.environment());
  facts.battery = battery_facts(rotors.battery);
  facts.rotor_watch = rotor_watch(vehicle, rotors, firmware);
  facts.throttle.rc_max_thr = firmware_value(firmware, "RC_MAX_THR");
  if (firmware_value(firmware, "USE_MOTOR_PARAM") != 0.0) {
    core::MotorModel motor;
    const auto f = [&firmware](const char* name) {
      return static_cast<float>(firmware_value(firmware, name));
    };
    motor.resistance_ohm = f("MOTOR_RESISTANCE");
    motor.kv_V_s_rad = f("MOTOR_KV");
    motor.no_load_current_A = f("NO_LOAD_CURRENT");
    motor.prop_diameter_m = f("PROP_DIAMETER");
    motor.prop_ct = f("PROP_CT");
    motor.prop_cq = f("PROP_CQ");
    motor.full_voltage_V = f("BATT_VOLT_MAX");
    motor.motor_count = static_cast<int>(firmware_value(firmware, "NUM_MOTORS"));
    facts.throttle.firmware_max_thrust_N =
        static_cast<double>(motor.max_thrust_N(static_cast<float>(facts.rotors.air_density_kg_m3)));
  }
  return autonomy::multirotor::read_autonomy(vehicle.autonomy(), facts);
}

autonomy::multirotor::AutonomyConfig read_multirotor_autonomy(const sim::Vehicle& vehicle) {
  return read_multirotor_autonomy(vehicle, sim::read_multirotor(vehicle.root()),
                                  read_firmware_parameters(vehicle));
}

autonomy::estimation::EstimatorConfig read_estimator(const sim::Vehicle& vehicle) {
  autonomy::estimation::EstimatorConfig defaults;
  defaults.gravity_m_s2 = vehicle.environment().gravity_m_s2;
  defaults.declination_at = wmm2025_declination;
  defaults.height_at_rest_m = height_at_rest_m(vehicle);
  defaults.air = air_model(vehicle);
  defaults.hovers = is_quadplane(vehicle);
  return autonomy::estimation::read_estimator(vehicle.autonomy().foreign_section("estimator"),
                                              defaults);
}

autonomy::fixedwing::AutonomyConfig read_fixedwing_autonomy(const sim::Vehicle& vehicle) {
  const sim::FixedWingParameters aircraft = sim::read_fixed_wing(vehicle.root());
  const sim::AirframeParameters& airframe = aircraft.airframe;
  const sim::EnvironmentParameters& environment = vehicle.environment();
  autonomy::fixedwing::VehicleFacts facts;
  facts.mass_kg = vehicle.body().mass_kg;
  facts.gravity_m_s2 = environment.gravity_m_s2;
  facts.wing_area_m2 = airframe.area_m2;
  facts.density_kg_m3 =
      sim::Atmosphere(environment.atmosphere).at(environment.origin.altitude_m).density_kg_m3;
  facts.battery = battery_facts(aircraft.propulsion.battery);
  facts.lift_zero = airframe.lift.zero;
  facts.lift_alpha_1_rad = airframe.lift.alpha;
  facts.pitch_zero = airframe.pitch.zero;
  facts.pitch_alpha_1_rad = airframe.pitch.alpha;
  facts.pitch_elevator_1_rad = airframe.pitch.elevator;
  return autonomy::fixedwing::read_autonomy(vehicle.autonomy(), facts);
}

}  // namespace rosflight::flight
