// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/multirotor/leg.hpp"

namespace rosflight::autonomy::multirotor {

/// A figure of eight, flown whole times around from rest to rest in its crossing.
///
/// The sine-generated curve of course chi(phi) = chi0 + m cos phi, phi = 2 pi s/L at distance s,
/// closes where the Bessel function J0(m) = 0: m = 2.404826. Its curvature -(2 pi m/L) sin phi goes
/// smoothly from one side to the other, and the tightest turn, in the middle of each lobe, has the
/// radius L/(2 pi m), which is what the figure is asked for by. A lobe is 2.83 radii long and 1.05
/// wide to either side. Position by the expansion of C. Jacobi and C. Anger (Abramowitz & Stegun,
/// 9.1.44, 9.1.45), integrated:
///
///     x = L/2pi 2 sum_k (-1)^k J_2k(m) sin(2k phi)/(2k),           k = 1, 2, ...
///     y = L/2pi 2 sum_k (-1)^k J_2k+1(m) sin((2k+1) phi)/(2k+1),   k = 0, 1, ...              (1)
///
/// The speed rises as v (1 - cos(pi t/T))/2 with a peak of half the acceleration limit, and falls
/// likewise at the end. The heading stays. Sine-generated curves: L. Leopold, W. Langbein, "River
/// meanders", Scientific American 214, 1966.
class FigureEightLeg {
 public:
  FigureEightLeg() = default;
  /// @param radius_m  of the tightest turn; > 0.
  /// @param course_rad  of the long axis, to the tip of the first lobe.
  FigureEightLeg(const Trajectory& start, double radius_m, int turns, double course_rad,
                 double speed_m_s, double acceleration_m_s2);

  /// Setpoint at t_s after the start of the leg, with three derivatives, in W; clipped to
  /// 0..duration_s().
  Trajectory sample(double t_s) const;
  double duration_s() const { return cruise_end_s_ + ramp_s_; }
  double length_m() const { return length_m_; }

 private:
  static constexpr std::size_t kTerms = 14;
  struct Along {
    double s_m, v_m_s, a_m_s2, j_m_s3;
  };
  Along along(double t_s) const;

  Trajectory start_{};
  double cosine_{1.0}, sine_{};     ///< Rotation that takes (1) to W.
  std::array<double, kTerms> c_{};  ///< Factors of sin(n phi), n from 1; odd: y, even: x.
  double length_m_{};               ///< Once around.
  double path_m_{};
  double speed_m_s_{};
  double ramp_s_{};
  double cruise_end_s_{};
};

}  // namespace rosflight::autonomy::multirotor
