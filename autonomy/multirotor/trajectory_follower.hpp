// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/pid.hpp"
#include "autonomy/multirotor/trajectory_law.hpp"

namespace rosflight::autonomy::multirotor {

struct FollowerConfig {
  double mass_kg{3.5};
  double gravity_m_s2{9.81};
  PidGains horizontal{3.5, 1.0, 3.2};  ///< kp [1/s^2], ki [1/s^3], kd [1/s].
  std::optional<PidGains> east;        ///< Else horizontal is that of both.
  PidGains vertical{4.0, 1.0, 3.5};
  PidGains heading{2.0, 0.0, 0.0};   ///< kp [1/s], ki [1/s^2], kd [-].
  double drag_1_s{0.0};              ///< Deceleration per speed through still air, fed forward.
  double attitude_lag_s{0.0};        ///< From commanded to flown roll and pitch.
  double thrust_lag_s{0.0};          ///< From commanded to given thrust.
  double max_position_error_m{3.0};  ///< Farther away the error counts as this much.
  double max_tilt_rad{30.0 * kRadPerDeg};
  double min_lift_ratio{0.4};  ///< Least upward share of thrust, in weights.
  double max_thrust_N{65.0};
  double max_yaw_rate_rad_s{90.0 * kRadPerDeg};
  double timeout_s{0.5};  ///< An older setpoint is not followed.
};

/// Flies a trajectory by differential flatness: position, velocity and acceleration errors give the
/// force the vehicle needs, and force and heading give attitude, yaw rate and thrust.
///
///     u = a_l + kp (p_c - p) + kd (v_c - v) + I,   f = u - g e3                           (1)
///     a_l = s + lag s_dot,   s = a_c + drag v_c,   s_dot = j_c + drag a_c                 (2)
///     thrust = m |f|;  roll and pitch by ThrustDirection of f in v1                       (3)
///     u_psi = psi_dot_c + kp (psi_c - psi) + kd (psi_dot_c - psi_dot) + I                 (4)
///     r = u_psi cos(pitch) cos(roll) - pitch_dot sin(roll),
///     pitch_dot = d/dt atan(f_x/f_z) = u_psi f_y f_z/(f_x^2 + f_z^2),   f fixed in W      (5)
///
/// Ferrin, Leishman, Beard, McLain, Differential flatness based control of a rotorcraft for
/// aggressive maneuvers, IROS 2011, with PID in place of LQR. In (2) the drag term extends flatness
/// to linear rotor drag: Faessler, Franchi, Scaramuzza, RA-L 3(2), 2018; the lag term undoes the
/// first-order delay of the loops below, lateral attitude_lag_s, vertical thrust_lag_s. Because
/// (1) damps the velocity error there is no steady lag at constant speed.
///
/// Limits, in this order: lift (up/down) between min_lift_ratio weights and what the tilt limit
/// leaves, then lateral force by tilt and by the thrust left over. A limited axis holds its
/// integral. The yaw rate is limited.
class TrajectoryFollower final : public TrajectoryLaw {
 public:
  TrajectoryFollower() = default;
  /// Takes a copy of gains, vehicle and limits.
  explicit TrajectoryFollower(const FollowerConfig& config);

  /// Mode kRollPitchYawrateThrust. Not valid, and nothing changed, for a setpoint that is too old
  /// or a number that is not finite.
  ControllerCommand step(const Input& in) override;

  /// Sets the integrals of all four loops to zero.
  void clear_integrators();
  /// Gains and limits change, integrals and filters stay.
  void configure(const FollowerConfig& config);
  const FollowerConfig& config() const { return config_; }
  void restart(const Vector3& trim_W) override;
  Vector3 trim_W() const override {
    return {north_.integral(), east_.integral(), down_.integral()};
  }
  double heading_integral() const { return heading_.integral(); }

 private:
  Vector3 wanted_acceleration(const Input& in);
  double wanted_yaw_rate(const Input& in);
  void limit(Vector3& f_W);

  FollowerConfig config_{};
  Pid north_, east_, down_, heading_;
  ControllerCommand last_{};
  double tan_tilt_{};
  bool lateral_limited_{false};
  bool lift_limited_{false};
};

}  // namespace rosflight::autonomy::multirotor
