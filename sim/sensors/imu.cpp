// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/imu.hpp"

#include <cmath>

#include "base/constants.hpp"

namespace rosflight::sim::sensors {
namespace {
using base::kRadPerDeg;
constexpr double kReferenceTemperature_K = 298.15;
constexpr double kTurn_rad = 2.0 * base::kPi;

double rms_rotor_speed(const Truth& truth) {
  if (truth.rotor_count == 0) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.rotor_count; ++i) {
    sum += truth.rotor_speed_rad_s[i] * truth.rotor_speed_rad_s[i];
  }
  return std::sqrt(sum / static_cast<double>(truth.rotor_count));
}

/// Share of an exponential transient that is left after one period.
double kept(double period_s, double time_constant_s) {
  return time_constant_s > 0.0 ? portable::exp(-period_s / time_constant_s) : 0.0;
}
}  // namespace

Eigen::Matrix3d mounting_rotation(const Vector3& rotation_deg) {
  const auto turn = [](double angle_deg, int axis) {
    const auto [sine, cosine] = portable::sin_cos(angle_deg * kRadPerDeg);
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R(next, next) = R(last, last) = cosine;
    R(next, last) = -sine;
    R(last, next) = sine;
    return R;
  };
  return turn(rotation_deg.z(), 2) * turn(rotation_deg.y(), 1) * turn(rotation_deg.x(), 0);
}

Imu::Imu(const Config& config, double gravity_m_s2, const RandomSource& source)
    : config_{config},
      gravity_m_s2_{gravity_m_s2},
      R_SB_{mounting_rotation(config.rotation_deg)},
      rotated_{!config.rotation_deg.isZero(0.0)},
      levered_{!config.position_m.isZero(0.0)},
      gyro_{config.gyro_rad_s, config.timing.period, source, "sensors/imu/gyro"},
      accel_{config.accel_m_s2, config.timing.period, source, "sensors/imu/accel"},
      transient_{config.gyro_transient_time_s > 0.0 ? config.gyro_transient_rad_s
                                                    : Vector3::Zero()},
      transient_keep_{1.0},
      rise_K_{config.warm_up_s > 0.0 ? 0.0 : config.temperature.rise_K},
      rise_keep_{kept(to_seconds(config.timing.period), config.warm_up_s)},
      temperature_matters_{!config.gyro_temperature_rad_s_K.isZero(0.0) ||
                           !config.accel_temperature_m_s2_K.isZero(0.0)} {
  if (config.gyro_transient_time_s > 0.0) {
    const double period_s = to_seconds(config.timing.period);
    transient_keep_ = 1.0 - period_s / (period_s + config.gyro_transient_time_s);
  }
}

Vector3 Imu::specific_force(const Truth& truth) const {
  if (truth.body.v_B.norm() < config_.standstill_speed_m_s) {
    return truth.body.q_WB.conjugate() * Vector3(0.0, 0.0, -gravity_m_s2_);
  }
  if (!levered_) return truth.specific_force_B;
  const Vector3& w = truth.body.w_B;
  const Vector3& r = config_.position_m;
  return truth.specific_force_B + truth.angular_acceleration_B.cross(r) + w.cross(w.cross(r));
}

void Imu::warm_up(const Truth& truth) {
  rise_K_ = config_.temperature.rise_K + rise_keep_ * (rise_K_ - config_.temperature.rise_K);
  const double fixed = config_.temperature.fixed_K;
  temperature_K_ = fixed > 0.0 ? fixed : truth.air.temperature_K + rise_K_;
  if (!temperature_matters_) return;
  const double offset_K = temperature_K_ - kReferenceTemperature_K;
  gyro_temperature_bias_ = config_.gyro_temperature_rad_s_K * offset_K;
  accel_temperature_bias_ = config_.accel_temperature_m_s2_K * offset_K;
}

/// Equation (2).
void Imu::add_lines(const Truth& truth, Vector3& gyro, Vector3& accel) {
  const double dt_s = to_seconds(truth.time - turned_until_);
  turned_until_ = truth.time;
  for (std::size_t i = 0; i < truth.rotor_count; ++i) {
    const double speed_rad_s = truth.rotor_speed_rad_s[i];
    const double turned = rotor_angle_rad_[i] + speed_rad_s * dt_s;
    rotor_angle_rad_[i] = turned - kTurn_rad * std::floor(turned / kTurn_rad);
    const auto [sine, cosine] = portable::sin_cos(rotor_angle_rad_[i]);
    const double blade = portable::sin_cos(config_.blades * rotor_angle_rad_[i]).cos;
    const double size = speed_rad_s * std::sqrt(2.0 / static_cast<double>(truth.rotor_count));
    const Vector3 line(size * cosine, size * sine, size * blade);
    gyro += config_.gyro_lines * line;
    accel += config_.accel_vibration_m_s_rad * line;
  }
}

bool Imu::measure(const Truth& truth, Sample& sample) {
  warm_up(truth);
  Vector3 gyro = truth.body.w_B;
  Vector3 accel = specific_force(truth);
  if (config_.shows_lines) add_lines(truth, gyro, accel);
  if (rotated_) {
    gyro = R_SB_ * gyro;
    accel = R_SB_ * accel;
  }
  transient_ *= transient_keep_;
  gyro += transient_ + gyro_temperature_bias_;
  accel += accel_temperature_bias_;
  const double speed_rad_s = config_.shows_lines ? 0.0 : rms_rotor_speed(truth);
  if (config_.quiet_without_rotors && speed_rad_s == 0.0) {
    gyro = gyro_.apply_quietly(gyro);
    accel = accel_.apply_quietly(accel);
  } else {
    gyro = gyro_.apply(gyro, config_.gyro_vibration * speed_rad_s);
    accel = accel_.apply(accel, config_.accel_vibration_m_s_rad * speed_rad_s);
  }
  sample = {.stamp = truth.time,
            .accel_m_s2 = to_floats(accel),
            .gyro_rad_s = to_floats(gyro),
            .temperature_K = static_cast<float>(temperature_K_)};
  if (sample.accel_m_s2 == last_accel_ && sample.gyro_rad_s == last_gyro_) {
    float& z = sample.accel_m_s2[2];
    z = std::nextafter(z, z > 0.0F ? 0.0F : 1.0F);
  }
  last_accel_ = sample.accel_m_s2;
  last_gyro_ = sample.gyro_rad_s;
  return true;
}

}  // namespace rosflight::sim::sensors
