// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/estimation/estimator_config.hpp"
#include "autonomy/estimation/measurements.hpp"

namespace rosflight::autonomy::estimation {

/// Averages the sensors over a window until a filter can start from them.
class Alignment {
 public:
  /// Mean and spread of a vector, in its unit.
  struct Mean {
    Vector3 sum{Vector3::Zero()};
    double squares{};
    int count{};
    /// One more sample; must be finite.
    void add(const Vector3& v) {
      sum += v;
      squares += v.squaredNorm();
      ++count;
    }
    Vector3 mean() const { return sum / count; }
    /// Root of the summed variances of the axes.
    double spread() const {
      const double variance = squares / count - mean().squaredNorm();
      return variance > 0.0 ? std::sqrt(variance) : 0.0;
    }
  };

  /// Begins a new window.
  void clear() { *this = {}; }
  /// One more sample of the window. IMU samples, in order of time, define its length; of GNSS fixes
  /// the last is kept as well.
  void add(const ImuSample& s) {
    if (gyro.count == 0) start_s = s.t_s;
    end_s = s.t_s;
    gyro.add(s.gyro_rad_s);
    accel.add(s.accel_m_s2);
  }
  void add(const MagSample& s) { field.add(s.field_T); }
  void add(const BaroSample& s) { pressure_Pa.add({s.pressure_Pa, 0.0, 0.0}); }
  void add(const GnssSample& s) {
    last_fix = s;
    fixes.add({s.position.latitude_deg, s.position.longitude_deg, s.position.altitude_m});
  }
  void add(const PoseSample& s) { last_pose = s; }
  double length_s() const { return gyro.count > 1 ? end_s - start_s : 0.0; }
  bool complete() const { return gyro.count > 1 && field.count > 0 && pressure_Pa.count > 0; }
  /// As still as something that stands on the ground with its motors off.
  bool still(double gravity_m_s2) const {
    constexpr double kTurning_rad_s = 0.05;
    constexpr double kShaking_m_s2 = 1.0;
    return gyro.spread() < kTurning_rad_s && accel.spread() < kShaking_m_s2 &&
           std::abs(accel.mean().norm() - gravity_m_s2) < kShaking_m_s2;
  }

  double start_s{};
  double end_s{};
  Mean gyro, accel, field, pressure_Pa, fixes;
  std::optional<GnssSample> last_fix;
  std::optional<PoseSample> last_pose;
};

/// Roll and pitch from the specific force that an accelerometer measures at rest, heading from the
/// magnetic field levelled with them.
inline Quaternion level_attitude(const Vector3& accel_B, const Vector3& field_B,
                                 double declination_rad) {
  const Vector3 down_B = -accel_B.normalized();
  const Vector3 east_B = down_B.cross(field_B).normalized();
  const Vector3 north_B = east_B.cross(down_B);
  Matrix3 R_MB;  // M: magnetic north, east, down
  R_MB.row(0) = north_B.transpose();
  R_MB.row(1) = east_B.transpose();
  R_MB.row(2) = down_B.transpose();
  return (exp_rotation({0.0, 0.0, declination_rad}) * Quaternion(R_MB)).normalized();
}

/// Turns an attitude about the vertical until the field points to magnetic north.
inline Quaternion with_heading_of(const Quaternion& q_WB, const Vector3& field_B,
                                  double declination_rad) {
  const Vector3 m = q_WB * field_B;
  return exp_rotation({0.0, 0.0, declination_rad - std::atan2(m.y(), m.x())}) * q_WB;
}

}  // namespace rosflight::autonomy::estimation
