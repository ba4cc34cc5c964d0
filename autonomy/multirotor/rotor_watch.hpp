// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "autonomy/multirotor/thrust_model.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

/// Rotors, and what the flight controller's mixer does with a command.
struct RotorWatchConfig {
  struct Rotor {
    Vector3 p_B{Vector3::Zero()};
    Vector3 e_B{-Vector3::UnitZ()};  ///< Unit thrust direction.
    double spin{1.0};                ///< Drag torque along spin * e_B.
    std::size_t output{};
    std::array<double, 4> gain{};  ///< Output of the mixer per lift, roll, pitch and yaw command.
  };
  std::vector<Rotor> rotors;  ///< Empty: nothing is watched.
  Eigen::Matrix3d inertia_kg_m2{Eigen::Matrix3d::Identity()};
  double drag_per_thrust_m{};    ///< C_Q D/C_T.
  double rotor_drag_s_m{};       ///< Force across a rotor per thrust and speed.
  double thrust_gain_N_s2{1.0};  ///< Thrust per squared speed of a rotor.
  double rotor_inertia_kg_m2{};  ///< With the motor's bell.
  ThrustModel::Curve curve{};
  double weight_N{};
};

/// Finds a rotor that gives no thrust, from the outputs that the flight controller reports and the
/// rates that the vehicle turns with, and says whether yaw can still be commanded without it.
///
/// With the torques m_i that outputs and thrust curve promise, d of the rotors' drag in still air, and the
/// angular momentum h that the rotors take from the body as they speed up,
///
///     r = F dw/dt - F J^-1 (sum m_i + d + dh/dt - w x J w) - bias,   F = 1/(0.1 s + 1)     (1)
///     f_i = -<r . g_i>/<g_i . g_i>,   g_i = F J^-1 m_i                                      (2)
///
/// <> being means over the last 0.2 s, each axis in units of what one rotor can do in hover. f_i is
/// the share of its torque that rotor i lacks, <r . g_i>^2/(<r . r><g_i . g_i>) the share of the
/// residual that this explains. A rotor is lost when both are high for 0.2 s. The bias, a low-pass
/// of r over 8 s that keeps its direction over ground in a turn, is what the wind does.
///
/// Without rotor j the mixer K still balances the weight where
///
///     B D_j K u = (weight, 0, 0, 0)                                                         (3)
///
/// has a solution whose outputs K u are within their range, B being thrusts to lift and torques and
/// D_j the identity without j. On a hexarotor of alternating spins it needs the opposite rotor at
/// exactly zero (G. Du et al., J. Guidance 38, 2015, "Controllability Analysis for Multirotor
/// Helicopter Rotor Degradation and Failure"): then yaw has to be given up.
class RotorWatch {
 public:
  RotorWatch() = default;
  explicit RotorWatch(const RotorWatchConfig& config);

  struct Input {
    std::span<const float> outputs;  ///< Reported; empty: unknown.
    const Vector3& w_B;
    Vector3 v_B{Vector3::Zero()};  ///< Velocity over ground.
    double voltage_V{};            ///< <= 0: nominal.
    double dt_s{};
  };
  /// Once a control period, in the air. @returns true in the step that finds a lost rotor.
  bool step(const Input& in);
  /// The vehicle stands, or somebody else flies: begins again, and what is lost stays lost.
  void interrupt();

  std::optional<std::size_t> lost() const { return lost_; }
  /// Yaw cannot be commanded any more.
  bool yaw_lost() const { return lost_ && !yaw_without_[*lost_]; }
  /// (3) for rotor j.
  bool yaw_without(std::size_t j) const { return yaw_without_[j]; }

 private:
  struct Rotor {
    std::size_t output{};
    Vector3 p_B{Vector3::Zero()};
    Vector3 e_B{-Vector3::UnitZ()};
    double spin{1.0};
    Vector3 turn{Vector3::Zero()};  ///< J^-1 of the torque per newton of thrust.
    Vector3 g{Vector3::Zero()};
    double gg{};
    double rg{};
  };
  bool solve_yaw(const RotorWatchConfig& config, std::size_t j) const;
  void judge(double dt_s);

  std::vector<Rotor> rotors_;
  std::vector<bool> yaw_without_;
  ThrustModel model_;  ///< Output of all rotors to thrust of all.
  Eigen::Matrix3d inertia_{Eigen::Matrix3d::Identity()};
  Eigen::Matrix3d inertia_inverse_{Eigen::Matrix3d::Identity()};
  Vector3 scale_{Vector3::Ones()};  ///< Scale of the axes in (2).
  Vector3 w_slow_B_{Vector3::Zero()};
  Vector3 promised_{Vector3::Zero()};
  Vector3 bias_{Vector3::Zero()};
  double rotor_drag_s_m_{};
  double thrust_gain_{1.0};
  double rotor_inertia_kg_m2_{};
  Vector3 momentum_slow_{Vector3::Zero()};
  double rr_{};
  std::size_t suspect_{};
  double suspected_s_{};
  double running_s_{};
  std::optional<std::size_t> lost_;
};

}  // namespace rosflight::autonomy::multirotor
