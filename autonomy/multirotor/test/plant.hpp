// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/multirotor/angles.hpp"
#include "autonomy/multirotor/thrust_model.hpp"
#include "autonomy/multirotor/types.hpp"

/// A small world for closed-loop tests: rigid body, motors as a first-order lag, rotor drag, wind,
/// flat ground, and the attitude loops of a flight controller. Independent of the project's
/// simulation.
namespace rosflight::autonomy::multirotor::test {

/// The default quadrotor of ROSflight 2.x (sim parameters, section multirotor).
inline RotorData default_rotors() {
  return {.count = 4,
          .thrust_coefficient = 0.08729101,
          .torque_coefficient = 0.00428594,
          .diameter_m = 0.381,
          .motor_constant = 0.028937,
          .resistance_ohm = 0.042,
          .no_load_current_A = 1.5,
          .supply_voltage_V = 24.0,
          .air_density_kg_m3 = 1.225};
}

struct PlantConfig {
  double mass_kg{3.5};
  double gravity_m_s2{9.81};
  Vector3 inertia_kg_m2{0.08, 0.08, 0.12};
  double motor_lag_s{0.05};
  double drag_1_s{0.49};
  Vector3 wind_W{Vector3::Zero()};
  double ground_down_m{0.0};
  double thrust_scale{1.0};  ///< What the motors really give, over what the model predicts.
  double attitude_frequency_rad_s{10.0};
  double attitude_damping{0.8};
  double yaw_rate_lag_s{0.15};
};

class Plant {
 public:
  Plant(const PlantConfig& config, const ThrustModel& thrust) : config_(config), thrust_(thrust) {
    state_.p_W.z() = config.ground_down_m;
  }

  void step(const FirmwareCommand& command, bool armed, double dt_s) {
    const double wanted_N = armed ? config_.thrust_scale * wanted_thrust(command) : 0.0;
    thrust_N_ += (wanted_N - thrust_N_) * std::min(dt_s / config_.motor_lag_s, 1.0);
    rotate(armed ? wanted_torque(command) : Vector3::Zero(), dt_s);
    const Vector3 up_W = state_.q_WB * Vector3(0.0, 0.0, -1.0);
    Vector3 a =
        up_W * (thrust_N_ / config_.mass_kg) - config_.drag_1_s * (state_.v_W - config_.wind_W);
    specific_B_ = state_.q_WB.conjugate() * a;
    a.z() += config_.gravity_m_s2;
    state_.v_W += a * dt_s;
    state_.p_W += state_.v_W * dt_s;
    on_ground_ = state_.p_W.z() >= config_.ground_down_m;
    if (on_ground_) {
      impact_m_s_ = std::max(impact_m_s_, state_.v_W.z());
      state_.p_W.z() = config_.ground_down_m;
      state_.v_W = Vector3(0.0, 0.0, std::min(state_.v_W.z(), 0.0));
      level_out();
      specific_B_ = {0.0, 0.0, -config_.gravity_m_s2};
    }
  }

  const State& state() const { return state_; }
  State& state() { return state_; }
  PlantConfig& config() { return config_; }
  const PlantConfig& config() const { return config_; }
  double thrust_N() const { return thrust_N_; }
  bool on_ground() const { return on_ground_; }
  /// What an accelerometer measures.
  const Vector3& specific_B() const { return specific_B_; }
  /// Highest speed into the ground since the last call.
  double take_impact_m_s() { return std::exchange(impact_m_s_, 0.0); }

 private:
  double wanted_thrust(const FirmwareCommand& command) const {
    if (command.ignore != 0) return 0.0;
    if (command.mode == FirmwareMode::kPassThrough) return -static_cast<double>(command.u[2]);
    return thrust_.thrust_N(static_cast<double>(command.u[2]));
  }

  Vector3 wanted_torque(const FirmwareCommand& command) const {
    Vector3 cmd(static_cast<double>(command.u[3]), static_cast<double>(command.u[4]),
                static_cast<double>(command.u[5]));
    if (command.mode == FirmwareMode::kPassThrough) return cmd;
    const double w = config_.attitude_frequency_rad_s;
    const Vector3& j = config_.inertia_kg_m2;
    const RollPitch at = RollPitch::of(state_.q_WB);
    const double kd = 2.0 * config_.attitude_damping * w;
    return {j.x() * (w * w * (cmd.x() - at.roll_rad) - kd * state_.w_B.x()),
            j.y() * (w * w * (cmd.y() - at.pitch_rad) - kd * state_.w_B.y()),
            j.z() * (cmd.z() - state_.w_B.z()) / config_.yaw_rate_lag_s};
  }

  void rotate(const Vector3& torque_B, double dt_s) {
    const Vector3 momentum = config_.inertia_kg_m2.cwiseProduct(state_.w_B);
    state_.w_B +=
        (torque_B - state_.w_B.cross(momentum)).cwiseQuotient(config_.inertia_kg_m2) * dt_s;
    const Vector3 turn = state_.w_B * dt_s;
    state_.q_WB = (state_.q_WB * Quaternion(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()))
                      .normalized();
  }

  void level_out() {
    const AttitudeView at(state_.q_WB);
    state_.q_WB = Quaternion(std::cos(0.5 * at.psi_rad), 0.0, 0.0, std::sin(0.5 * at.psi_rad));
    state_.w_B.setZero();
  }

  PlantConfig config_;
  ThrustModel thrust_;
  State state_{};
  Vector3 specific_B_{Vector3::Zero()};
  double thrust_N_{};
  double impact_m_s_{};
  bool on_ground_{true};
};

}  // namespace rosflight::autonomy::multirotor::test
