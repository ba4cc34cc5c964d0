// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/fixedwing/types.hpp"
#include "base/constants.hpp"

namespace rosflight::autonomy::fixedwing {

struct FollowerConfig {
  double approach_rad{1.2};    ///< chi_inf: course towards a line from far away; < pi/2.
  double line_gain_1_m{0.03};  ///< k_path.
  double circle_gain{2.0};     ///< k_orbit.
  double gravity_m_s2{base::kStandardGravity_m_s2};
  double max_roll_ff_rad{45.0 * kRadPerDeg};
  double max_wind_angle_rad{70.0 * kRadPerDeg};  ///< Between course and heading, see (4).
  double timeout_s{1.0};                         ///< An older path is not followed.
};

/// Vector fields: a course for every position, which leads to the path and along it.
///
///     line:    chi_c = chi_q - chi_inf 2/pi atan(k e),   e right of the line               (1)
///     circle:  chi_c = phi + turn (pi/2 + atan(k (d - R)/R)),  (phi, d) polar from c  (2)
///     h_c = -r_d + slope ((p - r) . q_h)  on a line;  -c_d on a circle                      (3)
///     roll_ff = atan( Vg chi_c_dot / (g cos(chi - psi)) )                                   (4)
///
/// (1) and (2): Nelson, Barber, McLain, Beard, Vector field path following for miniature air
/// vehicles, IEEE Trans. Robotics 23(3), 2007; Beard & McLain, Small Unmanned Aircraft, 2012, sec.
/// 10.1, 10.2. They speak of the course over ground, so wind needs no term of its own.
/// (4) is the coordinated turn in wind (same book, sec. 9.2) for the course rate of the field along
/// the present velocity,
///
///     line:    chi_c_dot = -chi_inf 2/pi k e_dot / (1 + (k e)^2),      e_dot = Vg sin(chi - chi_q)
///     circle:  chi_c_dot = Vg sin(chi - phi)/d + turn (k/R) d_dot/(1 + (k (d - R)/R)^2),
///              d_dot = Vg cos(chi - phi)
///
/// so it fades where the field is straight. |chi - psi| counts at most max_wind_angle_rad.
///
/// Stops: a path that is not valid, older than timeout_s, without a direction or radius, or a state
/// that is not finite gives a command that is not valid. The controller then does what it does
/// without commands.
class PathFollower {
 public:
  PathFollower() = default;
  /// Takes a copy of the gains of (1) to (4).
  explicit PathFollower(const FollowerConfig& config) : config_(config) {}

  /// Course, height, airspeed and feed-forward that lead onto the path, by (1) to (4).
  /// @param path_age_s  time since the path was received [s].
  /// @return not valid in the cases that the class names.
  ControllerCommand step(const StateEstimate& state, const CurrentPath& path,
                         double path_age_s) const;
  const FollowerConfig& config() const { return config_; }

 private:
  ControllerCommand follow_line(const StateEstimate& state, const CurrentPath& path) const;
  ControllerCommand follow_circle(const StateEstimate& state, const CurrentPath& path) const;
  double roll_ff(const StateEstimate& state, double course_rate_rad_s) const;

  FollowerConfig config_{};
};

}  // namespace rosflight::autonomy::fixedwing
