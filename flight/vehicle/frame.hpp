// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/atmosphere.hpp"
#include "companion/parameter.hpp"
#include "config/strict_yaml.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight {

/// One rotor of a frame; body front-right-down.
struct FrameRotor {
  Eigen::Vector3d p_B{Eigen::Vector3d::Zero()};  ///< From the centre of mass [m].
  Eigen::Vector3d e_B{0.0, 0.0, -1.0};           ///< Unit thrust direction.
  double spin{1.0};  ///< +1 or -1: drag torque along spin * e_B; -1 on an upright rotor turns the
                     ///< nose right.
  std::size_t output{};  ///< Channel of the firmware that drives it, 0..9.
};

/// Geometry, propeller and motor of a multirotor (docs/mixer.md).
struct FrameConfig {
  std::vector<FrameRotor> rotors;  ///< 1..10.
  double air_density_kg_m3{base::kSeaLevelDensity_kg_m3};
  double prop_diameter_m{};
  double prop_ct{};
  double prop_cq{};
  double mass_kg{};
  double motor_resistance_ohm{};
  double motor_kv_V_s_rad{};
  double no_load_current_A{};
  double max_voltage_V{};

  double thrust_gain_N_s2() const;   ///< kT = C_T rho D^4 / (4 pi^2).
  double torque_gain_Nm_s2() const;  ///< kQ = C_Q rho D^5 / (4 pi^2).
};

/// Reads and checks a frame file of ROSflight 2.x. @throws config::Error with one line: lists of different length, more
/// than ten motors, directions that are not unit vectors, spins other than +-1, values out of
/// range.
FrameConfig read_frame(const config::Document& document);
FrameConfig read_frame(const std::string& path);

/// Rotors of a vehicle of either kind, the air at its origin, and BATT_VOLT_MAX of its section
/// `firmware` or else the voltage of the full battery. Not checked as a frame.
/// @throws config::Error  an error in the sections of the rotors.
FrameConfig propulsion_frame(const sim::Vehicle& vehicle);

/// The same for a multirotor, checked.
/// @throws config::Error  a fixed wing; an output above 9; a frame that cannot command lift, roll,
///     pitch and yaw independently.
FrameConfig vehicle_frame(const sim::Vehicle& vehicle);

/// Forces and torques per squared rotor speed, 6 x n (ROSflight 2.0 paper, appendix):
///     M_i = [ kT e ; kT (r x e) + kQ spin e ]
Eigen::MatrixXd frame_matrix(const FrameConfig& frame);

/// Moore-Penrose pseudo-inverse, n x 6, in single precision as the firmware computes its own
/// (core::pseudo_inverse).
Eigen::MatrixXd frame_inverse(const Eigen::MatrixXd& M);

/// Which of [Fx Fy Fz Qx Qy Qz] a frame can command, and how well.
struct FrameQuality {
  int rank{};          ///< Trace of M M^+.
  double condition{};  ///< |M| |M^+|, Frobenius norms, lengths in mean arms; at least the rank.
  bool commands_lift_and_torque{};  ///< Fz, Qx, Qy, Qz independently.
};
FrameQuality frame_quality(const FrameConfig& frame, const Eigen::MatrixXd& M);

/// What the frame does when it hovers in its air, for a person to check.
struct HoverCheck {
  double speed_rad_s{};
  double voltage_V{};
  double throttle{};  ///< Fraction of max_voltage.
  double max_speed_rad_s{};
  double max_thrust_N{};
  double thrust_to_weight{};
};
HoverCheck hover_check(const FrameConfig& frame);

enum class MixerTarget { kPrimary, kSecondary };

/// NUM_MOTORS and what the firmware knows of motor and propeller.
companion::ParameterSet motor_parameters(const FrameConfig& frame);

/// Parameters for the firmware: all 100 gains (so that nothing stale stays), for the primary also
/// output types, rates, PRIMARY_MIXER = 11, USE_MOTOR_PARAM = 1, motor_parameters() and
/// BATT_VOLT_MAX.
companion::ParameterSet mixer_parameters(const FrameConfig& frame, MixerTarget target);

}  // namespace rosflight::flight
