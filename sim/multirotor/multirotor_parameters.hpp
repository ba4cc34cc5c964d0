// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "config/strict_yaml.hpp"
#include "sim/multirotor/battery.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {

enum class MotorModel {
  kElectrical,  ///< Rotor inertia under motor and air torque: J_r dOmega/dt = tau_m - Q.
  kFirstOrder,  ///< Speed follows its steady state with a time constant.
  kInstant      ///< Speed is at its steady state: ROSflight 2.x.
};

enum class RotorFlow {
  kHub,        ///< Air velocity at each hub, coefficients continued smoothly into descent.
  kReference,  ///< Air velocity at the centre of mass, no inflow in descent, coefficients kept
               ///< positive: multirotors of ROSflight 2.x.
  kAirspeed    ///< The airspeed, whatever its direction: fixed wings of ROSflight 2.x.
};

enum class RotorInflow {
  kAxial,    ///< Thrust and torque depend on the air along the thrust alone.
  kMomentum  ///< Air across the rotor takes its own downwash away: more thrust, less torque.
};

enum class GroundEffect {
  kNone,
  kCheesemanBennett,  ///< Thrust grows by 1/(1 - (R/4z)^2), z the hub's height.
  kPolynomial         ///< A lift of its own, quartic in height: ROSflight 2.x.
};

/// A servo that turns a rotor about an axis through its hub.
struct TiltParameters {
  std::size_t output{};  ///< Channel of the firmware that drives it: 0..1, 0.5 in the centre.
  Vector3 axis_B{Vector3::UnitX()};  ///< Unit vector; a positive angle turns right-handed about it.
  double travel_rad{};               ///< Angle at either end.
  double time_constant_s{};
  double rate_limit_rad_s{};
};

struct RotorParameters {
  std::size_t output{};                ///< Channel of the firmware that drives it.
  Vector3 p_B{Vector3::Zero()};        ///< Hub from the centre of mass [m].
  Vector3 e_B{-Vector3::UnitZ()};      ///< Unit thrust direction.
  double spin{1.0};                    ///< +1 or -1: drag torque on the body acts along spin * e_B.
  std::optional<TiltParameters> tilt;  ///< Turns e_B.
};

/// Blades that flap at a hub without hinges.
struct FlappingParameters {
  double tip_pitch_rad{};         ///< Pitch angle of the blade at its tip.
  double hub_stiffness_Nm_rad{};  ///< Torque on the hub per tilt of the disc.
};

/// All propellers alike: C(J) = c0 + c1 J + c2 J^2 over the advance ratio J = 2 pi V/(Omega D).
struct PropellerParameters {
  double diameter_m{};
  std::array<double, 3> thrust{};
  std::array<double, 3> torque{};
  double inertia_kg_m2{};  ///< Propeller with the motor's bell; 0 only where no model needs it.
  double descent_limit{
      0.12};  ///< Advance ratio below which thrust grows no more in descent (vortex ring).
  std::optional<FlappingParameters> flapping;  ///< Absent: the disc does not tilt.
};

struct MotorParameters {
  MotorModel model{MotorModel::kElectrical};
  double torque_constant_Nm_A{};  ///< K_Q; the back-EMF constant K_V [V s/rad] is the same number.
  double resistance_ohm{};        ///< Winding, ESC and leads.
  double no_load_current_A{};
  double time_constant_s{};  ///< Only with kFirstOrder.
  double current_limit_A{1e9};
  bool active_braking{true};  ///< The ESC may push the rotor below its no-load speed (current < 0).
};

struct AeroParameters {
  Vector3 drag_area_m2{Vector3::Zero()};  ///< C_D A along body x, y, z.
  double rotor_drag_s_m{};                ///< In-plane force per thrust and in-plane air speed.
  Vector3 centre_B{Vector3::Zero()};      ///< Where the drag acts, from the centre of mass [m].
  GroundEffect ground_effect{GroundEffect::kCheesemanBennett};
  std::array<double, 5> ground_effect_polynomial{};  ///< g0..g4, highest power first [N/m^4 ... N].
};

struct MultirotorParameters {
  std::vector<RotorParameters> rotors;
  PropellerParameters propeller;
  MotorParameters motor;
  RotorFlow flow{RotorFlow::kHub};
  RotorInflow inflow{RotorInflow::kAxial};
  BatteryParameters battery;
  AeroParameters aero;
};

/// Reads sections `rotors` and `battery` of a vehicle file: propulsion alone, for vehicles whose
/// aerodynamics are their own. Throws config::Error.
MultirotorParameters read_propulsion(const config::Section& vehicle);

/// Reads sections `rotors`, `battery` and `aero` of a vehicle file. Throws config::Error.
MultirotorParameters read_multirotor(const config::Section& vehicle);

}  // namespace rosflight::sim
