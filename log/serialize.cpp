// SPDX-License-Identifier: BSD-3-Clause
#include "log/serialize.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "log/utf8.hpp"

namespace rosflight::log {
namespace {

constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr double kZeroCelsius_K = 273.15;
constexpr std::array<double, 9> kUnknownCovariance{};

void put_stamp(CdrWriter& out, std::uint64_t stamp_ns) {
  out.put(static_cast<std::int32_t>(stamp_ns / kNanosecondsPerSecond));
  out.put(static_cast<std::uint32_t>(stamp_ns % kNanosecondsPerSecond));
}

void put_header(CdrWriter& out, const Header& header) {
  put_stamp(out, header.stamp_ns);
  out.put(header.frame_id);
}

void put_vector(CdrWriter& out, const std::array<float, 3>& v) {
  for (const float value : v) out.put(static_cast<double>(value));
}

void put_vector(CdrWriter& out, const sim::Vector3& v) {
  for (const double value : v) out.put(value);
}

/// ROS quaternions end with the scalar, ours begin with it.
void put_quaternion(CdrWriter& out, const std::array<float, 4>& q) {
  for (const std::size_t k : {1U, 2U, 3U, 0U}) out.put(static_cast<double>(q[k]));
}

template <std::size_t kLength>
std::string fixed_text(const std::array<char, kLength>& text) {
  return clean_utf8({text.data(), kLength});
}

double parameter_value(std::uint8_t type, link::ParamBits value) {
  if (type == static_cast<std::uint8_t>(link::ParamType::kInt32)) {
    return static_cast<double>(static_cast<std::int32_t>(value.bits));
  }
  if (type == static_cast<std::uint8_t>(link::ParamType::kFloat)) {
    return static_cast<double>(std::bit_cast<float>(value.bits));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::array<double, 3> euler_angles(const std::array<float, 4>& q_NB) {
  const double w = static_cast<double>(q_NB[0]);
  const double x = static_cast<double>(q_NB[1]);
  const double y = static_cast<double>(q_NB[2]);
  const double z = static_cast<double>(q_NB[3]);
  return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)),
          std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

void serialize(CdrWriter& out, const Header& header, const link::Attitude& message) {
  put_header(out, header);
  put_quaternion(out, message.q_NB);
  put_vector(out, message.rates_rad_s);
}

void serialize(CdrWriter& out, const Header& header, const link::ExternalAttitude& message) {
  put_header(out, header);
  put_quaternion(out, message.q_NB);
  put_vector(out, std::array<float, 3>{});
}

void serialize(CdrWriter& out, const Header& header, const link::Mag& message) {
  put_header(out, header);
  put_vector(out, message.field_T);
  out.put(kUnknownCovariance);
}

void serialize(CdrWriter& out, const Header& header, const link::Baro& message) {
  put_header(out, header);
  out.put(message.altitude_m);
  out.put(message.pressure_Pa);
  out.put(message.temperature_K);
}

void serialize(CdrWriter& out, const Header& header, const link::DiffPressure& message) {
  put_header(out, header);
  out.put(message.airspeed_m_s);
  out.put(message.pressure_Pa);
  out.put(message.temperature_K);
}

void serialize(CdrWriter& out, const Header& header, const link::Range& message) {
  // What ROSflight's companion node publishes: a 60 degree cone for sonar, 2 degrees for lidar.
  constexpr std::uint8_t kUltrasound = 0;
  constexpr std::uint8_t kInfrared = 1;
  constexpr float kSonarView_rad = 1.0472F;
  constexpr float kLidarView_rad = 0.0349066F;
  const bool sonar = message.kind == 0;
  put_header(out, header);
  out.put(sonar ? kUltrasound : kInfrared);
  out.put(sonar ? kSonarView_rad : kLidarView_rad);
  out.put(message.min_m);
  out.put(message.max_m);
  out.put(message.range_m);
  out.put(0.0F);  // Variance: unknown.
}

void serialize(CdrWriter& out, const Header& header, const link::RcChannels& message) {
  constexpr std::size_t kPublished = 8;
  put_header(out, header);
  for (std::size_t k = 0; k < kPublished; ++k) out.put(message.pulse_us[k]);
}

void serialize(CdrWriter& out, const Header& header, const link::OutputRaw& message) {
  put_header(out, header);
  out.put(message.values);
}

void serialize(CdrWriter& out, const Header& header, const link::Status& message) {
  put_header(out, header);
  out.put(message.armed);
  out.put(message.failsafe);
  out.put(message.rc_override);
  out.put(message.offboard);
  out.put(message.control_mode);
  out.put(message.error_code);
  out.put(message.sensor_errors);
  out.put(message.loop_time_us);
}

void serialize(CdrWriter& out, const Header& header, const link::HardError& message) {
  put_header(out, header);
  out.put(std::string_view("The flight controller crashed and restarted"));
  out.put(message.error_code);
  out.put(message.reset_count);
  out.put(message.rearm != 0);
  out.put(message.pc);
}

void serialize(CdrWriter& out, const Header& header, const link::Gnss& message) {
  put_header(out, header);
  out.put(message.fix);
  out.put(message.satellites);
  out.put(message.latitude_deg);
  out.put(message.longitude_deg);
  out.put(message.height_msl_m);
  out.put(message.horizontal_accuracy_m);
  out.put(message.vertical_accuracy_m);
  out.put(message.velocity_ned_m_s);
  out.put(message.speed_accuracy_m_s);
  out.put(message.unix_s);
  out.put(message.unix_ns);
}

void serialize(CdrWriter& out, const Header& header, const link::BatteryStatus& message) {
  put_header(out, header);
  out.put(message.voltage_V);
  out.put(message.current_A);
}

void serialize(CdrWriter& out, const Header& header, const link::OffboardControl& message) {
  put_header(out, header);
  out.put(message.mode);
  out.put(message.ignore);
  out.put(message.u);
}

void serialize(CdrWriter& out, const Header& header, const link::AuxCommand& message) {
  put_header(out, header);
  out.put(message.type);
  out.put(message.value);
}

void serialize(CdrWriter& out, const Header& /*header*/, const link::Version& message) {
  out.put(std::string_view(fixed_text(message.text)));
}

void serialize_imu(CdrWriter& out, const Header& header, const link::Imu& message,
                   const std::array<float, 4>* q_NB) {
  put_header(out, header);
  put_quaternion(out, q_NB != nullptr ? *q_NB : std::array<float, 4>{1.0F, 0.0F, 0.0F, 0.0F});
  std::array<double, 9> orientation_covariance{};
  if (q_NB == nullptr) orientation_covariance[0] = -1.0;  // sensor_msgs: "no such estimate".
  out.put(orientation_covariance);
  put_vector(out, message.gyro_rad_s);
  out.put(kUnknownCovariance);
  put_vector(out, message.accel_m_s2);
  out.put(kUnknownCovariance);
}

void serialize_temperature(CdrWriter& out, const Header& header, double temperature_K) {
  put_header(out, header);
  out.put(temperature_K - kZeroCelsius_K);
  out.put(0.0);  // Variance: unknown.
}

void serialize_vector(CdrWriter& out, const Header& header, const std::array<double, 3>& vector) {
  put_header(out, header);
  out.put(vector);
}

void serialize(CdrWriter& out, const Header& header, Direction direction,
               const link::Heartbeat& message) {
  put_header(out, header);
  out.put(static_cast<std::uint8_t>(direction));
  out.put(static_cast<std::uint8_t>(message.type));
}

void serialize(CdrWriter& out, const Header& header, Direction direction,
               const link::TimeSync& message) {
  put_header(out, header);
  out.put(static_cast<std::uint8_t>(direction));
  out.put(message.tc1_ns);
  out.put(message.ts1_ns);
}

void serialize(CdrWriter& out, const Header& header, Direction direction, Bytes raw_frame) {
  put_header(out, header);
  out.put(static_cast<std::uint8_t>(direction));
  out.put_sequence(raw_frame);
}

void serialize(CdrWriter& out, const Header& header, const link::ParamRequestRead& message) {
  put_header(out, header);
  out.put(message.target_system);
  out.put(message.index);
  out.put(std::string_view(fixed_text(message.name)));
}

void serialize(CdrWriter& out, const Header& header, const link::ParamRequestList& message) {
  put_header(out, header);
  out.put(message.target_system);
}

void serialize(CdrWriter& out, const Header& header, const link::ParamSet& message) {
  put_header(out, header);
  out.put(message.target_system);
  out.put(std::string_view(fixed_text(message.name)));
  out.put(message.type);
  out.put(parameter_value(message.type, message.value));
  out.put(message.value.bits);
}

void serialize(CdrWriter& out, const Header& header, const link::ParamValue& message) {
  const auto type = static_cast<std::uint8_t>(message.type);
  put_header(out, header);
  out.put(std::string_view(fixed_text(message.name)));
  out.put(type);
  out.put(parameter_value(type, message.value));
  out.put(message.value.bits);
  out.put(message.index);
  out.put(message.count);
}

void serialize(CdrWriter& out, const Header& header, const link::CommandRequest& message) {
  put_header(out, header);
  out.put(message.command);
}

void serialize(CdrWriter& out, const Header& header, const link::CommandAck& message) {
  put_header(out, header);
  out.put(message.command);
  out.put(message.success);
}

void serialize(CdrWriter& out, const Header& header, const link::MotorTest& message) {
  put_header(out, header);
  out.put(message.target_system);
  out.put(message.motor);
  out.put(message.value);
}

void serialize(CdrWriter& out, const Header& header, const link::ReportRequest& message) {
  put_header(out, header);
  out.put(message.target_system);
  out.put(message.kind);
}

void serialize(CdrWriter& out, const Header& header, const link::CheckResult& message) {
  put_header(out, header);
  out.put(message.index);
  out.put(message.count);
  out.put(message.result);
  out.put(std::string_view(fixed_text(message.name)));
  out.put(std::string_view(fixed_text(message.reason)));
}

void serialize(CdrWriter& out, const Header& header, const link::Counters& message) {
  put_header(out, header);
  out.put(message.longest_pass_us);
  out.put(message.pass_budget_us);
  out.put(message.passes_over_budget);
  out.put(message.passes);
  out.put(message.frames_dropped);
  out.put(message.tx_dropped);
  out.put(message.texts_lost);
  out.put(message.imu_jitter);
  out.put(message.rejected);
}

void serialize_parameter(CdrWriter& out, const Header& header, std::string_view name,
                         link::ParamType type, link::ParamBits value) {
  put_header(out, header);
  out.put(std::string_view(clean_utf8(name)));
  out.put(static_cast<std::uint8_t>(type));
  out.put(parameter_value(static_cast<std::uint8_t>(type), value));
}

void serialize_phase(CdrWriter& out, const Header& header, std::string_view name) {
  put_header(out, header);
  out.put(std::string_view(clean_utf8(name)));
}

void serialize_state(CdrWriter& out, const Header& header, const sim::Truth& truth,
                     double gravity_m_s2) {
  const sim::BodyState& body = truth.body;
  const sim::Vector3 gravity_B = body.q_NB.conjugate() * sim::Vector3(0.0, 0.0, gravity_m_s2);
  put_header(out, header);
  put_vector(out, body.p_N);
  for (const double value : {body.q_NB.x(), body.q_NB.y(), body.q_NB.z(), body.q_NB.w()})
    out.put(value);
  put_vector(out, body.v_B);
  put_vector(out, body.w_B);
  put_vector(out, sim::Vector3(truth.specific_force_B + gravity_B));
  put_vector(out, truth.angular_acceleration_B);
}

void serialize_wrench(CdrWriter& out, const Header& header, const sim::Wrench& wrench) {
  put_header(out, header);
  put_vector(out, wrench.force_B);
  put_vector(out, wrench.torque_B);
}

void serialize_pwm(CdrWriter& out, const Header& header, const hal::OutputValues& outputs) {
  constexpr float kShortest_us = 1000.0F;
  constexpr float kSpan_us = 1000.0F;
  std::array<std::uint16_t, hal::kOutputs> pulses_us{};
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    // The comparison order turns NaN into 0.
    const float value = outputs[k] > 0.0F ? std::min(outputs[k], 1.0F) : 0.0F;
    pulses_us[k] = static_cast<std::uint16_t>(std::lround(kShortest_us + kSpan_us * value));
  }
  put_header(out, header);
  out.put(pulses_us);
}

void serialize_vehicle(CdrWriter& out, const Header& header, const sim::Truth& truth,
                       const hal::OutputValues& outputs) {
  put_header(out, header);
  out.put(outputs);
  out.put_sequence(std::span<const double>(truth.rotor_speed_rad_s)
                       .first(std::min(truth.rotor_count, truth.rotor_speed_rad_s.size())));
  out.put(truth.battery_voltage_V);
  out.put(truth.battery_current_A);
  out.put(truth.on_ground);
  put_vector(out, truth.specific_force_B);
  out.put(truth.air.density_kg_m3);
  out.put(truth.air.pressure_Pa);
  out.put(truth.air.temperature_K);
}

void serialize(CdrWriter& out, const Header& header, const Setpoint& setpoint) {
  put_header(out, header);
  out.put(setpoint.p_N_m);
  out.put(setpoint.v_N_m_s);
  out.put(setpoint.a_N_m_s2);
  out.put(setpoint.yaw_rad);
  out.put(setpoint.yaw_rate_rad_s);
  out.put(setpoint.yaw_acceleration_rad_s2);
}

void serialize(CdrWriter& out, const Header& header, const Estimate& estimate) {
  put_header(out, header);
  out.put(estimate.p_N_m);
  out.put(estimate.v_N_m_s);
  out.put(estimate.q_NB);
  out.put(estimate.gyro_bias_rad_s);
  out.put(estimate.accel_bias_m_s2);
  out.put(estimate.wind_N_m_s);
  out.put(estimate.airspeed_m_s);
  out.put(estimate.course_rad);
  out.put(estimate.p_sigma_m);
  out.put(estimate.v_sigma_m_s);
  out.put(estimate.attitude_sigma_rad);
  out.put(estimate.wind_sigma_m_s);
  out.put(estimate.innovation);
  for (const bool refusing : estimate.refusing) out.put(refusing);
}

void serialize_text(CdrWriter& out, std::uint64_t stamp_ns, link::Severity severity,
                    std::string_view source, std::string_view text) {
  constexpr std::uint8_t kInfo = 20;
  constexpr std::uint8_t kWarn = 30;
  constexpr std::uint8_t kError = 40;
  constexpr std::uint8_t kFatal = 50;
  std::uint8_t level = kInfo;
  if (severity == link::Severity::kWarning) level = kWarn;
  if (severity == link::Severity::kError) level = kError;
  if (severity == link::Severity::kCritical) level = kFatal;
  put_stamp(out, stamp_ns);
  out.put(level);
  out.put(std::string_view(clean_utf8(source)));
  out.put(std::string_view(clean_utf8(text)));
  out.put(std::string_view{});  // File, function and line of the sender: unknown.
  out.put(std::string_view{});
  out.put(std::uint32_t{0});
}

}  // namespace rosflight::log
