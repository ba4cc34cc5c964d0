// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "autonomy/common/geodesy.hpp"

/// What sensors tell an estimator. t_s is when it was true, on one clock for all of them; SI units,
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
  Geodetic place;  ///< Height above mean sea level.
  Eigen::Vector3d v_N_m_s{Eigen::Vector3d::Zero()};
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

}  // namespace rosflight::autonomy::estimation
