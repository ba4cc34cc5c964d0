// SPDX-License-Identifier: BSD-3-Clause
#include "messages/simulation.hpp"

#include <algorithm>
#include <cmath>

#include "messages/fill.hpp"

namespace rosflight::messages {
namespace {

constexpr double kMinPulse_us = 1000.0;
constexpr double kPulseSpan_us = 1000.0;

template <class Message>  // Vector3 or Point
sim::Vector3 vector(const Message& in) {
  return {in.x, in.y, in.z};
}

hal::Vec3 floats(const geometry_msgs::Vector3& in) {
  return {static_cast<float>(in.x), static_cast<float>(in.y), static_cast<float>(in.z)};
}

sim::Vector3 gravity_B(const sim::BodyState& body, double gravity_m_s2) {
  return body.q_WB.conjugate() * sim::Vector3(0.0, 0.0, gravity_m_s2);
}

}  // namespace

// ---- truth

rosflight_msgs::SimState to_message(const sim::Truth& truth, double gravity_m_s2) {
  const sim::BodyState& body = truth.body;
  rosflight_msgs::SimState out;
  fill(body.p_W, out.pose.position);
  out.pose.orientation = {body.q_WB.x(), body.q_WB.y(), body.q_WB.z(), body.q_WB.w()};
  fill(body.v_B, out.twist.linear);
  fill(body.w_B, out.twist.angular);
  fill(sim::Vector3(truth.specific_force_B + gravity_B(body, gravity_m_s2)),
       out.acceleration.linear);
  fill(truth.angular_acceleration_B, out.acceleration.angular);
  return out;
}

sim::BodyState body_state(const rosflight_msgs::SimState& in) {
  const geometry_msgs::Quaternion& q = in.pose.orientation;
  return {vector(in.pose.position),
          {q.w, q.x, q.y, q.z},
          vector(in.twist.linear),
          vector(in.twist.angular)};
}

bool from_message(const rosflight_msgs::SimState& in, double gravity_m_s2, sim::Truth& truth) {
  sim::BodyState body = body_state(in);
  const sim::Vector3 acceleration = vector(in.acceleration.linear);
  const sim::Vector3 angular = vector(in.acceleration.angular);
  constexpr double kUnitTolerance = 1e-2;
  const double norm = body.q_WB.norm();
  if (!body.p_W.allFinite() || !body.v_B.allFinite() || !body.w_B.allFinite() ||
      !acceleration.allFinite() || !angular.allFinite() || !(std::abs(norm - 1.0) < kUnitTolerance))
    return false;
  body.q_WB.coeffs() /= norm;
  truth.body = body;
  truth.specific_force_B = acceleration - gravity_B(body, gravity_m_s2);
  truth.angular_acceleration_B = angular;
  return true;
}

geometry_msgs::Vector3Stamped wind_message(const sim::Vector3& wind_W) {
  geometry_msgs::Vector3Stamped out;
  fill(wind_W, out.vector);
  return out;
}

bool from_message(const geometry_msgs::Vector3Stamped& in, sim::Vector3& wind_W) {
  const sim::Vector3 read = vector(in.vector);
  if (!read.allFinite()) return false;
  wind_W = read;
  return true;
}

geometry_msgs::WrenchStamped to_message(const sim::Wrench& wrench) {
  geometry_msgs::WrenchStamped out;
  fill(wrench.force_B, out.wrench.force);
  fill(wrench.torque_B, out.wrench.torque);
  return out;
}

bool from_message(const geometry_msgs::WrenchStamped& in, sim::Wrench& wrench) {
  const sim::Wrench read{vector(in.wrench.force), vector(in.wrench.torque)};
  if (!read.force_B.allFinite() || !read.torque_B.allFinite()) return false;
  wrench = read;
  return true;
}

void fill_vehicle(const sim::Truth& truth, const hal::OutputValues& outputs,
                  rosflight_log_msgs::TruthVehicle& out) {
  const auto& speeds = truth.rotor_speed_rad_s;
  out.outputs = outputs;
  out.rotor_speed.assign(speeds.data(), speeds.data() + std::min(truth.rotor_count, speeds.size()));
  out.battery_voltage = truth.battery_voltage_V;
  out.battery_current = truth.battery_current_A;
  out.on_ground = truth.on_ground;
  fill(truth.air.wind_W, out.wind);
  out.air_density = truth.air.density_kg_m3;
  out.air_pressure = truth.air.pressure_Pa;
  out.air_temperature = truth.air.temperature_K;
}

// ---- outputs and receiver

std::uint16_t pulse_us(float value) {
  // The comparison order turns NaN into 0; the small term keeps fraction() of a pulse that pulse.
  const double x = value > 0.0F ? std::min(static_cast<double>(value), 1.0) : 0.0;
  return static_cast<std::uint16_t>(kMinPulse_us + std::floor(kPulseSpan_us * x + 1e-4));
}

float fraction(std::uint16_t pulse_us) {
  return static_cast<float>((static_cast<double>(pulse_us) - kMinPulse_us) / kPulseSpan_us);
}

rosflight_msgs::PwmOutput to_message(const hal::OutputValues& outputs) {
  rosflight_msgs::PwmOutput out;
  std::transform(outputs.begin(), outputs.end(), out.values.begin(), pulse_us);
  return out;
}

void from_message(const rosflight_msgs::PwmOutput& in, hal::OutputValues& outputs) {
  std::transform(in.values.begin(), in.values.end(), outputs.begin(),
                 [](std::uint16_t pulse) { return std::clamp(fraction(pulse), 0.0F, 1.0F); });
}

void from_message(const rosflight_msgs::RCRaw& in, hal::RcFrame& frame) {
  std::transform(in.values.begin(), in.values.end(), frame.channels.begin(), fraction);
  frame.channel_count = static_cast<std::uint8_t>(in.values.size());
  frame.frame_lost = frame.failsafe = false;
}

// ---- sensors

sensor_msgs::Imu imu_message(const sim::Vector3& accel_m_s2, const sim::Vector3& gyro_rad_s) {
  sensor_msgs::Imu out;
  out.orientation_covariance[0] = -1.0;  // sensor_msgs/Imu: there is no orientation
  fill(accel_m_s2, out.linear_acceleration);
  fill(gyro_rad_s, out.angular_velocity);
  return out;
}

sensor_msgs::Imu to_message(const hal::ImuSample& in) {
  const auto doubles = [](const hal::Vec3& v) {
    return sim::Vector3(static_cast<double>(v[0]), static_cast<double>(v[1]),
                        static_cast<double>(v[2]));
  };
  return imu_message(doubles(in.accel_m_s2), doubles(in.gyro_rad_s));
}

sensor_msgs::Temperature imu_temperature(const hal::ImuSample& in) {
  sensor_msgs::Temperature out;
  out.temperature = static_cast<double>(in.temperature_K) - kZeroCelsius_K;
  return out;
}

float temperature_K(const sensor_msgs::Temperature& in) {
  return static_cast<float>(in.temperature + kZeroCelsius_K);
}

sensor_msgs::MagneticField to_message(const hal::MagSample& in) {
  sensor_msgs::MagneticField out;
  fill(in.field_T, out.magnetic_field);
  return out;
}

rosflight_msgs::Barometer to_message(const hal::BaroSample& in) {
  rosflight_msgs::Barometer out;
  out.pressure = in.pressure_Pa;
  out.temperature = in.temperature_K;
  return out;
}

rosflight_msgs::Airspeed to_message(const hal::DiffPressureSample& in) {
  rosflight_msgs::Airspeed out;
  out.differential_pressure = in.pressure_Pa;
  out.temperature = in.temperature_K;
  return out;
}

sensor_msgs::Range to_message(const hal::RangeSample& in) {
  return range_message(in.kind == hal::RangeKind::kLidar, in.min_m, in.max_m, in.range_m);
}

rosflight_msgs::BatteryStatus to_message(const hal::BatterySample& in) {
  return {{}, in.voltage_V, in.current_A};
}

rosflight_msgs::GNSS to_message(const hal::GnssSample& in) {
  rosflight_msgs::GNSS out;
  fill_gnss(in, out);
  out.fix_type = static_cast<std::uint8_t>(in.fix);
  return out;
}

void from_message(const sensor_msgs::Imu& in, hal::ImuSample& out) {
  out.accel_m_s2 = floats(in.linear_acceleration);
  out.gyro_rad_s = floats(in.angular_velocity);
}

void from_message(const sensor_msgs::MagneticField& in, hal::MagSample& out) {
  out.field_T = floats(in.magnetic_field);
}

void from_message(const rosflight_msgs::Barometer& in, hal::BaroSample& out) {
  out.pressure_Pa = in.pressure;
  out.temperature_K = in.temperature;
}

void from_message(const rosflight_msgs::Airspeed& in, hal::DiffPressureSample& out) {
  out.pressure_Pa = in.differential_pressure;
  out.temperature_K = in.temperature;
}

void from_message(const sensor_msgs::Range& in, hal::RangeSample& out) {
  const bool sonar = in.radiation_type == sensor_msgs::Range::ULTRASOUND;
  out.kind = sonar ? hal::RangeKind::kSonar : hal::RangeKind::kLidar;
  out.min_m = in.min_range;
  out.max_m = in.max_range;
  out.range_m = in.range;
}

void from_message(const rosflight_msgs::BatteryStatus& in, hal::BatterySample& out) {
  out.voltage_V = in.voltage;
  out.current_A = in.current;
}

void from_message(const rosflight_msgs::GNSS& in, hal::GnssSample& out) {
  constexpr auto kLast = static_cast<std::uint8_t>(hal::GnssFix::kTimeOnly);
  out.fix = in.fix_type <= kLast ? static_cast<hal::GnssFix>(in.fix_type) : hal::GnssFix::kNone;
  out.satellites = in.num_sat;
  out.latitude_deg = in.lat;
  out.longitude_deg = in.lon;
  out.height_msl_m = in.alt;
  out.horizontal_accuracy_m = in.horizontal_accuracy;
  out.vertical_accuracy_m = in.vertical_accuracy;
  out.velocity_ned_m_s = {in.vel_n, in.vel_e, in.vel_d};
  out.speed_accuracy_m_s = in.speed_accuracy;
  out.unix_s = in.gnss_unix_seconds;
  out.unix_ns = in.gnss_unix_nanos;
}

}  // namespace rosflight::messages
