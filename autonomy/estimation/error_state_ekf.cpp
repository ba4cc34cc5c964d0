// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/estimation/error_state_ekf.hpp"

#include <cmath>

#include "base/angles.hpp"

namespace rosflight::autonomy::estimation {

void ErrorStateEkf::propagate(NominalState& x, const ImuIncrement& u, double gravity_m_s2) {
  const Vector3 before = x.v_W;
  x.v_W += x.q_WB * (u.dv_B - x.accel_bias_B * u.dt_s);
  x.v_W.z() += gravity_m_s2 * u.dt_s;
  x.p_W += 0.5 * u.dt_s * (before + x.v_W);
  x.q_WB = (x.q_WB * exp_rotation(u.dtheta_B - x.gyro_bias_B * u.dt_s)).normalized();
}

ImuIncrement ErrorStateEkf::steady(const NominalState& x, double dt_s, double gravity_m_s2) {
  const Vector3 up_B = x.q_WB.conjugate() * Vector3(0.0, 0.0, -gravity_m_s2);
  return {dt_s, x.gyro_bias_B * dt_s, (up_B + x.accel_bias_B) * dt_s};
}

ErrorStateEkf::Covariance ErrorStateEkf::transition(const NominalState& x, const ImuIncrement& u,
                                                    const ProcessNoise& noise) {
  const double dt = u.dt_s;
  const Vector3 turn = u.dtheta_B - x.gyro_bias_B * dt;
  const Matrix3 R = x.q_WB.toRotationMatrix();
  Covariance F = Covariance::Identity();
  F.block<3, 3>(kTheta, kTheta) = exp_rotation(turn).toRotationMatrix().transpose();
  F.block<3, 3>(kTheta, kGyroBias) = -dt * right_jacobian(turn);
  const Matrix3 v_theta = -R * skew(u.dv_B - x.accel_bias_B * dt);
  F.block<3, 3>(kVelocity, kTheta) = v_theta;
  F.block<3, 3>(kVelocity, kAccelBias) = -dt * R;
  F.block<3, 3>(kPosition, kTheta) = 0.5 * dt * v_theta;
  F.block<3, 3>(kPosition, kVelocity) = dt * Matrix3::Identity();
  F.block<3, 3>(kPosition, kAccelBias) = -0.5 * dt * dt * R;
  F.block<3, 3>(kGnssBias, kGnssBias) *= std::exp(-dt / noise.gnss_slow_time_s);
  F(kGust, kGust) = std::exp(-dt / noise.gust_down_time_s);
  return F;
}

/// P <- F P F' + Q, by the blocks of F that are neither zero nor one, P symmetric; transition() is the same F in
/// one piece.
void ErrorStateEkf::predict(const ImuIncrement& u, const ProcessNoise& noise, double gravity_m_s2) {
  const double dt = u.dt_s;
  const Vector3 turn = u.dtheta_B - x_.gyro_bias_B * dt;
  const Matrix3 R = x_.q_WB.toRotationMatrix();
  const Matrix3 theta_theta = exp_rotation(turn).toRotationMatrix().transpose();
  const Matrix3 theta_bias = -dt * right_jacobian(turn);
  const Matrix3 v_theta = -R * skew(u.dv_B - x_.accel_bias_B * dt);
  const Matrix3 v_bias = -dt * R;

  const double kept = std::exp(-dt / noise.gnss_slow_time_s);
  {
    // P F': the columns that change.
    using Columns = Eigen::Matrix<double, kSize, 3>;
    const Columns theta = P_.middleCols<3>(kTheta);
    const Columns v = P_.middleCols<3>(kVelocity);
    const Columns v_new =
        v + theta * v_theta.transpose() + P_.middleCols<3>(kAccelBias) * v_bias.transpose();
    P_.middleCols<3>(kPosition) += 0.5 * dt * (v + v_new);
    P_.middleCols<3>(kVelocity) = v_new;
    P_.middleCols<3>(kTheta) =
        theta * theta_theta.transpose() + P_.middleCols<3>(kGyroBias) * theta_bias.transpose();
    P_.middleCols<3>(kGnssBias) *= kept;
  }
  // F (P F'): the rows that change, in these columns; in all others the product is symmetric.
  const auto rows = [&]<int kColumns>(int first) {
    using Rows = Eigen::Matrix<double, 3, kColumns>;
    const Rows theta = P_.block<3, kColumns>(kTheta, first);
    const Rows v = P_.block<3, kColumns>(kVelocity, first);
    const Rows v_new = v + v_theta * theta + v_bias * P_.block<3, kColumns>(kAccelBias, first);
    P_.block<3, kColumns>(kPosition, first) += 0.5 * dt * (v + v_new);
    P_.block<3, kColumns>(kVelocity, first) = v_new;
    P_.block<3, kColumns>(kTheta, first) =
        theta_theta * theta + theta_bias * P_.block<3, kColumns>(kGyroBias, first);
    P_.block<3, kColumns>(kGnssBias, first) *= kept;
  };
  rows.operator()<9>(kTheta);
  rows.operator()<3>(kGnssBias);
  P_.block<9, 9>(kTheta, kGyroBias) = P_.block<9, 9>(kGyroBias, kTheta).transpose();
  P_.block<9, 7>(kTheta, kMagBias) = P_.block<7, 9>(kMagBias, kTheta).transpose();
  P_.block<3, 9>(kGnssBias, kGyroBias) = P_.block<9, 3>(kGyroBias, kGnssBias).transpose();
  P_.block<3, 7>(kGnssBias, kMagBias) = P_.block<7, 3>(kMagBias, kGnssBias).transpose();
  const double kept_gust = std::exp(-dt / noise.gust_down_time_s);
  P_.row(kGust) *= kept_gust;
  P_.col(kGust) *= kept_gust;
  x_.gnss_bias_W *= kept;
  x_.gust_down_m_s *= kept_gust;

  const auto variance = [dt](double density) { return density * density * dt; };
  const double q_v = variance(noise.accel_m_s2_rtHz);
  const double q_theta = variance(noise.gyro_rad_s_rtHz);
  const double q_gyro = variance(noise.gyro_bias_rad_s_rts);
  const double q_accel = variance(noise.accel_bias_m_s2_rts);
  for (int k = 0; k < 3; ++k) {
    P_(kTheta + k, kTheta + k) += q_theta;
    P_(kVelocity + k, kVelocity + k) += q_v;
    P_(kVelocity + k, kPosition + k) += 0.5 * dt * q_v;
    P_(kPosition + k, kVelocity + k) += 0.5 * dt * q_v;
    P_(kPosition + k, kPosition + k) += 0.25 * dt * dt * q_v;
    P_(kGyroBias + k, kGyroBias + k) += q_gyro;
    P_(kAccelBias + k, kAccelBias + k) += q_accel;
  }
  P_(kBaroBias, kBaroBias) += variance(noise.baro_bias_m_rts);
  const double q_mag = variance(noise.mag_bias_T_rts / kMicrotesla);
  const double lost = 1.0 - kept * kept;
  for (int k = 0; k < 3; ++k) {
    const double slow_m = k < 2 ? noise.gnss_slow_horizontal_m : noise.gnss_slow_altitude_m;
    P_(kGnssBias + k, kGnssBias + k) += lost * slow_m * slow_m;
    P_(kMagBias + k, kMagBias + k) += q_mag;
  }
  for (int k = 0; k < 2; ++k) {
    P_(kWind + k, kWind + k) += variance(noise.wind_m_s_rts);
    P_(kAirScale + k, kAirScale + k) += variance(noise.air_scale_rts);
  }
  P_(kGust, kGust) += (1.0 - kept_gust * kept_gust) * noise.gust_down_m_s * noise.gust_down_m_s;
  P_(kLiftOffset, kLiftOffset) += variance(noise.lift_offset_rad_rts);
  propagate(x_, u, gravity_m_s2);
}

ErrorStateEkf::Residual<3> ErrorStateEkf::gnss_position(const NominalState& x, const Vector3& p_W,
                                                        const Vector3& lever_B) {
  const Matrix3 R = x.q_WB.toRotationMatrix();
  Residual<3> r;
  r.nu = p_W - (x.p_W + x.gnss_bias_W + R * lever_B);
  r.H.block<3, 3>(0, kPosition).setIdentity();
  r.H.block<3, 3>(0, kGnssBias).setIdentity();
  r.H.block<3, 3>(0, kTheta) = -R * skew(lever_B);
  return r;
}

ErrorStateEkf::Residual<3> ErrorStateEkf::gnss_velocity(const NominalState& x, const Vector3& v_W,
                                                        const Vector3& lever_B,
                                                        const Vector3& w_raw_B) {
  const Matrix3 R = x.q_WB.toRotationMatrix();
  const Vector3 around_B = (w_raw_B - x.gyro_bias_B).cross(lever_B);
  Residual<3> r;
  r.nu = v_W - (x.v_W + R * around_B);
  r.H.block<3, 3>(0, kVelocity).setIdentity();
  r.H.block<3, 3>(0, kTheta) = -R * skew(around_B);
  r.H.block<3, 3>(0, kGyroBias) = R * skew(lever_B);
  return r;
}

ErrorStateEkf::Residual<1> ErrorStateEkf::baro_height(const NominalState& x, double height_m) {
  Residual<1> r;
  r.nu(0) = height_m - (x.baro_bias_m - x.p_W.z());
  r.H(0, kPosition + 2) = -1.0;
  r.H(0, kBaroBias) = 1.0;
  return r;
}

/// With m = R (m_B - b_m) and the attitude error as a rotation phi = R dtheta in W, dm = phi x m and
/// d atan2(m_e, m_n) = phi_d - m_d (m_n phi_n + m_e phi_e)/(m_n^2 + m_e^2). The direction of (m_n,
/// m_e) is taken where it should be, along the declination, not where it was measured: there its
/// noise would be in both the innovation and H, whose product then has a mean that walks the tilt
/// away.
ErrorStateEkf::Residual<1> ErrorStateEkf::magnetic_heading(const NominalState& x,
                                                           const Vector3& field_B,
                                                           double declination_rad) {
  const Matrix3 R = x.q_WB.toRotationMatrix();
  const Vector3 m = R * (field_B - x.mag_bias_B);
  const double level_T = m.head<2>().norm();
  const double slope = m.z() / level_T;
  Residual<1> r;
  r.nu(0) = base::wrap_angle(declination_rad - std::atan2(m.y(), m.x()));
  const Eigen::RowVector3d by_phi(-slope * std::cos(declination_rad),
                                  -slope * std::sin(declination_rad), 1.0);
  r.H.block<1, 3>(0, kTheta) = by_phi * R;
  const Eigen::RowVector3d across(-std::sin(declination_rad), std::cos(declination_rad), 0.0);
  r.H.block<1, 3>(0, kMagBias) = -kMicrotesla / level_T * (across * R);
  return r;
}

ErrorStateEkf::Residual<1> ErrorStateEkf::range(const NominalState& x, double range_m,
                                                double ground_up_m, const Vector3& lever_B) {
  const Matrix3 R = x.q_WB.toRotationMatrix();
  const Eigen::RowVector3d down = R.row(2);
  const double cosine = down.z();
  const double height = -(x.p_W.z() + down * lever_B) - ground_up_m;
  const Eigen::RowVector3d d_height = down * skew(lever_B);
  const Eigen::RowVector3d d_cosine = -(down * skew(Vector3::UnitZ()));
  Residual<1> r;
  r.nu(0) = range_m - height / cosine;
  r.H(0, kPosition + 2) = -1.0 / cosine;
  r.H.block<1, 3>(0, kTheta) = d_height / cosine - height / (cosine * cosine) * d_cosine;
  return r;
}

ErrorStateEkf::Residual<1> ErrorStateEkf::pitot(const NominalState& x, double pressure_Pa,
                                                double density_kg_m3) {
  const Vector3 air_B = air_velocity_B(x);
  const double u = air_B.x();
  const double slope = density_kg_m3 * std::abs(u);
  const Eigen::RowVector3d forward_W = x.q_WB.toRotationMatrix().col(0).transpose();
  Residual<1> r;
  r.nu(0) = pressure_Pa - 0.5 * density_kg_m3 * u * std::abs(u);
  r.H.block<1, 3>(0, kVelocity) = slope * forward_W;
  r.H.block<1, 3>(0, kTheta) = slope * skew(air_B).row(0);
  r.H.block<1, 2>(0, kWind) = -slope * forward_W.head<2>();
  return r;
}

ErrorStateEkf::Residual<1> ErrorStateEkf::sideslip(const NominalState& x, double v_air_y_m_s) {
  const Vector3 air_B = air_velocity_B(x);
  const Eigen::RowVector3d right_W = x.q_WB.toRotationMatrix().col(1).transpose();
  Residual<1> r;
  r.nu(0) = v_air_y_m_s - air_B.y();
  r.H.block<1, 3>(0, kVelocity) = right_W;
  r.H.block<1, 3>(0, kTheta) = skew(air_B).row(1);
  r.H.block<1, 2>(0, kWind) = -right_W.head<2>();
  return r;
}

Vector3 ErrorStateEkf::air_velocity_B(const NominalState& x) {
  const Vector3 v_W = x.v_W - Vector3(x.wind_W.x(), x.wind_W.y(), 0.0);
  return x.q_WB.conjugate() * v_W;
}

/// With s = linear + quadratic |v_a| and the axis' unit vector u, u and v_a in B:
/// df = -(1 + e) (s u + quadratic v_a,axis v_a/|v_a|) dv_a - s v_a,axis de, where dv_a = R'(dv - dw) +
/// [v_a]x dtheta.
ErrorStateEkf::Residual<1> ErrorStateEkf::air_force(const NominalState& x, int axis,
                                                    double force_m_s2, const AirForce& model) {
  const Vector3 air_B = air_velocity_B(x);
  const double speed = air_B.norm();
  const double slope = model.linear_1_s + model.quadratic_1_m * speed;
  Eigen::RowVector3d by_air_B = Eigen::RowVector3d::Zero();
  const double factor = 1.0 + x.air_scale_B(axis);
  by_air_B(axis) = -slope;
  if (speed > 0.0) by_air_B -= model.quadratic_1_m * air_B(axis) / speed * air_B.transpose();
  by_air_B *= factor;
  const Eigen::RowVector3d by_v_W = by_air_B * x.q_WB.toRotationMatrix().transpose();
  Residual<1> r;
  r.nu(0) = force_m_s2 - (x.accel_bias_B(axis) - factor * slope * air_B(axis));
  r.H.block<1, 3>(0, kVelocity) = by_v_W;
  r.H.block<1, 2>(0, kWind) = -by_v_W.head<2>();
  r.H.block<1, 3>(0, kTheta) = by_air_B * skew(air_B);
  r.H(0, kAccelBias + axis) = 1.0;
  r.H(0, kAirScale + axis) = -slope * air_B(axis);
  return r;
}

double ErrorStateEkf::airspeed_sigma_m_s() const {
  Eigen::Matrix<double, 1, kSize> H = Eigen::Matrix<double, 1, kSize>::Zero();
  const Eigen::RowVector3d forward_W = x_.q_WB.toRotationMatrix().col(0).transpose();
  H.segment<3>(kVelocity) = forward_W;
  H.segment<2>(kWind) = -forward_W.head<2>();
  return std::sqrt((H * P_ * H.transpose())(0));
}

/// With u, w of the velocity through the air and C = zero + slope (atan2(w, u) + o - g/u):
/// d alpha = (u dw - w du)/(u^2 + w^2), d(-g/u) = g du/u^2 - dg/u.
ErrorStateEkf::Residual<1> ErrorStateEkf::lift(const NominalState& x, double force_m_s2,
                                               double density_kg_m3, const LiftModel& model) {
  const Vector3 air_B = air_velocity_B(x);
  const double u = air_B.x();
  const double w = air_B.z();
  const double pressure = 0.5 * density_kg_m3 * model.area_m2_kg;
  const double square = u * u + w * w;
  const double alpha = std::atan2(w, u) + x.lift_offset_rad - x.gust_down_m_s / u;
  const double coefficient = model.zero + model.slope_1_rad * alpha;
  const double by_alpha = pressure * square * model.slope_1_rad;
  const Eigen::RowVector3d by_air_B(
      -2.0 * pressure * u * coefficient + by_alpha * (w / square - x.gust_down_m_s / (u * u)), 0.0,
      -2.0 * pressure * w * coefficient - by_alpha * u / square);
  const Eigen::RowVector3d by_v_W = by_air_B * x.q_WB.toRotationMatrix().transpose();
  Residual<1> r;
  r.nu(0) = force_m_s2 - (x.accel_bias_B.z() - pressure * square * coefficient);
  r.H.block<1, 3>(0, kVelocity) = by_v_W;
  r.H.block<1, 2>(0, kWind) = -by_v_W.head<2>();
  r.H.block<1, 3>(0, kTheta) = by_air_B * skew(air_B);
  r.H(0, kAccelBias + 2) = 1.0;
  r.H(0, kGust) = by_alpha / u;
  r.H(0, kLiftOffset) = -by_alpha;
  return r;
}

ErrorStateEkf::Residual<3> ErrorStateEkf::velocity(const NominalState& x, const Vector3& v_W) {
  Residual<3> r;
  r.nu = v_W - x.v_W;
  r.H.block<3, 3>(0, kVelocity).setIdentity();
  return r;
}

NominalState ErrorStateEkf::added(const NominalState& x, const Error& dx) {
  NominalState y = x;
  y.q_WB = (x.q_WB * exp_rotation(dx.segment<3>(kTheta))).normalized();
  y.v_W += dx.segment<3>(kVelocity);
  y.p_W += dx.segment<3>(kPosition);
  y.gyro_bias_B += dx.segment<3>(kGyroBias);
  y.accel_bias_B += dx.segment<3>(kAccelBias);
  y.baro_bias_m += dx(kBaroBias);
  y.wind_W += dx.segment<2>(kWind);
  y.gnss_bias_W += dx.segment<3>(kGnssBias);
  y.mag_bias_B += kMicrotesla * dx.segment<3>(kMagBias);
  y.air_scale_B += dx.segment<2>(kAirScale);
  y.gust_down_m_s += dx(kGust);
  y.lift_offset_rad += dx(kLiftOffset);
  return y;
}

ErrorStateEkf::Error ErrorStateEkf::difference(const NominalState& to, const NominalState& from) {
  Error dx;
  dx.segment<3>(kTheta) = log_rotation(from.q_WB.conjugate() * to.q_WB);
  dx.segment<3>(kVelocity) = to.v_W - from.v_W;
  dx.segment<3>(kPosition) = to.p_W - from.p_W;
  dx.segment<3>(kGyroBias) = to.gyro_bias_B - from.gyro_bias_B;
  dx.segment<3>(kAccelBias) = to.accel_bias_B - from.accel_bias_B;
  dx(kBaroBias) = to.baro_bias_m - from.baro_bias_m;
  dx.segment<2>(kWind) = to.wind_W - from.wind_W;
  dx.segment<3>(kGnssBias) = to.gnss_bias_W - from.gnss_bias_W;
  dx.segment<3>(kMagBias) = (to.mag_bias_B - from.mag_bias_B) / kMicrotesla;
  dx.segment<2>(kAirScale) = to.air_scale_B - from.air_scale_B;
  dx(kGust) = to.gust_down_m_s - from.gust_down_m_s;
  dx(kLiftOffset) = to.lift_offset_rad - from.lift_offset_rad;
  return dx;
}

/// The verdict on a scalar residual, without its gain.
ErrorStateEkf::Verdict ErrorStateEkf::judged(const Residual<1>& r, const Error& PHt,
                                             double gate_sigma) {
  Verdict verdict;
  verdict.variance = (r.H * PHt)(0) + r.R(0);
  verdict.nis = r.nu(0) * r.nu(0) / verdict.variance;
  verdict.accepted = verdict.nis >= 0.0 && verdict.nis <= gate(1, gate_sigma);
  return verdict;
}

ErrorStateEkf::Verdict ErrorStateEkf::correct_heading(const Residual<1>& r, double gate_sigma) {
  const Error PHt = covariance_by(r.H);
  Verdict verdict = judged(r, PHt, gate_sigma);
  if (!verdict.accepted) return verdict;
  const Vector3 down_B = x_.q_WB.conjugate() * Vector3::UnitZ();
  for (const int first : {kTheta, kGyroBias}) {
    verdict.gain.segment<3>(first) =
        down_B * (down_B.dot(PHt.segment<3>(first)) / verdict.variance);
  }
  verdict.gain.segment<3>(kMagBias) = PHt.segment<3>(kMagBias) / verdict.variance;
  consider(r, PHt, verdict);
  return verdict;
}

ErrorStateEkf::Verdict ErrorStateEkf::correct_gust(const Residual<1>& r, double gate_sigma) {
  const Error PHt = covariance_by(r.H);
  Verdict verdict = judged(r, PHt, gate_sigma);
  if (!verdict.accepted) return verdict;
  for (const int k : {kGust, kLiftOffset}) verdict.gain(k) = PHt(k) / verdict.variance;
  consider(r, PHt, verdict);
  return verdict;
}

/// P - K H P - (K H P)' + K S K' for the gain of the verdict, and its correction.
void ErrorStateEkf::consider(const Residual<1>& r, const Error& PHt, const Verdict& verdict) {
  const Error& K = verdict.gain;
  const Error half = 0.5 * verdict.variance * K - PHt;
  // Symmetric to the bit: the two products change places.
  for (int column = 0; column < kSize; ++column) {
    P_.col(column) += K * half(column) + half * K(column);
  }
  inject(K * r.nu(0));
}

ErrorStateEkf::LowerTriangle ErrorStateEkf::lower_covariance() const {
  LowerTriangle out{};
  std::size_t k = 0;
  for (int column = 0; column < kSize; ++column) {
    for (int row = column; row < kSize; ++row) out[k++] = P_(row, column);
  }
  return out;
}

void ErrorStateEkf::set_lower_covariance(const LowerTriangle& lower) {
  std::size_t k = 0;
  for (int column = 0; column < kSize; ++column) {
    for (int row = column; row < kSize; ++row) P_(row, column) = P_(column, row) = lower[k++];
  }
}

void ErrorStateEkf::inject(const Error& dx) {
  x_ = added(x_, dx);
  constexpr double kTiny_rad2 = 1e-8;  // G is one to 1e-4
  if (dx.segment<3>(kTheta).squaredNorm() < kTiny_rad2) return;
  const Matrix3 G = Matrix3::Identity() - 0.5 * skew(dx.segment<3>(kTheta));
  P_.middleRows<3>(kTheta) = (G * P_.middleRows<3>(kTheta)).eval();
  P_.middleCols<3>(kTheta) = (P_.middleCols<3>(kTheta) * G.transpose()).eval();
}

void ErrorStateEkf::reset_variance(int first, int size, double sigma) {
  P_.middleRows(first, size).setZero();
  P_.middleCols(first, size).setZero();
  for (int k = first; k < first + size; ++k) P_(k, k) = sigma * sigma;
}

void ErrorStateEkf::couple(int first, int other, int size, double sigma) {
  P_.middleRows(first, size) = -P_.middleRows(other, size).eval();
  P_.middleCols(first, size) = P_.middleRows(first, size).transpose().eval();
  P_.block(first, first, size, size) = P_.block(other, other, size, size).eval();
  for (int k = first; k < first + size; ++k) P_(k, k) += sigma * sigma;
}

void ErrorStateEkf::relearn_baro_bias(double height_m, double sigma_m) {
  x_.baro_bias_m = height_m + x_.p_W.z();
  P_.row(kBaroBias) = P_.row(kPosition + 2);
  P_.col(kBaroBias) = P_.col(kPosition + 2);
  P_(kBaroBias, kBaroBias) = P_(kPosition + 2, kPosition + 2) + sigma_m * sigma_m;
}

}  // namespace rosflight::autonomy::estimation
