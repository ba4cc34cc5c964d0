// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/estimation/rotation.hpp"

namespace rosflight::autonomy::estimation {

using Vector2 = Eigen::Vector2d;

/// State of the filter, at the position of the IMU. W = north-east-down, B = body.
struct NominalState {
  Quaternion q_WB{Quaternion::Identity()};
  Vector3 v_W{Vector3::Zero()};
  Vector3 p_W{Vector3::Zero()};
  Vector3 gyro_bias_B{Vector3::Zero()};
  Vector3 accel_bias_B{Vector3::Zero()};
  double baro_bias_m{};
  Vector2 wind_W{Vector2::Zero()};  ///< Only where the filter has wind.
};

/// Integral of the IMU over dt_s: rotation vector, velocity change in body axes of the start.
struct ImuIncrement {
  double dt_s{};
  Vector3 dtheta_B{Vector3::Zero()};
  Vector3 dv_B{Vector3::Zero()};
};

/// White noise of the process, all as densities.
struct ProcessNoise {
  double gyro_rad_s_rtHz{3e-4};
  double accel_m_s2_rtHz{1.5e-2};
  double gyro_bias_rad_s_rts{2e-5};  ///< Random walks.
  double accel_bias_m_s2_rts{1e-3};
  double baro_bias_m_rts{0.03};
  double wind_m_s_rts{0.1};
};

/// Extended Kalman filter on the error of the state, without buffers, time or policy. The
/// estimator around it (estimator.hpp) decides what is fused when.
///
///     truth:  q = q^ exp(dtheta),  every other x = x^ + dx                                 (1)
///     error:  [dtheta_B, dv_W, dp_W, dbg_B, dba_B, dbaro (, dw_W)],  16 or 18 numbers      (2)
///
/// The attitude error is three small angles in body axes, so no attitude is singular. Prediction
/// over an increment, u = dtheta - bg dt and a = dv - ba dt:
///
///     q+ = q exp(u),  v+ = v + R a + g dt,  p+ = p + (v + v+) dt/2                           (3)
///
/// Correction with y = h(x) + n: S = H P H' + R, K = P H' S^-1, dx = K (y - h), P -= K S K'; the
/// error is then put into the state by (1) and P turned by I - skew(dtheta)/2. A measurement counts
/// only if nis = (y - h)' S^-1 (y - h) is below its gate.
///
/// J. Sola, "Quaternion kinematics for the error-state Kalman filter", 2017, sec. 5 to 6 (local
/// angular error); equations as implemented: docs/autonomy/estimation.md. Fixed size, no heap.
template <bool kWind>
class ErrorStateEkf {
 public:
  static constexpr int kSize = kWind ? 18 : 16;
  static constexpr int kTheta = 0, kVelocity = 3, kPosition = 6, kGyroBias = 9, kAccelBias = 12,
                       kBaroBias = 15, kWindIndex = 16;
  using Error = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  /// y - h(x), its derivative H = dh/derror and the noise of y.
  template <int kRows>
  struct Residual {
    Eigen::Matrix<double, kRows, 1> nu{Eigen::Matrix<double, kRows, 1>::Zero()};
    Eigen::Matrix<double, kRows, kSize> H{Eigen::Matrix<double, kRows, kSize>::Zero()};
    Eigen::Matrix<double, kRows, kRows> R{Eigen::Matrix<double, kRows, kRows>::Zero()};

    /// Some of its rows as a residual of its own; without R.
    template <int kPart>
    Residual<kPart> rows(int first) const {
      Residual<kPart> part;
      part.nu = nu.template segment<kPart>(first);
      part.H = H.template middleRows<kPart>(first);
      return part;
    }
  };

  struct Verdict {
    double nis{};
    bool accepted{};
  };

  NominalState& state() { return x_; }
  const NominalState& state() const { return x_; }
  Covariance& covariance() { return P_; }
  const Covariance& covariance() const { return P_; }

  // ---- prediction

  /// Equation (3) alone.
  static void propagate(NominalState& x, const ImuIncrement& u, double gravity_m_s2);
  /// The derivative of (3): error after by error before.
  static Covariance transition(const NominalState& x, const ImuIncrement& u);
  /// Moves state and covariance on by one increment.
  void predict(const ImuIncrement& u, const ProcessNoise& noise, double gravity_m_s2);

  // ---- measurements; levers are from the IMU, in B

  /// y: position of an antenna at the lever [m].
  static Residual<3> gnss_position(const NominalState& x, const Vector3& p_W,
                                   const Vector3& lever_B);
  /// y: velocity of the antenna; w_raw_B is what the gyro reads [rad/s].
  static Residual<3> gnss_velocity(const NominalState& x, const Vector3& v_W,
                                   const Vector3& lever_B, const Vector3& w_raw_B);
  /// y: pressure altitude above the origin, h = -p_down + bias [m].
  static Residual<1> baro_height(const NominalState& x, double height_m);
  /// y: declination, h = atan2 of the levelled field: its angle east of true north, by our
  /// attitude.
  static Residual<1> magnetic_heading(const NominalState& x, const Vector3& field_B,
                                      double declination_rad);
  /// y: distance along body z to a level ground `ground_up_m` above the origin.
  static Residual<1> range(const NominalState& x, double range_m, double ground_up_m,
                           const Vector3& lever_B);
  /// y: difference pressure, h = rho/2 u |u|, u the forward speed through the air [Pa].
  static Residual<1> pitot(const NominalState& x, double pressure_Pa, double density_kg_m3);
  /// y: speed through the air to the right; zero is the assumption of no sideslip [m/s].
  static Residual<1> sideslip(const NominalState& x, double v_air_y_m_s);
  /// y: velocity of the IMU over ground; zero is the assumption of standing still.
  static Residual<3> velocity(const NominalState& x, const Vector3& v_W);

  /// Corrects the state if the residual is inside the gate. `gate_sigma` is the limit of a scalar
  /// residual in standard deviations; infinity accepts everything. A residual that is not finite is
  /// rejected.
  template <int kRows>
  Verdict correct(const Residual<kRows>& r, double gate_sigma) {
    const Eigen::Matrix<double, kSize, kRows> PHt = P_ * r.H.transpose();
    const Eigen::Matrix<double, kRows, kRows> S = r.H * PHt + r.R;
    const Eigen::Matrix<double, kRows, kRows> S_inverse = S.inverse();
    Verdict verdict;
    verdict.nis = r.nu.dot(S_inverse * r.nu);
    verdict.accepted = verdict.nis >= 0.0 && verdict.nis <= gate(kRows, gate_sigma);
    if (!verdict.accepted) return verdict;
    const Eigen::Matrix<double, kSize, kRows> K = PHt * S_inverse;
    const Error dx = K * r.nu;
    P_.noalias() -= K * PHt.transpose();
    symmetrise();
    inject(dx);
    return verdict;
  }

  /// Puts an error into the state (1) and turns the covariance.
  void inject(const Error& dx);
  /// x [+] dx without covariance: the inverse of difference().
  static NominalState added(const NominalState& x, const Error& dx);
  /// The error that takes `from` to `to`.
  static Error difference(const NominalState& to, const NominalState& from);

  /// Sets the variance of `size` errors from `first` on to sigma^2 and their covariances to zero.
  void reset_variance(int first, int size, double sigma);
  /// Sets the bias of the barometer so that this altitude has no residual.
  void relearn_baro_bias(double height_m, double sigma_m);

  /// Limit of nis: sigma^2 of one degree of freedom, (sigma + 0.4)^2 of two, (sigma + 0.7)^2 of
  /// three, which have nearly the same tail (the limit is right to 4 % from 3 to 5 sigma).
  static double gate(int rows, double sigma) {
    constexpr std::array<double, 4> kMore{0.0, 0.0, 0.40, 0.70};
    const double s = sigma + kMore.at(static_cast<std::size_t>(rows));
    return s * s;
  }

 private:
  void symmetrise() { P_ = (0.5 * (P_ + P_.transpose())).eval(); }

  NominalState x_;
  Covariance P_{Covariance::Identity()};
};

extern template class ErrorStateEkf<false>;
extern template class ErrorStateEkf<true>;

}  // namespace rosflight::autonomy::estimation
