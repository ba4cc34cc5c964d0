// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/common/battery_watch.hpp"
#include "autonomy/common/mission_file.hpp"
#include "autonomy/multirotor/landing.hpp"
#include "base/atmosphere.hpp"
#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "config/table_fwd.hpp"

namespace rosflight::autonomy::quadplane {

/// Values from other sections of the vehicle file; passed in, so that no number is written twice.
struct VehicleFacts {
  double mass_kg{};
  double gravity_m_s2{base::kStandardGravity_m_s2};
  Eigen::Matrix3d inertia_kg_m2{Eigen::Matrix3d::Identity()};
  double density_kg_m3{base::kSeaLevelDensity_kg_m3};  ///< At the start.
  double wing_area_m2{};
  double span_m{};
  double chord_m{};
  double lift_zero{};
  double lift_alpha_1_rad{};
  double stall_alpha_rad{kPi};     ///< Separation grows about this angle of attack,
  double stall_sharpness_1_rad{};  ///< within its inverse.
  double lift_max{};               ///< Largest lift coefficient before the stall.
  double drag_parasitic{};         ///< The booms and hubs of the rotors included.
  double drag_induced{};           ///< Times the lift coefficient squared.
  double pitch_zero{};
  double pitch_alpha_1_rad{};
  double pitch_q{};                  ///< By q c/2V.
  double roll_p{};                   ///< By p b/2V.
  double yaw_r{};                    ///< By r b/2V.
  Vector3 surface{Vector3::Zero()};  ///< Roll, pitch and yaw coefficient at a command of 1; > 0.
  double max_lift_force_N{};         ///< The lifting set together, by the firmware's parameters.
  /// Pusher: T = rho D^4 (c0 n^2 + c1 n V/D + c2 (V/D)^2), n revolutions per second.
  std::array<double, 3> pusher_thrust{};
  double pusher_diameter_m{};
  double max_pusher_thrust_N{};  ///< Static, on a full battery.
  double full_voltage_V{};
  BatteryConfig battery{};

  /// Stall speed on the wing alone, V_s = sqrt(2 m g/(rho S C_L,max)).
  double stall_speed_m_s() const;
};

struct FlightConfig {
  double cruise_m_s{17.0};        ///< Airspeed between the transitions.
  double wing_only_stalls{1.2};   ///< Lower end of wing-borne flight, in stall speeds.
  double acceleration_m_s2{2.0};  ///< Along the path, in the transition forward.
  double deceleration_m_s2{1.2};  ///< In the transition back.
  double max_bank_rad{35.0 * kRadPerDeg};
  double max_hover_tilt_rad{15.0 * kRadPerDeg};  ///< Nose up to brake on the rotors.
  double max_alpha_rad{7.0 * kRadPerDeg};        ///< The rotors carry what this leaves.
  double yaw_rate_rad_s{50.0 * kRadPerDeg};      ///< Largest rate of the commanded heading.
  double takeoff_speed_m_s{2.0};
  double takeoff_height_m{30.0};
  double roll_pitch_1_s{4.0};       ///< Attitude error to rate.
  double roll_pitch_rate_1_s{9.0};  ///< Rate error to angular acceleration.
  double yaw_1_s{1.5};
  double yaw_rate_1_s{4.0};
  double position_1_s{0.8};
  double velocity_1_s{1.6};
  double vertical_1_s{1.0};
  double vertical_speed_1_s{2.5};
  multirotor::LandingConfig landing{.speed_m_s = 1.5, .slow_height_m = 4.0};
  BatteryConfig battery{};
  VehicleFacts vehicle{};
};

struct MissionLimits {
  MissionArea area{};
  double turn_radius_m{100.0};
  double takeoff_height_m{30.0};
};

struct AutonomyConfig {
  FlightConfig flight{};
  MissionLimits mission{};
};

/// The parameters of the section `autonomy`: config/table.hpp.
config::Table<AutonomyConfig> parameters();

/// Reads the section `autonomy` of a quad-plane's vehicle file; every key may be absent. Throws
/// config::Error. Finishes the section.
AutonomyConfig read_autonomy(const config::Section& autonomy, const VehicleFacts& vehicle);

}  // namespace rosflight::autonomy::quadplane
