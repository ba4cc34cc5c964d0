// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::autonomy {

/// Quality of one part of a state estimate.
enum class Quality : std::uint8_t {
  kNone,          ///< Not available.
  kDeadReckoned,  ///< Propagated by the IMU since the last measurement that aided it.
  kGood           ///< Aided by recent measurements.
};

/// The state of a vehicle at one time, for multirotor and fixed wing; the input of guidance and
/// control. W = local north-east-down from the origin, B = body front-right-down at its own origin
/// (centre of mass), q_WB takes B coordinates to W. Fields that an estimator does not provide are
/// zero; wind_valid and air_valid are then false.
struct StateEstimate {
  double t_s{};  ///< Time of all fields, on the clock of the measurements.

  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};             ///< [m]
  Eigen::Vector3d v_W{Eigen::Vector3d::Zero()};             ///< Over ground [m/s].
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};  ///< Normalised.
  Eigen::Vector3d w_B{Eigen::Vector3d::Zero()};             ///< Rates, bias removed [rad/s].
  Eigen::Vector3d a_B{Eigen::Vector3d::Zero()};           ///< Specific force, bias removed [m/s^2].
  Eigen::Vector3d gyro_bias_B{Eigen::Vector3d::Zero()};   ///< [rad/s]
  Eigen::Vector3d accel_bias_B{Eigen::Vector3d::Zero()};  ///< [m/s^2]
  double baro_bias_m{};  ///< Barometric altitude above the origin minus -p_W.z.

  Eigen::Vector3d wind_W{Eigen::Vector3d::Zero()};  ///< Velocity of the air over ground [m/s].
  double airspeed_m_s{};                            ///< |v_W - wind_W|, not the raw pitot.
  double alpha_rad{};                               ///< Angle of attack of v_W - wind_W.
  double beta_rad{};                                ///< Sideslip: asin(v_air_y / airspeed).
  double course_rad{};  ///< atan2(v_east, v_north); heading below 0.5 m/s.

  // Standard deviations, by the filter.
  Eigen::Vector3d p_sigma_W_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d v_sigma_W_m_s{Eigen::Vector3d::Zero()};
  Eigen::Vector3d attitude_sigma_B_rad{Eigen::Vector3d::Zero()};
  Eigen::Vector3d wind_sigma_W_m_s{Eigen::Vector3d::Zero()};

  Quality attitude{Quality::kNone};
  Quality heading{Quality::kNone};
  Quality horizontal{Quality::kNone};  ///< Position and velocity, north and east.
  Quality vertical{Quality::kNone};    ///< Altitude and climb rate.
  bool wind_valid{};
  bool air_valid{};  ///< airspeed, alpha, beta.

  /// Time since horizontal position or velocity was aided, by GNSS or by standing still [s].
  double dead_reckoning_s{};
  /// The horizontal position may be off by more than kUnreliable_m: do not land or fly low by it.
  /// Attitude, altitude and airspeed have qualities of their own. False before the start.
  bool position_unreliable{};
  /// IMU samples were missing (link cut, firmware restarted): the state was carried on by what was
  /// known, with a grown covariance, and nothing has aided position or velocity since.
  bool bridging{};
  static constexpr double kUnreliable_m = 15.0;  ///< Against three standard deviations.

  /// Every part is at least dead reckoned.
  bool usable() const {
    return attitude != Quality::kNone && heading != Quality::kNone &&
           horizontal != Quality::kNone && vertical != Quality::kNone;
  }
};

}  // namespace rosflight::autonomy
