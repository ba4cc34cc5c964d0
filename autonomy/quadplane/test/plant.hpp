// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/quadplane/controller.hpp"
#include "autonomy/quadplane/mission.hpp"

/// A quad-plane of its own for tests of guidance alone: round numbers, a rigid body, perfect rotors and servos.
namespace rosflight::autonomy::quadplane::testing {

inline VehicleFacts facts() {
  VehicleFacts f;
  f.mass_kg = 6.0;
  f.inertia_kg_m2 = Vector3(0.4, 0.5, 0.9).asDiagonal();
  f.density_kg_m3 = 1.1;
  f.wing_area_m2 = 0.5;
  f.span_m = 2.0;
  f.chord_m = 0.25;
  f.lift_zero = 0.5;
  f.lift_alpha_1_rad = 5.5;
  f.stall_alpha_rad = 12.0 * kRadPerDeg;
  f.stall_sharpness_1_rad = 50.0;
  f.lift_max = 1.25;
  f.drag_parasitic = 0.06;
  f.drag_induced = 0.04;
  f.pitch_zero = 0.1;
  f.pitch_alpha_1_rad = -2.5;
  f.pitch_q = -35.0;
  f.roll_p = -0.5;
  f.yaw_r = -0.15;
  f.surface = {0.08, 0.45, 0.03};
  f.max_lift_force_N = 130.0;
  f.pusher_thrust = {0.09, -0.11, -0.13};
  f.pusher_diameter_m = 0.38;
  f.max_pusher_thrust_N = 32.0;
  f.full_voltage_V = 25.2;
  f.battery = {.cells = 6.0, .capacity_Ah = 8.0, .resistance_ohm = 0.0};
  return f;
}

inline FlightConfig config() {
  FlightConfig c;
  c.vehicle = facts();
  c.battery = c.vehicle.battery;
  return c;
}

/// North, a right angle, east, a right angle, south.
inline Mission mission() {
  Mission m;
  m.waypoints_W = {{400.0, 0.0, -40.0}, {400.0, 400.0, -40.0}, {50.0, 400.0, -30.0}};
  m.turn_radius_m = 80.0;
  return m;
}

/// Moves a state by a command of the controller.
class Plant {
 public:
  StateEstimate state{};
  Vector3 wind_W{Vector3::Zero()};
  double lift_share{1.0};  ///< Share of the lift that the wing should have.

  Plant() { state.a_B.z() = -9.80665; }

  /// The lift coefficient of a thin wing with a sudden stall.
  double lift_coefficient(double alpha_rad) const {
    const double stalled = f_.stall_alpha_rad;
    if (std::abs(alpha_rad) < stalled) return f_.lift_zero + f_.lift_alpha_1_rad * alpha_rad;
    const double sine = std::sin(alpha_rad);
    return 2.0 * sine * std::abs(sine) * std::cos(alpha_rad);
  }

  void step(const FirmwareCommand& command, double dt_s) {
    constexpr int kParts = 5;
    for (int k = 0; k < kParts; ++k) part(command, dt_s / kParts);
    state.t_s += dt_s;
    state.wind_W = wind_W;
    state.wind_valid = true;
    state.attitude = state.horizontal = state.vertical = Quality::kGood;
  }

 private:
  double pusher(double static_N, double forward_m_s) const {
    const double d = f_.pusher_diameter_m;
    const double scale = f_.density_kg_m3 * std::pow(d, 4);
    const auto& c = f_.pusher_thrust;
    const double n = std::sqrt(std::max(static_N, 0.0) / (scale * c[0]));
    const double u = forward_m_s / d;
    return scale * (c[0] * n * n + c[1] * n * u + c[2] * u * u);
  }

  void part(const FirmwareCommand& command, double dt_s) {
    const auto& u = command.u;
    const Vector3 air_B = state.q_WB.conjugate() * (state.v_W - wind_W);
    const double pressure_force_N = 0.5 * f_.density_kg_m3 * f_.wing_area_m2 * air_B.squaredNorm();
    const double speed = std::max(air_B.norm(), 1.0);
    const double alpha = air_B.x() > 1.0 ? std::atan2(air_B.z(), air_B.x()) : 0.0;
    const double lift =
        lift_share * pressure_force_N * (air_B.x() > 1.0 ? lift_coefficient(alpha) : 0.0);
    const double drag = pressure_force_N * (f_.drag_parasitic + 0.04 * lift_coefficient(alpha));
    Vector3 force_B(pusher(u[0], air_B.x()), -pressure_force_N * air_B.y() / speed, u[2]);
    force_B += lift * Vector3(std::sin(alpha), 0.0, -std::cos(alpha)) - drag * air_B / speed;
    const Vector3 arm(f_.span_m, f_.chord_m, f_.span_m);
    Vector3 torque_B(u[3], u[4], u[5]);
    torque_B +=
        pressure_force_N * arm.cwiseProduct(f_.surface.cwiseProduct(Vector3(u[6], u[7], u[8])));
    const Vector3 damping(f_.roll_p * f_.span_m, f_.pitch_q * f_.chord_m, f_.yaw_r * f_.span_m);
    torque_B += pressure_force_N * 0.5 / speed * arm.cwiseProduct(damping.cwiseProduct(state.w_B));
    if (air_B.x() > 1.0) {
      torque_B.y() +=
          pressure_force_N * f_.chord_m * (f_.pitch_zero + f_.pitch_alpha_1_rad * alpha);
      torque_B.z() += pressure_force_N * f_.span_m * 0.1 * air_B.y() / speed;
    }
    state.a_B = force_B / f_.mass_kg;
    state.v_W += dt_s * (state.q_WB * state.a_B + 9.80665 * Vector3::UnitZ());
    state.p_W += dt_s * state.v_W;
    const Vector3 spin = state.w_B.cross(f_.inertia_kg_m2 * state.w_B);
    state.w_B += dt_s * f_.inertia_kg_m2.inverse() * (torque_B - spin);
    const Vector3 turn = dt_s * state.w_B;
    if (turn.norm() > 0.0) {
      state.q_WB =
          (state.q_WB * Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized()))).normalized();
    }
    if (state.p_W.z() > 0.0) {  // level ground that holds
      state.p_W.z() = 0.0;
      state.v_W.setZero();
      state.w_B.setZero();
      state.a_B = state.q_WB.conjugate() * Vector3(0.0, 0.0, -9.80665);
    }
  }

  VehicleFacts f_{facts()};
};

}  // namespace rosflight::autonomy::quadplane::testing
