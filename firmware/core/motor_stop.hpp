// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/core/math.hpp"

namespace rosflight::core {

using hal::Time;

/// Why the motors of an armed vehicle are stopped until it is disarmed.
enum class StopReason : std::uint8_t { kNone, kImuSilent, kTipOver, kImpact, kFailsafeAtRest };

/// Stops the motors of an armed vehicle for a reason that does not end by itself. The reason is
/// latched until disarming, so that no motor turns when a person picks the vehicle up.
///
///     reason            condition                                               enabled by
///     IMU silent        no usable sample for 1 s (multirotors)                  always
///     tip-over          tilt above 100 deg for 0.5 s with throttle commanded    CRASH_STOP 1
///     impact            |a| above 8 g, then 1 s without motion                  CRASH_STOP 2
///     failsafe at rest  30 s of failsafe without motion, on the ground          always
///
/// "Without motion" is a rate below 0.15 rad/s and a specific force within 0.1 g of 1 g. A vehicle
/// that sinks steadily satisfies it too, so the last reason includes a probe: the motors are held at
/// idle for 0.5 s. In the air the missing thrust appears in the accelerometer within a few motor
/// time constants, the probe ends and the 30 s start again. On the ground the specific force stays
/// 1 g, except for the first 0.25 s, in which 0.25 g and 0.5 rad/s are allowed while the weight
/// returns to the landing gear. With a barometer the pressure altitude must also stay within 1 m
/// during the 30 s. Fixed wings are excluded: their failsafe has no throttle.
class MotorStop {
 public:
  static constexpr Time kImuSilence = hal::milliseconds(1000);
  static constexpr Time kTipOverTime = hal::milliseconds(500);
  static constexpr float kTipOverCosine = -0.173648178f;  ///< cos(100 deg).
  static constexpr float kImpact_m_s2 = 8.0f * kGravity_m_s2;
  static constexpr Time kImpactStillness = hal::milliseconds(1000);
  static constexpr Time kImpactWindow = hal::milliseconds(5000);  ///< Stillness counts until then.
  static constexpr Time kFailsafeRest = hal::milliseconds(30000);
  static constexpr Time kProbe = hal::milliseconds(500);
  static constexpr Time kSettling = hal::milliseconds(250);  ///< Wider limits in the probe.
  static constexpr float kAltitudeBand_m = 1.0f;
  static constexpr float kAltitudeTime_s = 2.0f;  ///< Low-pass against the barometer's noise.
  static constexpr int kImpactSamples = 2;        ///< A single sample is an outlier of the sensor.
  static constexpr Time kImpactApart = hal::milliseconds(50);  ///< Longest time between the two.

  struct Config {
    bool fixed_wing{false};
    bool tip_over{false};
    bool impact{false};
  };

  /// Input of one IMU sample while armed.
  struct Input {
    Quaternion q_WB{};
    Vector3 accel_m_s2{Vector3::Zero()};
    Vector3 rates_rad_s{Vector3::Zero()};
    float altitude_m{};  ///< Altitude from the barometer; 0 without one.
    bool throttle_commanded{};
    bool failsafe{};
  };

  /// Applies new settings.
  void configure(const Config& config) { config_ = config; }
  /// A rule of step() is enabled; saves the call in ordinary flight.
  bool watching(bool failsafe) const {
    return failsafe || probing_ || config_.tip_over || config_.impact;
  }
  /// Evaluates the rules for one IMU sample; call while armed.
  void step(Time now, const Input& in);
  /// Evaluates the rule "IMU silent"; call once per pass while armed.
  /// @param last_imu  time of the last usable sample.
  void watch_imu(Time now, Time last_imu) {
    if (!config_.fixed_wing && now - last_imu > kImuSilence) stop(StopReason::kImuSilent);
  }
  /// Clears the reason; call on arming and disarming.
  void reset() { *this = MotorStop{config_}; }

  bool stopped() const { return reason_ != StopReason::kNone; }
  StopReason reason() const { return reason_; }
  /// The probe is running: hold the motors at idle.
  bool probing() const { return probing_; }

  MotorStop() = default;

 private:
  explicit MotorStop(const Config& config) : config_{config} {}
  void stop(StopReason reason) {
    if (reason_ == StopReason::kNone) reason_ = reason;
    probing_ = false;
  }
  bool without_motion(const Input& in, bool settling);
  void watch_tilt(Time now, const Input& in);
  void watch_impact(Time now, const Input& in, bool still);
  void smooth_altitude(Time now, const Input& in);
  void watch_rest(Time now, const Input& in, bool still);

  Config config_{};
  StopReason reason_{StopReason::kNone};
  bool tilted_{false};
  bool hit_{false};
  bool altitude_known_{false};
  std::uint8_t hard_samples_{0};  ///< Above kImpact_m_s2, each at most kImpactApart after the last.
  bool still_after_hit_{false};
  bool resting_{false};
  bool probing_{false};
  Time tilted_since_{};
  Time hit_at_{};
  Time hard_at_{};
  Time altitude_at_{};
  Time still_since_{};
  Time rest_since_{};
  Time probe_since_{};
  Vector3 smooth_accel_{0.0f, 0.0f, -kGravity_m_s2};
  float altitude_m_{};  ///< Low-passed.
  float lowest_m_{};
  float highest_m_{};
};

}  // namespace rosflight::core
