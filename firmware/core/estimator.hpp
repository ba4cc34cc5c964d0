// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/math.hpp"

namespace rosflight::core {

using hal::Time;

/// What the estimator believes. Body front-right-down, N north-east-down with an arbitrary north.
struct AttitudeEstimate {
  Time stamp{};
  Quaternion q_NB{};
  Vector3 rates_rad_s{Vector3::Zero()};  ///< Low-passed gyro less bias.
  float roll_rad{0.0f};
  float pitch_rad{0.0f};
};

/// Attitude from gyro and accelerometer: quaternion complementary filter after Mahony, Hamel and
/// Pflimlin, "Nonlinear complementary filters on the special orthogonal group", IEEE TAC 53(5),
/// 2008, with the corrections of ROSflight 2.x.
///
///     a  <- (1 - alpha) a_imu + alpha a ,   w <- (1 - alpha) w_imu + alpha w (1) w_e = -2 q_w
///     (q_x, q_y, 0) of  q (x) q_a ,  q_a: shortest rotation (0,0,-1) -> a/|a|       (2) b  <- b -
///     k_i w_e dt                                                                      (3) w_f = w
///     - b + k_p w_e        (w by a quadratic fit of three samples if asked for)         (4) q  <-
///     q (x) exp(w_f dt / 2)  (or the Euler step q + q (x) (0, w_f) dt / 2)                 (5)
///
/// (2) is used while |a| is within `acc_margin` of 1 g. A pending external attitude replaces it:
///     w_e = sum_i s_i x r_i , rows of R(q_ext) and R(q) (6)
/// times (time since the previous one)/dt, because it stands for that whole interval; the interval
/// counts only up to 1/(2 k_p), which is what closes the gap without overshoot. During the first
/// `init_time` both gains are ten times FILT_ACC_KP and FILT_KI. Yaw is seen only by the gyro and
/// by external attitudes.
class Estimator {
 public:
  /// A gap in the IMU data longer than this makes roll and pitch start again from the
  /// accelerometer.
  static constexpr float kLongestGap_s = 0.1f;
  static constexpr Time kUnhealthyAfter = hal::milliseconds(500);
  static constexpr Time kHealthyAfter = hal::milliseconds(100);

  struct Config {
    Time init_time{hal::milliseconds(3000)};
    float acc_kp{0.5f};
    float ki{0.01f};
    float ext_kp{1.5f};
    float acc_margin{0.1f};
    float acc_lpf{0.5f}, gyro_xy_lpf{0.3f}, gyro_z_lpf{0.3f};
    bool quadratic_rates{true};
    bool exact_step{true};
    bool use_acc{true};
    bool fixed_wing{false};
  };

  void configure(const Config& config) { config_ = config; }

  /// Level, no bias, filters at rest. The very first step after construction only records its time.
  void reset();
  /// After a restart in the air: roll and pitch from the first accelerometer sample, the boost
  /// counts from that sample and leaves external attitudes alone.
  void reset_in_flight();
  /// A fresh gyro calibration makes the bias estimate meaningless.
  void clear_bias() { bias_.setZero(); }

  /// Normalises; @returns false (and ignores it) for NaN or a quaternion of length zero.
  bool set_external_attitude(const std::array<float, 4>& q_NB);

  /// One IMU sample, calibrated, dt after the previous one [s, >= 0].
  const AttitudeEstimate& step(const hal::ImuSample& imu, float dt_s);

  const AttitudeEstimate& estimate() const { return estimate_; }
  const Vector3& bias_rad_s() const { return bias_; }
  /// False after 0.5 s without a usable accelerometer (multirotors), true again after 0.1 s with
  /// one.
  bool healthy() const { return healthy_; }

 private:
  struct Correction {
    Vector3 error{Vector3::Zero()};
    float kp{0.0f};
    float ki{0.0f};
  };

  void filter(const hal::ImuSample& imu);
  bool accelerometer_usable(float norm_sq) const;
  Vector3 accelerometer_error() const;
  Correction correction(Time now, float dt_s);
  Vector3 rate_for_step();
  void propagate(const Vector3& rate, float dt_s);
  void level_from_accelerometer();
  void watch_health(Time now, bool used);

  Config config_{};
  AttitudeEstimate estimate_{};
  Vector3 bias_{Vector3::Zero()};
  Vector3 acc_{0.0f, 0.0f, -kGravity_m_s2};
  Vector3 rate_{Vector3::Zero()};
  Vector3 rate_1_{Vector3::Zero()};
  Vector3 rate_2_{Vector3::Zero()};
  Quaternion external_{};
  Time external_time_{};
  Time boost_start_{};
  Time last_acc_use_{};
  Time usable_since_{};
  bool external_pending_{false};
  bool started_{false};
  bool in_flight_{false};
  bool healthy_{true};
  bool was_usable_{false};
};

}  // namespace rosflight::core
