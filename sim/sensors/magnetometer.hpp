// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/sampling.hpp"
#include "sim/sensors/vector_errors.hpp"

namespace rosflight::sim::sensors {

/// Magnetic field through the iron of the vehicle:
///
///     y = E( S R_SB R_WB^T B_W ) ,  hard iron = fixed_bias and turn_on_bias of E      (1)
///
/// with soft iron S and the error model E of sim/noise.hpp. A firmware that knows S and the bias b
/// recovers the field as S^-1 (y - b).
class Magnetometer {
 public:
  using Sample = hal::MagSample;

  struct Config {
    Timing timing;
    VectorErrorParameters field_T;
    Eigen::Matrix3d soft_iron{Eigen::Matrix3d::Identity()};
    Vector3 rotation_deg{
        Vector3::Zero()};  ///< Mounting: the MAG_ROLL, MAG_PITCH, MAG_YAW that undo it.
    Temperature temperature;
  };

  /// @param source  of the random errors.
  Magnetometer(const Config& config, const Vector3& field_W_T, const RandomSource& source);
  /// (1) with its errors.
  bool measure(const Truth& truth, Sample& sample);

 private:
  Eigen::Matrix3d distortion_;  ///< S R_SB.
  Temperature temperature_;
  Vector3 field_W_T_;
  VectorErrorModel errors_;
};

}  // namespace rosflight::sim::sensors
