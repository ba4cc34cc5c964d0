// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "base/constants.hpp"
#include "sim/lanes.hpp"

/// Air that a rotor itself accelerates through its disc, by momentum theory. V >= 0 is the velocity of the
/// rotor along its thrust, v' that across it, v_h the induced velocity of the same thrust in hover:
/// v_h^2 = T/(2 rho A).
namespace rosflight::sim {

/// In axial flight: v = -V/2 + sqrt(V^2/4 + v_h^2) (W. Rankine, W. Froude; J. G. Leishman, Principles of
/// Helicopter Aerodynamics, 2nd ed., sec. 2.13).
ROSFLIGHT_INLINE Lanes axial_inflow(const Lanes& along, const Lanes& hover_sq) {
  const Lanes half = 0.5 * along;
  return sqrt(half * half + hover_sq) - half;
}

/// In any flight, H. Glauert's equation (ARC R&M 1111, 1926; Leishman, sec. 2.14) for a rotor whose thrust
/// grows by `slope` where its inflow falls short of that of axial flight, v_a:
///
///     v sqrt(v'^2 + (V + v)^2) = v_h^2 + slope (v_a - v)
///
/// Newton's method from v_a, where the left side is the larger, in a fixed number of steps: for slope 0 the
/// error is below 1e-9 v_h at any speed up to 20 v_h.
ROSFLIGHT_INLINE Lanes forward_inflow(const Lanes& along, const Lanes& across_sq,
                                      const Lanes& hover_sq, const Lanes& slope,
                                      const Lanes& axial) {
  constexpr int kSteps = 7;
  constexpr double kStill_m_s = 1e-9;
  Lanes v = axial;
  for (int i = 0; i < kSteps; ++i) {
    const Lanes through = along + v;
    const Lanes speed = max(sqrt(across_sq + through * through), kStill_m_s);
    const Lanes excess = v * speed - hover_sq - slope * (axial - v);
    v = v - excess / (speed + v * through / speed + slope);
  }
  return v;
}

/// The lift slope a [m^3] of a propeller's blades: thrust lost per air density, rotor speed and inflow. C_T(J) =
/// CT0 + CT1 J says what a slow climb V costs, M = -CT1 D^3/(2 pi). There the inflow grows by V/2 and, as the
/// thrust falls, by less than that; with v_h = H times the rotor speed, H = D/(2 pi) sqrt(2 CT0/pi), A the disc:
///
///     a = M/(1/2 - M/(4 A H))
///
/// Not positive for a propeller whose thrust does not fall in a climb, or falls faster than momentum allows.
inline double lift_slope_m3(double diameter_m, double ct0, double ct1) {
  constexpr double kPi = base::kPi;
  const double lost = -ct1 * diameter_m * diameter_m * diameter_m / (2.0 * kPi);
  const double hover_m = diameter_m / (2.0 * kPi) * std::sqrt(2.0 * ct0 / kPi);
  const double disc_m2 = 0.25 * kPi * diameter_m * diameter_m;
  return lost / (0.5 - lost / (4.0 * disc_m2 * hover_m));
}

}  // namespace rosflight::sim
