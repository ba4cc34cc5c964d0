// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Cholesky>
#include <array>
#include <cmath>

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
  Vector2 wind_W{Vector2::Zero()};
  Vector3 gnss_bias_W{Vector3::Zero()};  ///< Slow error of the satellites' position [m].
  Vector3 mag_bias_B{Vector3::Zero()};   ///< Iron of the vehicle [T].
  Vector2 air_scale_B{Vector2::Zero()};  ///< Relative error of AirForce along body x and y.
  double gust_down_m_s{};                ///< Vertical gust, positive down; of the lift alone.
  double lift_offset_rad{};              ///< Error of LiftModel as an angle of attack.
};

/// Integral of the IMU over dt_s: rotation vector, velocity change in body axes of the start.
struct ImuIncrement {
  double dt_s{};
  Vector3 dtheta_B{Vector3::Zero()};
  Vector3 dv_B{Vector3::Zero()};
};

/// White noise of the process, all as densities, and the slow error of the satellites: for each axis
/// a first-order Gauss-Markov process of this standard deviation and correlation time.
struct ProcessNoise {
  double gyro_rad_s_rtHz{2.6e-4};
  double accel_m_s2_rtHz{1.1e-2};
  double gyro_bias_rad_s_rts{1.5e-5};  ///< Random walks.
  double accel_bias_m_s2_rts{2e-4};
  double baro_bias_m_rts{0.03};
  double wind_m_s_rts{0.05};  ///< In still air; grows with the gusts that are measured.
  double mag_bias_T_rts{1e-9};
  double air_scale_rts{2e-3};
  double gnss_slow_horizontal_m{1.7};
  double gnss_slow_altitude_m{2.55};
  double gnss_slow_time_s{1100.0};  ///< > 0.
  /// The vertical gust, another first-order Gauss-Markov process: in still air, and its correlation
  /// time, > 0. What uses them raises the first with the gusts that are measured and sets the second
  /// by height and airspeed (aid_air.cpp).
  double gust_down_m_s{0.25};
  double gust_down_time_s{2.0};
  double lift_offset_rad_rts{5e-4};  ///< Random walk.
};

/// What the accelerometer measures of the air: the specific force along a body axis,
///
///     f = -(1 + e) (linear + quadratic |v_a|) v_a                                    (1)
///
/// v_a the velocity through the air, e the relative error of the model along that axis. Rotors: linear = rotor_drag * thrust / mass; bodies and fixed wings:
/// quadratic = rho S C / (2 m), C the drag coefficient or the slope of the side force.
struct AirForce {
  double linear_1_s{};
  double quadratic_1_m{};
};

/// What the accelerometer measures of the lift of a wing, along body z:
///
///     f = -rho/2 S/m V^2 (zero + slope (alpha + o - w/u))                            (1)
///
/// V, alpha and u by the velocity through air that does not rise, w the vertical gust (down), o the
/// error of the model. R. Beard, T. McLain, Small Unmanned Aircraft, 2012, eq. (4.6) and (4.8), without
/// pitch rate and elevator: those of an anaconda are worth 0.3 degrees of alpha.
struct LiftModel {
  double area_m2_kg{};  ///< Wing area by mass; 0: not known.
  double zero{};        ///< C_L at no angle of attack,
  double slope_1_rad{};
  double linear_rad{0.11};  ///< Largest angle of attack for which (1) holds.
};

/// Extended Kalman filter on the error of the state, without buffers, time or policy. The
/// estimator around it (estimator.hpp) decides what is fused when.
///
///     truth:  q = q^ exp(dtheta),  every other x = x^ + dx                                 (1)
///     error:  [dtheta_B, dv_W, dp_W, dbg_B, dba_B, dbaro, dw_W, dgnss_W, dmag_B, de_B,     (2)
///              dgust, doffset]
///
/// 28 numbers; that of the magnetometer in microtesla, so that none is many orders from one.
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
class ErrorStateEkf {
 public:
  static constexpr int kTheta = 0, kVelocity = 3, kPosition = 6, kGyroBias = 9, kAccelBias = 12,
                       kBaroBias = 15, kWind = 16, kGnssBias = 18, kMagBias = 21, kAirScale = 24,
                       kGust = 26, kLiftOffset = 27, kSize = 28;
  static constexpr double kMicrotesla = 1e-6;  ///< Unit of the error of the magnetometer [T].
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
    double variance{};          ///< S of a scalar residual,
    Error gain{Error::Zero()};  ///< and its K: zero if it was not accepted.
  };

  NominalState& state() { return x_; }
  const NominalState& state() const { return x_; }
  Covariance& covariance() { return P_; }
  const Covariance& covariance() const { return P_; }

  // ---- prediction

  /// Equation (3) alone; the slow error of the satellites is left as it is.
  static void propagate(NominalState& x, const ImuIncrement& u, double gravity_m_s2);
  /// The increment of a vehicle that neither turns nor accelerates during dt_s.
  static ImuIncrement steady(const NominalState& x, double dt_s, double gravity_m_s2);
  /// The derivative of (3): error after by error before.
  static Covariance transition(const NominalState& x, const ImuIncrement& u,
                               const ProcessNoise& noise);
  /// Applies transition() to errors, one a column; x is the state before the increment.
  template <int kColumns>
  static void carry(const NominalState& x, const ImuIncrement& u, const ProcessNoise& noise,
                    Eigen::Matrix<double, kSize, kColumns>& errors) {
    using Rows = Eigen::Matrix<double, 3, kColumns>;
    const double dt = u.dt_s;
    const Vector3 turn = u.dtheta_B - x.gyro_bias_B * dt;
    const Matrix3 R = x.q_WB.toRotationMatrix();
    const Rows theta = errors.template middleRows<3>(kTheta);
    const Rows v = errors.template middleRows<3>(kVelocity);
    const Rows v_new = v - R * skew(u.dv_B - x.accel_bias_B * dt) * theta -
                       dt * R * errors.template middleRows<3>(kAccelBias);
    errors.template middleRows<3>(kPosition) += 0.5 * dt * (v + v_new);
    errors.template middleRows<3>(kVelocity) = v_new;
    errors.template middleRows<3>(kTheta) =
        exp_rotation(turn).toRotationMatrix().transpose() * theta -
        dt * right_jacobian(turn) * errors.template middleRows<3>(kGyroBias);
    errors.template middleRows<3>(kGnssBias) *= std::exp(-dt / noise.gnss_slow_time_s);
    errors.row(kGust) *= std::exp(-dt / noise.gust_down_time_s);
  }
  /// Moves state and covariance on by one increment.
  void predict(const ImuIncrement& u, const ProcessNoise& noise, double gravity_m_s2);

  // ---- measurements; levers are from the IMU, in B

  /// y: position of an antenna at the lever, slow error included [m].
  static Residual<3> gnss_position(const NominalState& x, const Vector3& p_W,
                                   const Vector3& lever_B);
  /// y: velocity of the antenna; w_raw_B is what the gyro reads [rad/s].
  static Residual<3> gnss_velocity(const NominalState& x, const Vector3& v_W,
                                   const Vector3& lever_B, const Vector3& w_raw_B);
  /// y: pressure altitude above the origin, h = -p_down + bias [m].
  static Residual<1> baro_height(const NominalState& x, double height_m);
  /// y: declination, h = atan2 of the levelled field without iron: its angle east of true north, by
  /// our attitude.
  static Residual<1> magnetic_heading(const NominalState& x, const Vector3& field_B,
                                      double declination_rad);
  /// y: distance along body z to a level ground `ground_up_m` above the origin.
  static Residual<1> range(const NominalState& x, double range_m, double ground_up_m,
                           const Vector3& lever_B);
  /// y: difference pressure, h = rho/2 u |u|, u the forward speed through the air [Pa].
  static Residual<1> pitot(const NominalState& x, double pressure_Pa, double density_kg_m3);
  /// y: speed through the air to the right; zero is the assumption of no sideslip [m/s].
  static Residual<1> sideslip(const NominalState& x, double v_air_y_m_s);
  /// y: specific force along body axis `axis`, 0 or 1, as the accelerometer reads it [m/s^2].
  static Residual<1> air_force(const NominalState& x, int axis, double force_m_s2,
                               const AirForce& model);
  /// y: specific force along body z, as the accelerometer reads it [m/s^2]. The forward speed u
  /// through the air must not be zero.
  static Residual<1> lift(const NominalState& x, double force_m_s2, double density_kg_m3,
                          const LiftModel& model);
  /// Standard deviation of the forward speed through the air [m/s].
  double airspeed_sigma_m_s() const;
  /// Velocity through the air, in B [m/s].
  static Vector3 air_velocity_B(const NominalState& x);
  /// y: velocity of the IMU over ground; zero is the assumption of standing still.
  static Residual<3> velocity(const NominalState& x, const Vector3& v_W);

  /// The covariance in half of its room, column by column from the diagonal down.
  using LowerTriangle = std::array<double, static_cast<std::size_t>(kSize*(kSize + 1) / 2)>;
  LowerTriangle lower_covariance() const;
  void set_lower_covariance(const LowerTriangle& lower);

  /// Corrects the state if the residual is inside the gate. `gate_sigma` is the limit of a scalar
  /// residual in standard deviations; infinity accepts everything. A residual that is not finite is
  /// rejected.
  template <int kRows>
  Verdict correct(const Residual<kRows>& r, double gate_sigma) {
    const Eigen::Matrix<double, kSize, kRows> PHt = covariance_by(r.H);
    const Eigen::Matrix<double, kRows, kRows> S = r.H.lazyProduct(PHt) + r.R;
    Verdict verdict;
    if constexpr (kRows == 1) {
      verdict.variance = S(0);
      verdict.nis = r.nu(0) * r.nu(0) / S(0);
      verdict.accepted = verdict.nis >= 0.0 && verdict.nis <= gate(kRows, gate_sigma);
      if (!verdict.accepted) return verdict;
      verdict.gain = PHt / S(0);
      const Error scaled = PHt / std::sqrt(S(0));  // its square is symmetric to the bit
      P_.noalias() -= scaled * scaled.transpose();
      inject(PHt * (r.nu(0) / S(0)));
      return verdict;
    }
    const Eigen::LLT<Eigen::Matrix<double, kRows, kRows>> root(S);
    const Eigen::Matrix<double, kRows, 1> weighted = root.solve(r.nu);
    verdict.nis = r.nu.dot(weighted);
    verdict.accepted = root.info() == Eigen::Success && verdict.nis >= 0.0 &&
                       verdict.nis <= gate(kRows, gate_sigma);
    if (!verdict.accepted) return verdict;
    // P - W W' with S = L L' and W = P H' L'^-1: its lower half is mirrored, so no rounding of predict() adds up.
    Eigen::Matrix<double, kSize, kRows> W = PHt;
    const auto& L = root.matrixLLT();
    for (int c = 0; c < kRows; ++c) {
      for (int k = 0; k < c; ++k) W.col(c) -= W.col(k) * L(c, k);
      W.col(c) /= L(c, c);
    }
    for (int column = 0; column < kSize; ++column) {
      for (int k = 0; k < kRows; ++k) P_.col(column) -= W.col(k) * W(column, k);
    }
    for (int column = 0; column < kSize; ++column) {
      for (int row = column + 1; row < kSize; ++row) P_(column, row) = P_(row, column);
    }
    inject(PHt * weighted);
    return verdict;
  }

  /// Corrects heading, gyro bias about the vertical and iron by a scalar residual, and takes all
  /// other errors into account without correcting them (S. F. Schmidt 1966: "consider" states):
  /// with any gain K, P <- P - K H P - P H' K' + K S K'. So a heading that is wrong never tilts.
  Verdict correct_heading(const Residual<1>& r, double gate_sigma);
  /// The same for the vertical gust and the error of the lift: all other errors are "consider" states.
  Verdict correct_gust(const Residual<1>& r, double gate_sigma);

  /// Puts an error into the state (1) and turns the covariance.
  void inject(const Error& dx);
  /// x [+] dx without covariance: the inverse of difference().
  static NominalState added(const NominalState& x, const Error& dx);
  /// The error that takes `from` to `to`.
  static Error difference(const NominalState& to, const NominalState& from);

  /// Sets the variance of `size` errors from `first` on to sigma^2 and their covariances to zero.
  void reset_variance(int first, int size, double sigma);
  /// Makes `size` errors from `first` on the negatives of those from `other` on but for noise of
  /// this sigma: their sum was measured.
  void couple(int first, int other, int size, double sigma);
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
  static Verdict judged(const Residual<1>& r, const Error& PHt, double gate_sigma);
  void consider(const Residual<1>& r, const Error& PHt, const Verdict& verdict);
  /// P H': most numbers of H are zero.
  template <int kRows, int kOptions>
  Eigen::Matrix<double, kSize, kRows> covariance_by(
      const Eigen::Matrix<double, kRows, kSize, kOptions>& H) const {
    Eigen::Matrix<double, kSize, kRows> out = Eigen::Matrix<double, kSize, kRows>::Zero();
    for (int k = 0; k < kSize; ++k) {
      for (int row = 0; row < kRows; ++row) {
        if (H(row, k) != 0.0) out.col(row) += P_.col(k) * H(row, k);
      }
    }
    return out;
  }

  NominalState x_;
  Covariance P_{Covariance::Identity()};
};

}  // namespace rosflight::autonomy::estimation
