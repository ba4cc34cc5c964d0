// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::core {

/// Model of one motor with its propeller (parameters MOTOR_..., PROP_...).
///
/// Torque of the motor equals torque of the propeller (ROSflight 2.0 paper, appendix):
///
///     K_Q [(V - K_V W)/R - i0] = rho D^5 C_Q W^2 / (4 pi^2)                               (1)
///
/// with K_Q = K_V in SI units; thrust rho D^4 C_T W^2 / (4 pi^2).
struct MotorModel {
  float resistance_ohm{0.042f};
  float kv_V_s_rad{0.01706f};
  float no_load_current_A{1.5f};
  float prop_diameter_m{0.381f};
  float prop_ct{0.075f};
  float prop_cq{0.0045f};
  float full_voltage_V{25.0f};
  int motor_count{4};

  static constexpr float kMinKv = 1e-7f;
  bool usable() const { return kv_V_s_rad > kMinKv; }

  /// Voltage that turns the rotor at sqrt(speed_sq) in steady state; (1) solved for V.
  float voltage_V(float speed_sq_rad2_s2, float density_kg_m3) const;
  /// Squared speed at a voltage; the positive root of (1), 0 below the starting voltage.
  float speed_sq_rad2_s2(float voltage_V, float density_kg_m3) const;
  /// Thrust of one rotor per squared speed [N s^2].
  float thrust_gain(float density_kg_m3) const;
  /// Thrust of all motors at full battery voltage [N]; 292.279 for the defaults at 1.225 kg/m^3.
  float max_thrust_N(float density_kg_m3) const;

 private:
  float torque_gain(float density_kg_m3) const;  ///< [N m s^2]
};

/// What a battery can have, as fractions of the full battery's voltage. With the model a failed
/// sensor changes the throttle by a factor between 0.6/1.1 and 1/0.6.
inline constexpr float kMinVoltage = 0.6f;
inline constexpr float kMaxVoltage = 1.1f;

/// Without the model: factor for a throttle that is meant for the full battery, so that it gives the
/// same thrust on an emptier one. A motor output is a fraction of the voltage V that there is:
///
///     factor = clamp(0.98 V_full/V, 1, 1.2)                                               (2)
///
/// and 1 for a voltage that no battery has, as of a sensor that is absent. A sensor that reads 2 %
/// too low must not make a vehicle climb whose pilot holds the stick that hovers. At 1.2 a lithium
/// cell has 3.4 V and is nearly empty; the thrust is at most 1.2^2 of what the stick is meant for,
/// whatever the sensor says.
float full_battery_factor(float voltage_V, float full_voltage_V);

}  // namespace rosflight::core
