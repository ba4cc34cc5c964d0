// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>

#include "autonomy/common/geodesy.hpp"
#include "autonomy/common/types.hpp"
#include "autonomy/estimation/error_state_ekf.hpp"
#include "autonomy/estimation/measurements.hpp"
#include "base/constants.hpp"

namespace rosflight::autonomy::estimation {

/// A fixed wing has wind, pitot and sideslip besides.
enum class Airframe : std::uint8_t { kMultirotor, kFixedWing };

/// A gyro that is suddenly wrong by up to this is found out.
inline constexpr double kGyroStepLimit_rad_s = 0.5;

/// What the accelerometer measures of the air, from the vehicle file; all zero: not used.
struct AirModel {
  double rotor_drag_s_m{};   ///< In-plane force per thrust and speed, along x and y.
  double drag_area_m2_kg{};  ///< C_D A of the body by its mass, along x and y.
  double side_area_m2_kg{};  ///< Wing area times -dC_Y/dbeta by mass, along y.
  LiftModel lift{};
  /// Along an axis in body axes, with this thrust by mass [m/s^2] in air of this density.
  AirForce along(int axis, double thrust_m_s2, double density_kg_m3) const {
    const double area_m2_kg = drag_area_m2_kg + (axis == 1 ? side_area_m2_kg : 0.0);
    return {rotor_drag_s_m * thrust_m_s2, 0.5 * density_kg_m3 * area_m2_kg};
  }
};

/// Settings of an Estimator; the keys of the section `autonomy.estimator` in a vehicle file.
/// Sigmas are standard deviations of one sample.
struct EstimatorConfig {
  double gravity_m_s2{base::kStandardGravity_m_s2};
  /// The filter works this far behind the newest IMU sample, so that what is late by up to this is
  /// still fused at its own time; the output is carried on to the newest sample.
  double lag_s{0.06};
  double max_lag_s{0.7};     ///< To which GNSS that comes later may raise it.
  double increment_s{0.01};  ///< IMU samples are summed up to this.

  // Where things are, in body axes from the body's origin [m].
  Vector3 imu_position_B{Vector3::Zero()};
  Vector3 gnss_position_B{Vector3::Zero()};
  Vector3 range_position_B{Vector3::Zero()};
  double height_at_rest_m{};  ///< Body origin above the ground at rest.

  ProcessNoise noise{};
  AirModel air{};

  double gnss_horizontal_sigma_m{0.022};  ///< Noise from fix to fix; the slow error is in `noise`.
  double gnss_altitude_sigma_m{0.045};
  double gnss_velocity_sigma_m_s{0.051};
  double gnss_position_sigma_m{0.05};  ///< Error of gnss_position_B.
  double gnss_time_sigma_s{0.01};      ///< Error of the stamp of a fix.
  double baro_sigma_m{0.05};
  double mag_sigma_T{3e-7};         ///< Noise of each axis.
  double heading_sigma_rad{0.005};  ///< Besides: declination.
  double range_sigma_m{0.012};
  double pitot_sigma_Pa{1.1};
  double sideslip_sigma_m_s{1.0};
  double air_force_sigma_m_s2{0.055};
  double air_force_turning_m_s{0.3};  ///< Fixed wing: besides, times the rate of turning.
  double lift_sigma_m_s2{0.3};        ///< Specific force of the lift, averaged.
  double lift_turning_m_s{1.0};       ///< Besides, times the rate of turning.
  double pose_position_sigma_m{0.005};
  double pose_heading_sigma_rad{0.01};
  double rest_sigma_m_s{0.02};  ///< Noise of the zero velocity at rest.

  // Longest rates at which samples are fused; 0: all.
  double mag_interval_s{0.05};
  double baro_interval_s{0.0};
  double pitot_interval_s{0.05};
  double air_force_interval_s{0.05};  ///< Specific force is averaged over this.
  double rest_interval_s{0.1};

  double gate_sigma{5.0};
  double heading_gate_sigma{4.0};
  bool use_pose{true};  ///< That of motion capture.
  bool use_range{true};
  double range_delay_s{0.0};  ///< Taken off the stamps of echoes.
  double range_max_tilt_rad{0.5};
  double min_airspeed_m_s{6.0};  ///< Below, pitot and sideslip are not fused.
  bool use_sideslip{true};
  bool hovers{false};  ///< A fixed wing that also hovers: AidFusion::fuse_hovering().

  // What is known before the first sample.
  double initial_gyro_bias_rad_s{0.01};
  double initial_accel_bias_m_s2{0.05};
  double initial_wind_m_s{4.0};
  double initial_mag_bias_T{6e-7};        ///< Each axis.
  double initial_air_scale{0.4};          ///< Relative error of `air`.
  double initial_lift_offset_rad{0.02};   ///< Error of `air.lift`, as an angle of attack.
  double initial_window_s{1.0};           ///< Averaged before the start.
  std::optional<double> declination_rad;  ///< Known beforehand.
  /// Else asked once, with the first fix: a magnetic model. Neither: magnetic north is taken for
  /// true.
  double (*declination_at)(const GnssSample& fix){nullptr};  ///< [rad]
  std::optional<Geodetic> origin;  ///< Origin of W; else the start, by the first fixes.

  /// Whether the owner passes the attitude on to the flight controller, whose own filter takes drag
  /// and turns for tilt.
  bool share_attitude{true};

  // Timeouts of rejected measurements.
  double gnss_rejected_s{0.3};  ///< Velocity rejected for this long: IMU errors are widened.
  double pose_reset_s{0.5};     ///< Rejected for this long: the position is that of the pose.
  double gnss_reset_s{3.0};     ///< Rejected for this long: the estimate is reset to GNSS.
  double max_wind_noise_m_s_rts{1.0};  ///< To which gusts may raise noise.wind_m_s_rts; at first.
  double pitot_relearn_s{1.0};         ///< Rejected for this long, not blocked: a gust.
  double gnss_jump_s{1.0};        ///< Position alone rejected for this long: the receiver's jumped.
  double baro_relearn_s{1.0};     ///< Rejected for this long: its bias is estimated again.
  double range_relearn_s{1.0};    ///< Rejected for this long: the ground altitude is set again.
  double jump_speed_m_s{1.5};     ///< Min speed at which a late position correction is shown.
  double dead_reckoning_s{30.0};  ///< Without GNSS for this long: no position.
};

}  // namespace rosflight::autonomy::estimation
