// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/types.hpp"

/// A small world for closed-loop tests: the linear aerodynamics of the Anaconda of ROSflight 2.x's
/// simulator (its default fixed wing), servos as a lag, steady wind, flat ground without bounce.
/// Independent of the project's simulation.
namespace rosflight::autonomy::fixedwing::test {

struct PlantConfig {
  double mass_kg{4.5};
  double gravity_m_s2{9.80665};
  double density_kg_m3{1.07};
  double servo_lag_s{0.03};
  double throw_rad{40.0 * kRadPerDeg};  ///< Deflection of a surface at 1.
  Vector3 wind_W{Vector3::Zero()};
  double motor{1.0};  ///< Share of the thrust that is left.
};

class Plant {
 public:
  explicit Plant(const PlantConfig& config = {}) : config_(config) {}

  /// In the air, level, at an airspeed along a heading.
  void fly_from(const Vector3& p_W, double heading_rad, double airspeed_m_s) {
    q_ = Quaternion(std::cos(0.5 * heading_rad), 0.0, 0.0, std::sin(0.5 * heading_rad));
    p_ = p_W;
    v_ = q_ * Vector3(airspeed_m_s, 0.0, 0.0) + config_.wind_W;
    w_.setZero();
    fill();
  }

  void step(const Surfaces& command, double dt_s) {
    const double lag = std::min(dt_s / config_.servo_lag_s, 1.0);
    aileron_ += (command.aileron - aileron_) * lag;
    elevator_ += (command.elevator - elevator_) * lag;
    rudder_ += (command.rudder - rudder_) * lag;
    throttle_ += (command.throttle - throttle_) * lag;
    const Vector3 air = q_.conjugate() * (v_ - config_.wind_W);
    const double va = std::max(air.norm(), 0.1);
    const double alpha = std::atan2(air.z(), air.x());
    const double beta = std::asin(std::clamp(air.y() / va, -1.0, 1.0));
    const double qs = 0.5 * config_.density_kg_m3 * va * va * kS;
    // By effect: positive elevator pitches up, so it is the negative of the model's.
    const double de = -elevator_ * config_.throw_rad;
    const double da = aileron_ * config_.throw_rad;
    const double dr = -rudder_ * config_.throw_rad;
    const double ph = kB * w_.x() / (2.0 * va);
    const double qh = kC * w_.y() / (2.0 * va);
    const double rh = kB * w_.z() / (2.0 * va);
    const double lift = 0.506 + 5.61 * alpha + 7.95 * qh + 0.13 * de;
    const double flat = 0.506 + 5.61 * alpha;
    const double drag = 0.043 + flat * flat / (kPi * 0.9 * kB * kB / kS) + 0.0135 * std::abs(de);
    const Vector3 force(qs * (-drag * std::cos(alpha) + lift * std::sin(alpha)) + thrust(va),
                        qs * (-0.98 * beta + 0.075 * da + 0.19 * dr),
                        qs * (-drag * std::sin(alpha) - lift * std::cos(alpha)));
    const Vector3 torque(
        qs * kB * (-0.13 * beta - 0.51 * ph + 0.25 * rh + 0.17 * da + 0.0024 * dr),
        qs * kC * (0.135 - 2.74 * alpha - 38.21 * qh - 0.99 * de),
        qs * kB * (0.1301 * beta - 0.0364 * ph - 0.1541 * rh - 0.011 * da - 0.069 * dr));
    specific_ = force / config_.mass_kg;
    Eigen::Matrix3d inertia;
    inertia << 0.24855, 0.0, -0.06, 0.0, 0.3784, 0.0, -0.06, 0.0, 0.618;
    w_ += inertia.inverse() * (torque - w_.cross(inertia * w_)) * dt_s;
    v_ += (q_ * specific_ + Vector3(0.0, 0.0, config_.gravity_m_s2)) * dt_s;
    p_ += v_ * dt_s;
    const Vector3 turn = w_ * dt_s;
    q_ = (q_ * Quaternion(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z())).normalized();
    t_s_ += dt_s;
    on_ground_ = p_.z() >= 0.0;
    if (on_ground_) roll(dt_s);
    fill();
  }

  /// Standing on the ground at the origin.
  void stand(double heading_rad) {
    fly_from({0.0, 0.0, 0.0}, heading_rad, 0.0);
    v_.setZero();
    throttle_ = 0.0;
    on_ground_ = true;
    fill();
  }
  bool on_ground() const { return on_ground_; }
  /// Sink of the last touch-down, and its place.
  double touchdown_m_s() const { return touchdown_m_s_; }
  const Vector3& touchdown_W() const { return touchdown_W_; }

  const StateEstimate& state() const { return state_; }
  StateEstimate& state() { return state_; }
  PlantConfig& config() { return config_; }
  double time_s() const { return t_s_; }

 private:
  static constexpr double kS = 0.52;
  static constexpr double kB = 2.08;
  static constexpr double kC = 0.235;

  /// Simplified from the propeller data: 44 N at rest and full throttle, none at 30 m/s, windmill
  /// drag at zero throttle.
  double thrust(double va) const {
    const double n = throttle_;
    return config_.motor * (44.0 * n * n - 0.65 * n * va) - 0.01 * va * va * (1.0 - n);
  }

  /// Wheels: level, along the nose, with rolling friction; the nose may come up.
  void roll(double dt_s) {
    if (v_.z() > 0.05) {
      touchdown_m_s_ = v_.z();
      touchdown_W_ = p_;
    }
    p_.z() = 0.0;
    v_.z() = std::min(v_.z(), 0.0);
    const double pitch = std::max(RollPitch::of(q_).pitch_rad, 0.0);
    const double heading = std::atan2(2.0 * (q_.x() * q_.y() + q_.w() * q_.z()),
                                      1.0 - 2.0 * (q_.y() * q_.y() + q_.z() * q_.z()));
    q_ = Quaternion(std::cos(0.5 * heading), 0.0, 0.0, std::sin(0.5 * heading)) *
         Quaternion(std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0);
    w_.x() = 0.0;
    w_.z() *= std::max(0.0, 1.0 - 2.0 * dt_s);
    if (pitch == 0.0) w_.y() = std::max(w_.y(), 0.0);
    const Vector2 nose = along(heading);
    double speed = v_.head<2>().dot(nose);
    const double braked = 0.05 * config_.gravity_m_s2 * dt_s;
    speed = std::abs(speed) <= braked ? 0.0 : speed - std::copysign(braked, speed);
    v_.head<2>() = speed * nose;
  }

  void fill() {
    StateEstimate& s = state_;
    s.t_s = t_s_;
    s.p_W = p_;
    s.v_W = v_;
    s.q_WB = q_;
    s.w_B = w_;
    s.a_B = specific_;
    s.wind_W = config_.wind_W;
    const Vector3 air = q_.conjugate() * (v_ - config_.wind_W);
    s.airspeed_m_s = air.norm();
    s.alpha_rad = std::atan2(air.z(), air.x());
    s.beta_rad = std::asin(std::clamp(air.y() / std::max(s.airspeed_m_s, 0.1), -1.0, 1.0));
    s.course_rad = std::atan2(v_.y(), v_.x());
    s.attitude = s.heading = s.horizontal = s.vertical = Quality::kGood;
    s.wind_valid = s.air_valid = true;
  }

  PlantConfig config_;
  Vector3 p_{Vector3::Zero()};
  Vector3 v_{Vector3::Zero()};
  Vector3 w_{Vector3::Zero()};
  Vector3 specific_{Vector3::Zero()};
  Quaternion q_{Quaternion::Identity()};
  double aileron_{};
  double elevator_{};
  double rudder_{};
  double throttle_{0.5};
  double touchdown_m_s_{};
  Vector3 touchdown_W_{Vector3::Zero()};
  bool on_ground_{false};
  double t_s_{};
  StateEstimate state_{};
};

}  // namespace rosflight::autonomy::fixedwing::test
