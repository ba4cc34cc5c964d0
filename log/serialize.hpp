// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string_view>

#include "link/messages.hpp"
#include "log/cdr.hpp"
#include "sim/types.hpp"

/// Our structs as ROS 2 messages: the second half of schemas.hpp, which has the layouts. Every
/// function appends one whole message, header first, to a CdrWriter that has just begun. Nothing is
/// converted between frames: vectors stay front-right-down or north-east-down, as ROSflight
/// publishes them. Where units differ from ours the message type decides (degrees Celsius in
/// sensor_msgs/Temperature).
namespace rosflight::log {

struct Header {
  std::uint64_t stamp_ns{};
  std::string_view frame_id;
};

enum class Direction : std::uint8_t { kFcuToCompanion = 0, kCompanionToFcu = 1 };

/// What guidance asks of the vehicle.
struct Setpoint {
  std::array<float, 3> p_N_m{};
  std::array<float, 3> v_N_m_s{};
  std::array<float, 3> a_N_m_s2{};
  float yaw_rad{};
  float yaw_rate_rad_s{};
  float yaw_acceleration_rad_s2{};
};

/// What guidance is told of the vehicle, with standard deviations; NaN: not known.
struct Estimate {
  static constexpr std::size_t kAids = 9;
  std::array<float, 3> p_N_m{};
  std::array<float, 3> v_N_m_s{};
  std::array<float, 4> q_NB{};  ///< w, x, y, z.
  std::array<float, 3> gyro_bias_rad_s{};
  std::array<float, 3> accel_bias_m_s2{};
  std::array<float, 2> wind_N_m_s{};
  float airspeed_m_s{};
  float course_rad{};
  std::array<float, 3> p_sigma_m{};
  std::array<float, 3> v_sigma_m_s{};
  std::array<float, 3> attitude_sigma_rad{};
  std::array<float, 2> wind_sigma_m_s{};
  std::array<float, kAids> innovation{};
  std::array<bool, kAids> refusing{};
};

// ---- rosflight_msgs, sensor_msgs, geometry_msgs, std_msgs
void serialize(CdrWriter& out, const Header& header, const link::Attitude& message);
void serialize(CdrWriter& out, const Header& header, const link::ExternalAttitude& message);
void serialize(CdrWriter& out, const Header& header, const link::Mag& message);
void serialize(CdrWriter& out, const Header& header, const link::Baro& message);
void serialize(CdrWriter& out, const Header& header, const link::DiffPressure& message);
void serialize(CdrWriter& out, const Header& header, const link::Range& message);
void serialize(CdrWriter& out, const Header& header, const link::RcChannels& message);
void serialize(CdrWriter& out, const Header& header, const link::OutputRaw& message);
void serialize(CdrWriter& out, const Header& header, const link::Status& message);
void serialize(CdrWriter& out, const Header& header, const link::HardError& message);
void serialize(CdrWriter& out, const Header& header, const link::Gnss& message);
void serialize(CdrWriter& out, const Header& header, const link::BatteryStatus& message);
void serialize(CdrWriter& out, const Header& header, const link::OffboardControl& message);
void serialize(CdrWriter& out, const Header& header, const link::AuxCommand& message);
/// std_msgs/String has no header.
void serialize(CdrWriter& out, const Header& header, const link::Version& message);
/// @param q_NB  Latest attitude, nullptr if none came yet: the first covariance is then -1, which
/// says so.
void serialize_imu(CdrWriter& out, const Header& header, const link::Imu& message,
                   const std::array<float, 4>* q_NB);
void serialize_temperature(CdrWriter& out, const Header& header, double temperature_K);
void serialize_vector(CdrWriter& out, const Header& header, const std::array<double, 3>& vector);
/// Roll, pitch, yaw, applied as yaw, then pitch, then roll [rad].
std::array<double, 3> euler_angles(const std::array<float, 4>& q_NB);

// ---- rosflight_log_msgs
void serialize(CdrWriter& out, const Header& header, Direction direction,
               const link::Heartbeat& message);
void serialize(CdrWriter& out, const Header& header, Direction direction,
               const link::TimeSync& message);
void serialize(CdrWriter& out, const Header& header, Direction direction, Bytes raw_frame);
void serialize(CdrWriter& out, const Header& header, const link::ParamRequestRead& message);
void serialize(CdrWriter& out, const Header& header, const link::ParamRequestList& message);
void serialize(CdrWriter& out, const Header& header, const link::ParamSet& message);
void serialize(CdrWriter& out, const Header& header, const link::ParamValue& message);
void serialize(CdrWriter& out, const Header& header, const link::CommandRequest& message);
void serialize(CdrWriter& out, const Header& header, const link::CommandAck& message);
void serialize(CdrWriter& out, const Header& header, const link::MotorTest& message);
void serialize(CdrWriter& out, const Header& header, const link::ReportRequest& message);
void serialize(CdrWriter& out, const Header& header, const link::CheckResult& message);
void serialize(CdrWriter& out, const Header& header, const link::Counters& message);
void serialize_parameter(CdrWriter& out, const Header& header, std::string_view name,
                         link::ParamType type, link::ParamBits value);
void serialize_phase(CdrWriter& out, const Header& header, std::string_view name);

// ---- the world
/// @param gravity_m_s2  Added to the specific force, which gives the acceleration ROSflight
/// publishes.
void serialize_state(CdrWriter& out, const Header& header, const sim::Truth& truth,
                     double gravity_m_s2);
void serialize_wrench(CdrWriter& out, const Header& header, const sim::Wrench& wrench);
void serialize_pwm(CdrWriter& out, const Header& header, const hal::OutputValues& outputs);
void serialize_vehicle(CdrWriter& out, const Header& header, const sim::Truth& truth,
                       const hal::OutputValues& outputs);

// ---- guidance and texts
void serialize(CdrWriter& out, const Header& header, const Setpoint& setpoint);
void serialize(CdrWriter& out, const Header& header, const Estimate& estimate);
/// rcl_interfaces/Log: a stamp instead of a header.
void serialize_text(CdrWriter& out, std::uint64_t stamp_ns, link::Severity severity,
                    std::string_view source, std::string_view text);

}  // namespace rosflight::log
