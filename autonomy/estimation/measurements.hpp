// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <variant>

#include "autonomy/common/geodesy.hpp"

/// Inputs of an estimator. t_s is the time of the measurement, on one clock for all; SI units,
/// body axes front-right-down.
namespace rosflight::autonomy::estimation {

struct ImuSample {
  double t_s{};
  Eigen::Vector3d gyro_rad_s{Eigen::Vector3d::Zero()};
  Eigen::Vector3d accel_m_s2{Eigen::Vector3d::Zero()};  ///< Specific force; at rest (0, 0, -g).
};

struct GnssSample {
  double t_s{};
  double unix_s{};  ///< For the magnetic model.
  bool fix_3d{};
  Geodetic position;  ///< Altitude above mean sea level.
  Eigen::Vector3d v_W_m_s{Eigen::Vector3d::Zero()};
};

struct BaroSample {
  double t_s{};
  double pressure_Pa{};
};

struct MagSample {
  double t_s{};
  Eigen::Vector3d field_T{Eigen::Vector3d::Zero()};
};

struct RangeSample {
  double t_s{};
  double range_m{};
  double min_m{};
  double max_m{};
};

/// Pitot tube: total less static pressure.
struct PitotSample {
  double t_s{};
  double pressure_Pa{};
};

/// Vane or probe: speed through the air to the right. The assumption of no sideslip is a zero of
/// it.
struct SideslipSample {
  double t_s{};
  double v_air_y_m_s{};
};

/// Position and attitude by a system outside, such as motion capture, in the local frame W.
struct PoseSample {
  double t_s{};
  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};  ///< Position of the body's origin [m].
  /// Not aligned, because one alignment counts for all kinds of samples: it took 2 kB of each estimator's queue.
  using Attitude = Eigen::Quaternion<double, Eigen::DontAlign>;
  Attitude q_WB{Attitude::Identity()};
};

/// Every measurement that aids the IMU.
using AidSample = std::variant<GnssSample, BaroSample, MagSample, RangeSample, PitotSample,
                               SideslipSample, PoseSample>;

}  // namespace rosflight::autonomy::estimation
