// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::autonomy {

/// How far a part of the estimate can be relied on.
enum class Trust : std::uint8_t {
  kNone,          ///< Never known.
  kDeadReckoned,  ///< Known once; carried on by the IMU since its last aiding.
  kGood
};

/// What an estimator knows of a vehicle at one time: the only thing that guidance and control see
/// of it, the same for multirotor and fixed wing. N = local north-east-down from the origin, B =
/// body front-right-down at its own origin (centre of mass), q_NB takes B coordinates to N. Fields
/// that an estimator does not have are zero, and wind_valid, air_valid say so.
struct StateEstimate {
  double t_s{};  ///< What all of it refers to, on the clock of the measurements.

  Eigen::Vector3d p_N{Eigen::Vector3d::Zero()};             ///< [m]
  Eigen::Vector3d v_N{Eigen::Vector3d::Zero()};             ///< Over ground [m/s].
  Eigen::Quaterniond q_NB{Eigen::Quaterniond::Identity()};  ///< Normalised.
  Eigen::Vector3d w_B{Eigen::Vector3d::Zero()};             ///< Rates, bias removed [rad/s].
  Eigen::Vector3d a_B{Eigen::Vector3d::Zero()};           ///< Specific force, bias removed [m/s^2].
  Eigen::Vector3d gyro_bias_B{Eigen::Vector3d::Zero()};   ///< [rad/s]
  Eigen::Vector3d accel_bias_B{Eigen::Vector3d::Zero()};  ///< [m/s^2]
  double baro_bias_m{};                                   ///< Baro height minus -p_N.z.

  Eigen::Vector3d wind_N{Eigen::Vector3d::Zero()};  ///< Velocity of the air over ground [m/s].
  double airspeed_m_s{};                            ///< |v_N - wind_N|, not the raw pitot.
  double alpha_rad{};                               ///< Angle of attack of v_N - wind_N.
  double beta_rad{};                                ///< Sideslip: asin(v_air_y / airspeed).
  double course_rad{};  ///< atan2(v_east, v_north); heading below 0.5 m/s.

  // Standard deviations, by the filter.
  Eigen::Vector3d p_sigma_N_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d v_sigma_N_m_s{Eigen::Vector3d::Zero()};
  Eigen::Vector3d attitude_sigma_B_rad{Eigen::Vector3d::Zero()};
  Eigen::Vector3d wind_sigma_N_m_s{Eigen::Vector3d::Zero()};

  Trust attitude{Trust::kNone};
  Trust heading{Trust::kNone};
  Trust horizontal{Trust::kNone};  ///< Position and velocity, north and east.
  Trust vertical{Trust::kNone};    ///< Height and climb.
  bool wind_valid{};
  bool air_valid{};  ///< airspeed, alpha, beta.

  bool usable() const {
    return attitude != Trust::kNone && heading != Trust::kNone && horizontal != Trust::kNone &&
           vertical != Trust::kNone;
  }
};

}  // namespace rosflight::autonomy
