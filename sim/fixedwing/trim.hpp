// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "sim/dynamics/rigid_body.hpp"
#include "sim/environment/environment.hpp"
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight::sim {

/// A steady flight: straight or a turn, level or climbing, without sideslip.
struct FlightCondition {
  double airspeed_m_s{};
  double climb_rad{0.0};      ///< Angle of the path above the horizon.
  double turn_radius_m{0.0};  ///< Path over ground, positive to the right; 0: straight.
  double height_m{0.0};       ///< Above the origin, for the air's density.
};

/// State and outputs that hold a condition.
struct Trim {
  FlightCondition condition;
  Air air;
  double alpha_rad{};
  double roll_rad{};
  double pitch_rad{};
  double throttle{};  ///< Output of every motor.
  Deflection deflection;
  BodyState body;  ///< Heading north, at the condition's height.
  std::vector<double> module_state;
  hal::OutputValues outputs{};
  Wrench wrench;          ///< Wrench of the module.
  double thrust_N{};      ///< Force along body x of the rotors alone.
  double lift_to_drag{};  ///< Lift-to-drag ratio of the airframe.
  /// Residual dv/dt and dw/dt of the equations of motion; not 0 because the outputs are floats.
  Vector3 acceleration_B{Vector3::Zero()};
  Vector3 angular_acceleration_B{Vector3::Zero()};
};

/// The body and air that a trim is for.
struct TrimVehicle {
  const FixedWing& forces;
  const BodyParameters& body;
  const EnvironmentParameters& environment;
};

/// Finds angle of attack, attitude, throttle, rotor speeds and deflections at which nothing
/// accelerates, by Newton's method with a halved step where a whole one does not help:
///
///     0 = f/m + R^T g - w x v          0 = tau - w x J w          0 = dO/dt
///     v = V (cos alpha, 0, sin alpha)  w = R^T (0, 0, V cos(climb)/radius)
///     R v has the climb's angle
///
/// (R. Beard, T. McLain, "Small Unmanned Aircraft", 2012, sec. 5.3, with the path's angle as one
/// more equation instead of its closed form). Still air.
/// @throws std::runtime_error with the reason, in words: more than full throttle or deflection, no
/// equilibrium.
Trim find_trim(const TrimVehicle& vehicle, const FlightCondition& condition);

/// One mode of motion of a small deviation from a trim.
struct Mode {
  std::string name;  ///< "phugoid", "short period", "Dutch roll", "roll", "spiral", "motor".
  double real_1_s{};
  double imaginary_rad_s{};  ///< >= 0; other than 0: a pair.

  double frequency_rad_s() const;  ///< Natural: modulus of the eigenvalue.
  double damping_ratio() const;
};

/// Eigenvalues of the equations of motion linearised at a trim, deflections held: velocity, rates,
/// roll, pitch and rotor speeds; by central differences. Named by what moves (participation
/// factors: I. Perez-Arriaga et al., IEEE Trans. PAS-101, 1982) and, within that, by the modulus.
/// Height, heading, charge and servos are left out.
std::vector<Mode> find_modes(const TrimVehicle& vehicle, const Trim& trim);

/// Lanchester's phugoid, which trades height for speed at constant lift coefficient (F. Lanchester,
/// "Aerodonetics", 1908; B. Etkin, "Dynamics of Flight", sec. 6.3): frequency sqrt(2) g/V and,
/// with the drag of constant thrust, damping 1/(sqrt(2) L/D).
Mode lanchester_phugoid(double airspeed_m_s, double lift_to_drag, double gravity_m_s2);

}  // namespace rosflight::sim
