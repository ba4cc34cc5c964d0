// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/trajectory_law.hpp"

namespace own_controller {

using rosflight::autonomy::Vector3;
using rosflight::autonomy::multirotor::ControllerCommand;

struct GeometricConfig {
  double mass_kg{3.5};
  double gravity_m_s2{9.81};
  double kp_1_s2{6.0};
  double kv_1_s{4.5};
  double ki_1_s3{3.0};
  double kr_1_s{8.0};                 ///< Body rate per attitude error.
  double ki_r_1_s2{12.0};             ///< The same per its integral: propellers resist a tilt.
  double drag_1_s{0.0};               ///< Deceleration per speed, fed forward.
  double max_acceleration_m_s2{7.0};  ///< Lateral and down: a tilt of 36 deg.
  double max_integral_m_s2{4.0};      ///< Each axis.
  double max_distance_m{1.0};         ///< A larger position error counts as this.
};

/// Tracks position and heading on the rotation group itself, without Euler angles.
///
///     f     = a_c + drag v_c - kp e_p - kv e_v + I - g e3          desired specific force   (1)
///     b3    = -f/|f|                                                                        (2)
///     b2    = b3 x (cos psi_c, sin psi_c, 0) / |.|,   b1 = b2 x b3,   R_c = [b1 b2 b3]      (3)
///     e_R   = (R_c' R - R' R_c)^vee / 2                                                     (4)
///     w_c   = -kr e_R - ki integral(e_R) + R' (b3 x b3_dot) + psi_dot_c R' e3               (5)
///     f_dot = j_c + drag a_c,   which gives b3_dot by (2)                                   (6)
///     T     = -m f . R e3                                          thrust                   (7)
///
/// T. Lee, M. Leok, N. H. McClamroch, Geometric tracking control of a quadrotor UAV on SE(3), IEEE
/// CDC 2010, in north-east-down. There e_R and the rates give torques; here they give body rates,
/// which the flight controller follows (mode 11). Both integrals are additions: the first removes
/// the error of a steady wind, the second that of the rotors' drag, which a proportional rate loop
/// does not hold.
class GeometricController final : public rosflight::autonomy::multirotor::TrajectoryLaw {
 public:
  explicit GeometricController(const GeometricConfig& config) : config_(config) {}

  ControllerCommand step(const Input& in) override;
  void restart(const Vector3& trim_W) override;
  Vector3 trim_W() const override { return integral_W_; }

 private:
  Vector3 specific_force(const Input& in);

  GeometricConfig config_;
  Vector3 integral_W_{Vector3::Zero()};  ///< As an acceleration [m/s^2].
  Vector3 rate_B_{Vector3::Zero()};      ///< Rate from the integral of the attitude error [rad/s].
  ControllerCommand last_{};
};

}  // namespace own_controller
