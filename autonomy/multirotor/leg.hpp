// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

/// Peak of the rest-to-rest quintic's first and second derivative: 15/8 at 1/2, 10/sqrt(3) at
/// (3-sqrt(3))/6.
inline constexpr double kQuinticPeakSpeed = 1.875;
inline constexpr double kQuinticPeakAcceleration = 5.773502691896258;

/// What one leg may ask of the vehicle.
struct LegLimits {
  double speed_m_s{5.0};
  double acceleration_m_s2{3.0};
  double yaw_rate_rad_s{1.0};
  double yaw_acceleration_rad_s2{2.0};
};

/// Smooth leg: each of north, east, down and heading is a quintic of tau = t/T that takes over
/// position, velocity and acceleration of the start and ends at rest in the target.
///
/// From rest it is p = p0 + sigma (p1 - p0), sigma = 6 tau^5 - 15 tau^4 + 10 tau^3, and
///
///     T = max(1.875 d/v_max, sqrt(5.7735 d/a_max)), the same for the heading                 (1)
///
/// (ROSflight 2.x, roscopter path manager). From motion T of (1) is stretched until the polynomial
/// keeps the limits, as far as the start itself does. The heading takes the shorter turn. For t >= T
/// the sample is exactly the target with zero derivatives; T = 0 (nothing to move) is a leg like
/// any other.
class QuinticLeg {
 public:
  QuinticLeg() = default;
  /// @param start   position [m], velocity, acceleration and heading [rad] at t = 0, in W.
  /// @param limits  > 0; kept as (1) says.
  QuinticLeg(const Trajectory& start, const Vector3& target_W, double target_psi_rad,
             const LegLimits& limits);

  /// Setpoint at t_s after the start, with three derivatives, in W; t_s < 0 counts as 0.
  Trajectory sample(double t_s) const;
  double duration_s() const { return duration_s_; }

 private:
  using Vector4 = Eigen::Vector4d;  ///< north, east, down, heading
  void fit(double duration_s);
  bool within(const LegLimits& limits) const;

  Vector4 start_{Vector4::Zero()};
  Vector4 start_rate_{Vector4::Zero()};
  Vector4 start_acceleration_{Vector4::Zero()};
  Vector4 target_{Vector4::Zero()};
  // Coefficients of rising powers of tau, of the leg and its three derivatives in time.
  std::array<Vector4, 6> p_{};
  std::array<Vector4, 5> v_{};
  std::array<Vector4, 4> a_{};
  std::array<Vector4, 3> j_{};
  double duration_s_{};
  double inverse_duration_1_s_{};
};

/// Straight leg at constant acceleration between two speeds:
///
///     T = 2 d/(V0 + V1),  s(t) = V0 t + (V1 - V0) t^2/(2 T)                                  (2)
///
/// (roscopter's linear interpolation in closed form). Two speeds of (almost) zero would never move:
/// the leg then accelerates and brakes at a_max with at most the speed limit in between
/// (trapezoid). The heading takes the shorter turn, in proportion to the distance flown.
class LinearLeg {
 public:
  LinearLeg() = default;
  /// @param start  at rest but for its speed along the leg; distance must be positive.
  LinearLeg(const Trajectory& start, const Vector3& target_W, double target_psi_rad,
            double start_speed_m_s, double end_speed_m_s, const LegLimits& limits);

  /// Setpoint at t_s after the start, with velocity and acceleration, in W; clipped to
  /// 0..duration_s().
  Trajectory sample(double t_s) const;
  double duration_s() const { return duration_s_; }
  /// Speed at the end of the leg as flown: 0 for the trapezoid.
  double end_speed_m_s() const { return end_speed_m_s_; }

 private:
  Trajectory start_{};
  Vector3 target_W_{Vector3::Zero()};
  Vector3 direction_W_{Vector3::Zero()};
  double target_psi_rad_{};
  double psi_change_rad_{};
  double distance_m_{};
  double end_speed_m_s_{};
  double duration_s_{};
  // Three pieces of constant acceleration; (2) is the case where the first is all.
  double start_speed_m_s_{};
  double acceleration_m_s2_{};
  double ramp_s_{};    ///< End of the first piece.
  double cruise_s_{};  ///< End of the second.
};

}  // namespace rosflight::autonomy::multirotor
