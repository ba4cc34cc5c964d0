// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/random.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {

/// Continuous turbulence of the Dryden form, low-altitude model (MIL-F-8785C, 1980, section 3.7).
///
/// With h the height in feet, 10 <= h <= 1000 (held beyond), W20 the wind speed at 20 feet:
///
///     sigma_w = 0.1 W20,   sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4        (1)
///     L_w = h,             L_u = L_v = h / (0.177 + 0.000823 h)^1.2                      (2)
///     H_u(s) = sigma_u sqrt(2/a) / (1 + s/a)                a = V / L_u                  (3)
///     H_v(s) = sigma_v sqrt(1/a) (1 + sqrt3 s/a) / (1 + s/a)^2,  a = V / L_v;  w alike   (4)
///
/// driven by white noise; V is the speed of the air past the vehicle. (3) and (4) are linear, so
/// each step uses their exact discrete form (transition matrix and the Cholesky factor of the noise
/// covariance): variance and spectrum are right at every step length, and the process is stationary
/// from the first sample. Autocorrelations: sigma^2 e^-r for u and sigma^2 e^-r (1 - r/2) for v and
/// w, r = a |t|.
class DrydenTurbulence {
 public:
  /// @param w20_m_s  > 0: 7.7 is light, 15.4 moderate, 23.2 severe.
  DrydenTurbulence(double w20_m_s, const RandomSource& source);

  /// The turbulence dt_s later: along the mean wind, to its right, down [m/s].
  /// @param height_m   over ground.
  /// @param speed_m_s  V; at least 1 m/s and W20 are used, so that a hovering vehicle is passed by
  /// the mean wind.
  Vector3 step(double dt_s, double height_m, double speed_m_s);

 private:
  /// (4) as y = sqrt3 z1 + (1 - sqrt3) z2, z1' = -z1 + n, z2' = -z2 + z1 in time measured in 1/a;
  /// Var y = 1.
  struct Transverse {
    double z1;
    double z2;
    RandomStream stream;
    explicit Transverse(RandomStream random);
    double step(double r);
  };

  double w20_m_s_;
  RandomStream stream_u_;
  double u_;  ///< (3) over its sigma.
  Transverse v_;
  Transverse w_;
};

}  // namespace rosflight::sim
