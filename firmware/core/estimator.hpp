// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/math.hpp"

namespace rosflight::core {

using hal::Time;

/// The attitude estimate. Body B is front-right-down; W is north-east-down with an arbitrary north,
/// since nothing on board measures the heading.
struct AttitudeEstimate {
  Time stamp{};
  Quaternion q_WB{};
  Vector3 rates_rad_s{Vector3::Zero()};  ///< Low-passed gyro less bias.
  float roll_rad{0.0f};
  float pitch_rad{0.0f};
};

/// What an estimate continues from after a restart in flight.
struct Motion {
  static constexpr Time kUnknown = -hal::milliseconds(3'600'000);
  Time stamp{kUnknown};
  Quaternion q_WB{};
  Vector3 rates_rad_s{Vector3::Zero()};
  Vector3 bias_rad_s{Vector3::Zero()};

  /// A unit quaternion, rates that a gyro can measure, a bias that one may have.
  bool plausible() const;
};

/// Attitude from gyro and accelerometer: quaternion complementary filter after Mahony, Hamel and
/// Pflimlin, "Nonlinear complementary filters on the special orthogonal group", IEEE TAC 53(5),
/// 2008, with the low-passes, the integration and the start-up boost of ROSflight 2.x.
///
///     a   <- (1 - alpha) a_imu + alpha a,   w <- (1 - alpha) w_imu + alpha w              (1)
///     w_e  = S (a/|a| x p),   p = R(q)^T (0, 0, -1),   S = diag(1, 1, p_x^2 + p_y^2)      (2)
///     b   <- b - k_i (w_e,x  w_e,y  0) dt                                                 (3)
///     w_f  = w - b + k_p w_e                                                              (4)
///     q   <- q (x) exp(w_f dt / 2)   or the Euler step   q + q (x) (0, w_f) dt / 2        (5)
///
/// In (4), w is a quadratic fit of three samples if asked for. (2) turns the predicted direction of
/// the specific force at rest, p, onto the measured one. It contains no heading. S leaves out the
/// turn about body z while that is a turn of the heading (level), as ROSflight 2.x does, and keeps
/// it where it is one of roll and pitch (on the side). The product is as long as the sine of the
/// error up to 90 degrees and 1 beyond, also for an estimate that is upside down, whose axis is
/// arbitrary. (2) is used while |a| is within `acc_margin` of 1 g.
///
/// A pending external attitude replaces (2). With q_d = q^-1 (x) q_ext = (c, s), c >= 0:
///
///     w_e  = 4 c s                  up to 90 degrees, else   2 s / |s|                    (6)
///
/// times (time since the previous one)/dt, because it stands for that whole interval; the interval
/// counts only up to 1/(2 k_p), which is what closes the gap without overshoot. An external
/// attitude more than 20 degrees from the estimate is rejected until ten in a row agree within 5
/// degrees, each carried on by the estimated motion; those that follow are used as long as they
/// agree with the one before. The heading at power-up is arbitrary: ten is also what it takes a
/// companion to set it.
///
/// During the first `init_time` from the first sample on both gains are ten times FILT_ACC_KP and
/// FILT_KI; external attitudes keep their own. A first sample that shows more than 5 degrees of tilt
/// sets roll and pitch; below that the estimate starts level, as in ROSflight 2.x. A gap in the
/// samples is bridged with the mean of the rates before and after it and does not touch gains or
/// biases; only a gap above 1 s makes roll and pitch start again from the accelerometer, with the
/// boost. Times are sums of dt, so a restart of the IMU's clock has no effect.
class Estimator {
 public:
  /// Longer steps are gaps: no low-pass, no correction [s].
  static constexpr float kGap_s = 0.025f;
  /// After a longer gap roll and pitch start again from the accelerometer [s].
  static constexpr float kMaxGap_s = 1.0f;
  static constexpr Time kUnhealthyAfter = hal::milliseconds(500);
  /// The gyro alone carries roll and pitch for so long: with the 0.1 degrees/s that a calibrated one is off, to 3 degrees.
  static constexpr Time kCarriedByGyro = hal::milliseconds(30'000);
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

  /// Applies new settings; the state is kept.
  void configure(const Config& config) { config_ = config; }

  /// Level, no bias, filters at rest. The very first step after construction only records its time.
  void reset();
  /// After a restart in the air. The time from `before` to the first sample is a gap like any other; an
  /// accelerometer in flight measures thrust and drag, not the tilt. Without a plausible `before` of
  /// at most kMaxGap_s ago roll and pitch come from that sample nevertheless, and the boost counts
  /// from it.
  void resume_in_flight(const Motion& before);
  /// State for resume_in_flight() of the next start.
  Motion motion() const { return {estimate_.stamp, estimate_.q_WB, estimate_.rates_rad_s, bias_}; }
  /// At the end of a gyro calibration, hence at rest: resets the bias estimate, which belonged to the
  /// old offset. While the offset was measured nothing was subtracted from it, and it turned the
  /// attitude: roll and pitch more than 3 degrees from the accelerometer's are set to those. Yaw is
  /// kept.
  void settle();

  /// Normalises and stores an attitude for the next step. @returns false and ignores it if it holds a
  /// NaN, has no length, or is rejected because it is far from the estimate.
  bool set_external_attitude(const std::array<float, 4>& q_WB);

  /// One IMU sample, calibrated, dt after the previous one [s, >= 0].
  const AttitudeEstimate& step(const hal::ImuSample& imu, float dt_s);

  const AttitudeEstimate& estimate() const { return estimate_; }
  const Vector3& bias_rad_s() const { return bias_; }
  /// Rejected external attitudes since power-up.
  std::uint32_t external_rejected() const { return external_rejected_; }
  /// False after 0.5 s in which nothing corrected the attitude: no usable accelerometer and no external attitude
  /// (multirotors). True again after 0.1 s with the one, or with the other. For a vehicle on the ground, where gravity is all
  /// that an accelerometer can measure.
  bool healthy() const { return healthy_; }
  /// For a vehicle in flight, whose accelerations make the accelerometer useless for seconds: a climb, a brake, any steady
  /// tilt above 25 degrees. False only when in addition the gyro has been left alone for kCarriedByGyro.
  bool healthy_in_flight() const { return healthy_ || now_ - last_use_ <= kCarriedByGyro; }

 private:
  static constexpr int kExternalRun = 10;

  struct Correction {
    Vector3 error{Vector3::Zero()};
    float yaw_bias_error{0.0f};
    float kp{0.0f};
    float ki{0.0f};
  };

  bool external_plausible(const Quaternion& q);
  void filter(const hal::ImuSample& imu);
  bool accelerometer_usable(float norm_sq) const;
  Vector3 accelerometer_error() const;
  Correction correction(float dt_s);
  Correction external_correction(float dt_s);
  Vector3 rate_for_step();
  void propagate(const Vector3& rate, float dt_s, bool exact);
  void level_from_accelerometer();
  void cross_gap(const hal::ImuSample& imu, float dt_s);
  void start(const hal::ImuSample& imu);
  void publish();
  void watch_health(bool used);

  Config config_{};
  AttitudeEstimate estimate_{};
  Vector3 bias_{Vector3::Zero()};
  Vector3 acc_{0.0f, 0.0f, -kGravity_m_s2};
  Vector3 rate_{Vector3::Zero()};
  Vector3 rate_1_{Vector3::Zero()};
  Vector3 rate_2_{Vector3::Zero()};
  Quaternion external_{};
  Quaternion external_reference_{};  ///< What the next external attitude has to agree with,
  Quaternion external_base_{};       ///< and the estimate at that time.
  std::uint32_t external_rejected_{0};
  int external_run_{0};  ///< That agreed, 1..kExternalRun; 0: none is far from the estimate.
  Time now_{};           ///< Stamp of the first sample plus all dt since.
  Time external_time_{};
  Time boost_start_{};
  Time last_use_{};  ///< Last use of the accelerometer or an external attitude.
  Time usable_since_{};
  bool external_pending_{false};
  bool started_{false};
  bool in_flight_{false};
  bool healthy_{true};
  bool was_usable_{false};
};

}  // namespace rosflight::core
