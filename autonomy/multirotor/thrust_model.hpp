// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/types.hpp"
#include "base/atmosphere.hpp"

namespace rosflight::autonomy::multirotor {

/// One rotor and its motor, as in the vehicle file; all rotors are alike.
struct RotorData {
  int count{4};
  double thrust_coefficient{};  ///< C_T at rest.
  double torque_coefficient{};  ///< C_Q at rest.
  double diameter_m{};
  double motor_constant{};  ///< K_V = K_Q [V s/rad = N m/A].
  double resistance_ohm{};
  double no_load_current_A{};
  double supply_voltage_V{};
  double air_density_kg_m3{base::kSeaLevelDensity_kg_m3};
};

/// What the flight controller does with a throttle before it reaches the motors.
struct ThrottlePath {
  double rc_max_thr{1.0};          ///< Its RC_MAX_THR: multiplies every throttle, ours too.
  double firmware_max_thrust_N{};  ///< Its T_max if USE_MOTOR_PARAM = 1; 0 if USE_MOTOR_PARAM = 0.
};

/// Thrust of the whole vehicle [N] <-> throttle as the firmware takes it [0..1].
///
/// A motor output is a fraction of the battery voltage. In steady state at rest, from the motor
/// torque balance K (V - K W)/R - K i0 = k_Q W^2 and thrust ~ W^2, with x = T/T_max at nominal
/// voltage V_n and density rho_n:
///
///     output = (V_n/V) (c0 + c1 sqrt(x rho_n/rho) + c2 x),   c0 + c1 + c2 = 1                 (1)
///     c0 = R i0/V_n,   c1 = K W_max/V_n,   c2 = R Q_max/(K V_n)
///
/// With the mixer in throttle units (USE_MOTOR_PARAM = 0) throttle = output/RC_MAX_THR. With motor
/// parameters the firmware makes newtons of it itself: throttle = T/(RC_MAX_THR T_max,firmware).
class ThrustModel {
 public:
  struct Curve {
    double max_thrust_N{};  ///< All rotors, output 1, nominal voltage and density, at rest.
    double constant{};      ///< c0 [-].
    double root{};          ///< c1 [-]; c2 is what is left to 1.
    double nominal_voltage_V{};
  };

  ThrustModel() = default;
  /// Throws std::invalid_argument naming the number that is out of range.
  ThrustModel(const Curve& curve, const ThrottlePath& path);

  /// The curve of (1) from rotor data; exact at rest.
  static Curve curve_of(const RotorData& rotors);

  /// Throttle for a thrust; below c0 and above 1 it is clipped to 0 and 1.
  /// @param voltage_V  battery now; <= 0 means nominal.
  /// @param density_ratio  rho/rho_n.
  double throttle(double thrust_N, double voltage_V = 0.0, double density_ratio = 1.0) const;
  /// Inverse of throttle().
  double thrust_N(double throttle, double voltage_V = 0.0, double density_ratio = 1.0) const;
  /// What throttle 1 gives at nominal voltage and density.
  double max_thrust_N() const { return thrust_N(1.0); }

 private:
  Curve curve_{};
  ThrottlePath path_{};
  double square_{};  // c2
};

}  // namespace rosflight::autonomy::multirotor
