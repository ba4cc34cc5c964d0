// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/common/types.hpp"
#include "autonomy/quadplane/config.hpp"

namespace rosflight::autonomy::quadplane {

/// Velocity to forces, torques and surfaces, one law from hover to cruise.
///
///     f   = m (a_ff + k_v (v_c - v) + integral - g)              the force that air and rotors owe       (1)
///     phi = atan2(f_right, f_up)                                 wing and rotors lean alike              (2)
///     alpha_c = w (f_n/(q S) - C_L0)/C_La, limited               the wing first                          (3)
///     theta = alpha_c + w gamma + brake                          brake: only on the rotors, nose up      (4)
///     R^T (f - f_air(alpha, V)) = (P, ., -T)                     what is left: pusher and lifting rotors (5)
///
/// with q the dynamic pressure and w rising from 0 to 1 between kBlendLow_m_s and kBlendHigh_m_s. There is no
/// switch in it: in a transition the wing's share of (5) grows with V^2 and the rotors' shrinks. Attitude is a
/// cascade of proportional loops with an integral; its torque goes to the surfaces as far as they reach, the rest to
/// the rotors while they turn.
///
/// The command is pass-through, axes of the secondary mixer (docs/quadplane.md):
///     0 pusher [N, static], 2 minus the lift [N], 3 4 5 torques of the lifting rotors [N m],
///     6 7 8 surfaces that roll right, pitch up, yaw right, -1 to 1.
class Controller {
 public:
  static constexpr double kBlendLow_m_s = 6.0;
  static constexpr double kBlendHigh_m_s = 11.0;

  struct Command {
    Vector3 v_W{Vector3::Zero()};     ///< Velocity.
    Vector3 a_ff_W{Vector3::Zero()};  ///< Acceleration of the path.
    double heading_rad{};
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    std::optional<double> lift_force_N{};  ///< Instead of (5), level: unloads after touchdown.
    double supply{1.0};                    ///< Battery voltage as a share of the full one.
    bool on_ground{};                      ///< The integrals rest.
  };
  struct Output {
    FirmwareCommand command{};
    double lift_force_N{};     ///< By the rotors.
    double pusher_thrust_N{};  ///< At this airspeed.
    double airspeed_m_s{};     ///< Forward.
  };

  Controller() = default;
  explicit Controller(const FlightConfig& config) : config_{config} {}
  void configure(const FlightConfig& config) { config_ = config; }
  /// Integrals at zero, heading command where the nose points, lift as the airspeed gives it.
  void reset(const StateEstimate& state);
  double heading_rad() const { return heading_rad_; }
  const Output& step(const StateEstimate& state, const Command& in, double dt_s);

 private:
  struct Air {
    double forward_m_s{};
    double alpha_rad{};  ///< By attitude, velocity and the estimated wind.
    double met_rad{};    ///< By the lift that is measured: gusts included, and nothing larger.
    double pressure_force_N{};  ///< q S
    double share{};             ///< w
    double lift_force_N{}, drag_force_N{};
    double attached{1.0};  ///< Share of the flow.
  };
  Air air(const StateEstimate& state) const;
  void measure_lift(const StateEstimate& state, double dt_s);
  Vector3 wanted_force(const StateEstimate& state, const Command& in, double dt_s);
  double turn_heading(double heading_rad, double dt_s);
  Vector3 torque(const StateEstimate& state, const Quaternion& wanted, double turn_rad_s,
                 const Air& air) const;
  void integrate_attitude(const StateEstimate& state, const Quaternion& wanted, bool on_ground,
                          double dt_s);
  void allocate(const Vector3& torque_B, const Air& air);
  double static_thrust(double thrust_N, double forward_m_s) const;

  FlightConfig config_{};
  double air_force_N_{};                      ///< Upward force of the air along body z, measured.
  double nose_force_N_{};                     ///< Lift that the nose's error promises, averaged.
  Vector3 force_integral_{Vector3::Zero()};   ///< [m/s^2]
  Vector3 torque_integral_{Vector3::Zero()};  ///< [rad/s^2]
  double heading_rad_{};
  Output out_{};
};

}  // namespace rosflight::autonomy::quadplane
