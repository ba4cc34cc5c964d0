// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/quadplane_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flight/vehicle/frame.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::flight {
namespace {

using companion::ParameterValue;

constexpr double kServoRate_hz = 50.0;
constexpr int kServo = 1;
constexpr int kMotor = 2;

/// The lifting rotors as a frame of their own.
FrameConfig lifting_frame(const sim::Vehicle& vehicle, const sim::FixedWingParameters& aircraft) {
  FrameConfig frame = propulsion_frame(vehicle);
  frame.rotors.clear();
  for (const sim::RotorParameters& rotor : aircraft.propulsion.rotors) {
    if (sim::lifts(rotor)) frame.rotors.push_back({rotor.p_B, rotor.e_B, rotor.spin, rotor.output});
  }
  return frame;
}

void put(companion::ParameterSet& set, const std::string& name, ParameterValue value) {
  const auto found = std::ranges::find(set, name, &companion::NamedValue::name);
  if (found != set.end()) {
    found->value = value;
  } else {
    set.push_back({name, value});
  }
}

/// The largest lift coefficient of the wing before it stalls.
double lift_max(const sim::Airframe& airframe) {
  constexpr double kStep_rad = 0.05 * base::kRadPerDeg;
  double best = 0.0;
  for (double alpha = 0.0; alpha < 0.5; alpha += kStep_rad) {
    best = std::max(best, airframe.lift_coefficient(alpha));
  }
  return best;
}

}  // namespace

bool is_quadplane(const sim::Vehicle& vehicle) {
  return vehicle.type() == "quadplane";
}

companion::ParameterSet quadplane_mixers(const sim::Vehicle& vehicle) {
  const sim::FixedWingParameters aircraft = sim::read_quadplane(vehicle.root());
  const FrameConfig frame = lifting_frame(vehicle, aircraft);
  if (!frame_quality(frame, frame_matrix(frame)).commands_lift_and_torque) {
    throw vehicle.root().section("rotors").error(
        "layout", "lifting rotors that do not command lift, roll, pitch and yaw independently",
        "four or more that do");
  }
  companion::ParameterSet set = mixer_parameters(frame, MixerTarget::kPrimary);
  for (const auto& entry : mixer_parameters(frame, MixerTarget::kSecondary)) set.push_back(entry);
  const auto put_gain = [&set](const char* prefix, int axis, std::size_t output, double value) {
    put(set, fmt::format("{}_MIXER_{}_{}", prefix, axis, output),
        ParameterValue::of(static_cast<float>(value)));
  };
  // Canted rotors would answer a forward force too; that is the pusher's. Without those rows lift and torques are exact.
  Eigen::MatrixXd M = frame_matrix(frame);
  M.topRows(2).setZero();
  const Eigen::MatrixXd inverse = frame_inverse(M);
  for (std::size_t k = 0; k < frame.rotors.size(); ++k) {
    for (int axis = 0; axis < 6; ++axis) {
      for (const char* prefix : {"PRI", "SEC"}) {
        put_gain(prefix, axis, frame.rotors[k].output, inverse(static_cast<Eigen::Index>(k), axis));
      }
    }
  }
  const auto use = [&set](std::size_t output, int type, double rate_hz) {
    put(set, fmt::format("PRI_MIXER_OUT_{}", output), ParameterValue::of(std::int32_t{type}));
    put(set, fmt::format("PRI_MIXER_PWM_{}", output),
        ParameterValue::of(static_cast<float>(rate_hz)));
  };
  constexpr double kRotorRate_hz = 490.0;
  for (const sim::RotorParameters& rotor : aircraft.propulsion.rotors) {
    if (sim::lifts(rotor)) continue;
    use(rotor.output, kMotor, kRotorRate_hz);
    put_gain("SEC", 0, rotor.output, 1.0 / frame.thrust_gain_N_s2());
  }
  // A positive elevator pitches down, a positive rudder yaws left.
  const sim::Vector3 sign{1.0, -1.0, -1.0};
  for (const sim::SurfaceParameters& surface : aircraft.surfaces) {
    use(surface.output, kServo, kServoRate_hz);
    for (int k = 0; k < 3; ++k) {
      const double effect = sign(k) * surface.effect(k);
      if (effect != 0.0) put_gain("SEC", 6 + k, surface.output, std::copysign(1.0, effect));
    }
  }
  return set;
}

autonomy::quadplane::AutonomyConfig read_quadplane_autonomy(const sim::Vehicle& vehicle) {
  const sim::FixedWingParameters aircraft = sim::read_quadplane(vehicle.root());
  const sim::AirframeParameters& wing = aircraft.airframe;
  const sim::AeroParameters& booms = aircraft.propulsion.aero;
  const FrameConfig frame = lifting_frame(vehicle, aircraft);
  autonomy::quadplane::VehicleFacts facts;
  facts.mass_kg = vehicle.body().mass_kg;
  facts.gravity_m_s2 = vehicle.environment().gravity_m_s2;
  facts.inertia_kg_m2 = vehicle.body().inertia_kg_m2;
  facts.density_kg_m3 = frame.air_density_kg_m3;
  facts.wing_area_m2 = wing.area_m2;
  facts.span_m = wing.span_m;
  facts.chord_m = wing.chord_m;
  facts.lift_zero = wing.lift.zero;
  facts.lift_alpha_1_rad = wing.lift.alpha;
  facts.stall_alpha_rad = wing.stall_angle_rad;
  facts.stall_sharpness_1_rad = wing.stall_sharpness;
  facts.lift_max = lift_max(sim::Airframe(wing));
  facts.drag_parasitic = wing.drag.parasitic + booms.drag_area_m2.x() / wing.area_m2;
  facts.drag_induced = wing.area_m2 / (base::kPi * wing.oswald * wing.span_m * wing.span_m);
  facts.pitch_zero = wing.pitch.zero;
  facts.pitch_alpha_1_rad = wing.pitch.alpha;
  facts.pitch_q = wing.pitch.q;
  facts.roll_p = wing.roll.p;
  facts.yaw_r = wing.yaw.r;
  for (const sim::SurfaceParameters& surface : aircraft.surfaces) {
    const sim::Vector3 full = surface.travel_rad * surface.effect.cwiseAbs();
    facts.surface += full.cwiseProduct(
        sim::Vector3(wing.roll.aileron, wing.pitch.elevator, wing.yaw.rudder).cwiseAbs());
  }
  const HoverCheck hover = hover_check(frame);
  facts.max_lift_force_N = hover.max_thrust_N;
  facts.max_pusher_thrust_N = hover.max_thrust_N / static_cast<double>(frame.rotors.size());
  facts.full_voltage_V = frame.max_voltage_V;
  facts.pusher_thrust = aircraft.propulsion.propeller.thrust;
  facts.pusher_diameter_m = aircraft.propulsion.propeller.diameter_m;
  constexpr double kSecondsPerHour = 3600.0;
  const sim::BatteryParameters& battery = aircraft.propulsion.battery;
  if (!battery.constant) {
    facts.battery.cells = battery.cells;
    facts.battery.capacity_Ah = battery.capacity_As / kSecondsPerHour;
    facts.battery.resistance_ohm = battery.resistance_ohm;
  }
  return autonomy::quadplane::read_autonomy(vehicle.autonomy(), facts);
}

}  // namespace rosflight::flight
