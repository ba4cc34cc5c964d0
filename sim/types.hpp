// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/atmosphere.hpp"
#include "firmware/hal/samples.hpp"

/// Types of the simulated world. Double precision, SI. W is local north-east-down with its origin at
/// the start point, B is body front-right-down at the centre of mass; q_WB takes B coordinates to W.
namespace rosflight::sim {

using hal::Time;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// A time or a span of it [s].
inline double to_seconds(Time t) {
  return static_cast<double>(t.count()) * 1e-6;
}

/// Motion of a rigid body.
struct BodyState {
  Vector3 p_W{Vector3::Zero()};  ///< Position [m].
  Quaternion q_WB{Quaternion::Identity()};
  Vector3 v_B{Vector3::Zero()};  ///< Velocity over ground, in body axes [m/s].
  Vector3 w_B{Vector3::Zero()};  ///< Angular velocity [rad/s].
};

struct Wrench {
  Vector3 force_B{Vector3::Zero()};   ///< [N]
  Vector3 torque_B{Vector3::Zero()};  ///< About the centre of mass [N m].
};

/// Air at the vehicle.
struct Air {
  double density_kg_m3{base::kSeaLevelDensity_kg_m3};
  double pressure_Pa{base::kSeaLevelPressure_Pa};
  double temperature_K{base::kSeaLevelTemperature_K};
  Vector3 wind_W{Vector3::Zero()};  ///< Velocity of the air over ground [m/s].
};

inline constexpr std::size_t kMaxRotors = 10;

/// The complete state of the vehicle at one time, for sensors, visualisers and logs.
struct Truth {
  Time time{};
  BodyState body;
  /// (All forces but gravity)/mass, ground included: the reading of an ideal accelerometer at the centre
  /// of mass.
  Vector3 specific_force_B{Vector3::Zero()};
  /// Derivative of w_B [rad/s^2], gyroscopic part included.
  Vector3 angular_acceleration_B{Vector3::Zero()};
  Air air;  ///< At `body`; the wind is that of the last step.
  /// Without ground: that of the forces-and-moments module, changed by an ExternalWrench if there is one.
  Wrench wrench;
  bool on_ground{true};
  double battery_voltage_V{};
  double battery_current_A{};
  std::size_t rotor_count{};
  std::array<double, kMaxRotors> rotor_speed_rad_s{};
  double aileron_rad{};  ///< Aileron deflection; fixed wing only, like the next two.
  double elevator_rad{};
  double rudder_rad{};
};

/// Samples that became available in one step.
struct SensorSamples {
  bool has_imu{}, has_mag{}, has_baro{}, has_diff_pressure{}, has_range{}, has_gnss{},
      has_battery{};
  hal::ImuSample imu;
  hal::MagSample mag;
  hal::BaroSample baro;
  hal::DiffPressureSample diff_pressure;
  hal::RangeSample range;
  hal::GnssSample gnss;
  hal::BatterySample battery;
};

}  // namespace rosflight::sim
