// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/sampling.hpp"
#include "sim/sensors/vector_errors.hpp"

namespace rosflight::sim::sensors {

/// Gyroscope and accelerometer on one chip at r from the centre of mass:
///
///     gyro  = E_g( w )
///     accel = E_a( f + dw/dt x r + w x (w x r) )                                         (1)
///
/// with the specific force f and the error model E of sim/noise.hpp. The extra terms of (1) are the
/// acceleration of a point of a rotating rigid body (any mechanics text, e.g. Titterton & Weston,
/// Strapdown Inertial Navigation Technology, 2nd ed., sec. 2). Rotors shake the airframe: white
/// noise of sigma = vibration * rms rotor speed adds in power. Earth's rotation (7e-5 rad/s) is
/// left out, below the bias of any part used here.
/// Samples that come fast enough show what that noise is made of: each rotor of N that turns by phi_i at
/// the speed s_i adds, with B blades,
///
///     sigma_i sqrt(2/N) (cos phi_i, sin phi_i, cos B phi_i),   sigma_i = vibration * s_i   (2)
///
/// on body axes: an unbalanced rotor pulls its hub around, and each blade that passes an arm pushes it.
/// On each axis that is the power of the noise.
/// A sample that would equal the one before bit by bit (no noise, at rest) has the last bit of the
/// accelerometer's z changed: no real sensor repeats a sample exactly, and the firmware rejects one
/// that does as stuck.
/// Errors and saturation act in the axes of the chip, which is turned by rotation_deg.
class Imu {
 public:
  using Sample = hal::ImuSample;

  struct Config {
    Timing timing;
    VectorErrorParameters gyro_rad_s;
    VectorErrorParameters accel_m_s2;
    Vector3 position_m{Vector3::Zero()};  ///< r, in body axes.
    Vector3 rotation_deg{
        Vector3::Zero()};              ///< Mounting: the IMU_ROLL, IMU_PITCH, IMU_YAW that undo it.
    double gyro_vibration{};           ///< Noise per rotor speed [rad/s per rad/s].
    double accel_vibration_m_s_rad{};  ///< [m/s^2 per rad/s].
    bool shows_lines{false};           ///< Vibration is (2) in place of white noise.
    double gyro_lines{9e-5};           ///< Vibration of the gyro in (2): 2 deg/s at 388 rad/s.
    int blades{2};                     ///< B.
    Vector3 gyro_temperature_rad_s_K{Vector3::Zero()};  ///< Bias per kelvin from 298.15 K.
    Vector3 accel_temperature_m_s2_K{Vector3::Zero()};
    Temperature temperature;
    double warm_up_s{};  ///< Time constant of temperature.rise_K; 0: warm from the start.

    // Properties of the simulator of ROSflight 2.x; off in realistic presets.
    bool quiet_without_rotors{false};  ///< No white noise until a rotor turns ("armed").
    double standstill_speed_m_s{};     ///< Below it the accelerometer shows gravity alone.
    Vector3 gyro_transient_rad_s{Vector3::Zero()};  ///< Bias at start that decays ...
    double gyro_transient_time_s{};                 ///< ... with b <- (1 - T/(T + tau)) b; 0: none.
  };

  /// @param gravity_m_s2  used for standstill_speed_m_s only.
  Imu(const Config& config, double gravity_m_s2, const RandomSource& source);
  /// (1) with its errors.
  bool measure(const Truth& truth, Sample& sample);

  /// Errors of the last sample that are not noise, in chip axes.
  Vector3 gyro_bias() const { return gyro_.bias() + transient_ + gyro_temperature_bias_; }
  Vector3 accel_bias() const { return accel_.bias() + accel_temperature_bias_; }

 private:
  Vector3 specific_force(const Truth& truth) const;
  void warm_up(const Truth& truth);
  void add_lines(const Truth& truth, Vector3& gyro, Vector3& accel);

  Config config_;
  double gravity_m_s2_;
  Eigen::Matrix3d R_SB_;
  bool rotated_;
  bool levered_;
  VectorErrorModel gyro_;
  VectorErrorModel accel_;
  Vector3 transient_;
  double transient_keep_;
  double rise_K_;
  double rise_keep_;
  bool temperature_matters_;
  std::array<double, kMaxRotors> rotor_angle_rad_{};
  Time turned_until_{};
  hal::Vec3 last_accel_{}, last_gyro_{};
  double temperature_K_{};
  Vector3 gyro_temperature_bias_{Vector3::Zero()};
  Vector3 accel_temperature_bias_{Vector3::Zero()};
};

/// Rotation that turns body axes into those of a chip mounted with these firmware angles:
/// v_S = R(roll, pitch, yaw) v_B; the firmware applies the transpose (ROSflight 2.x, IMU_ROLL...).
Eigen::Matrix3d mounting_rotation(const Vector3& rotation_deg);

}  // namespace rosflight::sim::sensors
