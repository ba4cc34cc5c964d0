// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "link/messages.hpp"
#include "messages/geometry_msgs.hpp"
#include "messages/rcl_interfaces.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "messages/rosflight_msgs.hpp"
#include "messages/sensor_msgs.hpp"
#include "messages/std_msgs.hpp"

/// Structs of the link as ROS 2 messages and back. Frames stay those of the link (body
/// front-right-down, north-east-down, quaternions from body to local); units are those of the .msg
/// files. Headers are empty and `direction` is 0: both are the caller's.
namespace rosflight::messages {

builtin_interfaces::Time stamp_of(std::uint64_t time_ns);

/// Roll, pitch, yaw, applied as yaw, then pitch, then roll [rad]. @param q_WB  w, x, y, z.
std::array<double, 3> euler_angles(const std::array<float, 4>& q_WB);

// ---- FCU to companion

/// Orientation: identity, and -1 as its first covariance, which says that it is not known.
sensor_msgs::Imu to_message(const link::Imu& in);
/// With the orientation of the latest attitude. Covariances are 0: not known.
sensor_msgs::Imu to_message(const link::Imu& in, const link::Attitude& latest);
sensor_msgs::Temperature imu_temperature(const link::Imu& in);  ///< In degrees Celsius.
rosflight_msgs::Attitude to_message(const link::Attitude& in);
geometry_msgs::Vector3Stamped euler_message(const link::Attitude& in);  ///< See euler_angles().
sensor_msgs::MagneticField to_message(const link::Mag& in);
rosflight_msgs::Barometer to_message(const link::Baro& in);
rosflight_msgs::Airspeed to_message(const link::DiffPressure& in);
/// Kind 1 is a lidar: infrared, 2 degrees wide. Any other is a sonar: ultrasound, 60 degrees.
sensor_msgs::Range to_message(const link::Range& in);
rosflight_msgs::RCRaw to_message(const link::RcChannels& in);  ///< The first 8 channels.
rosflight_msgs::OutputRaw to_message(const link::OutputRaw& in);
rosflight_msgs::Status to_message(const link::Status& in);
rosflight_msgs::Error to_message(const link::HardError& in);
rosflight_msgs::GNSS to_message(const link::Gnss& in);
rosflight_msgs::BatteryStatus to_message(const link::BatteryStatus& in);
std_msgs::String to_message(const link::Version& in);
/// Critical becomes fatal; `name` says who wrote the text. The stamp is the caller's.
rcl_interfaces::Log to_message(link::Severity severity, std::string_view name,
                               std::string_view text);

// ---- companion to FCU

rosflight_msgs::Command to_message(const link::OffboardControl& in);
rosflight_msgs::AuxCommand to_message(const link::AuxCommand& in);
rosflight_msgs::Attitude to_message(const link::ExternalAttitude& in);

link::OffboardControl to_link(const rosflight_msgs::Command& in);
link::AuxCommand to_link(const rosflight_msgs::AuxCommand& in);
link::ExternalAttitude to_link(const rosflight_msgs::Attitude& in);  ///< Its quaternion.

// ---- link traffic that ROSflight has no message for

rosflight_log_msgs::Heartbeat to_message(const link::Heartbeat& in);
rosflight_log_msgs::TimeSync to_message(const link::TimeSync& in);
rosflight_log_msgs::ParamRequestRead to_message(const link::ParamRequestRead& in);
rosflight_log_msgs::ParamRequestList to_message(const link::ParamRequestList& in);
rosflight_log_msgs::ParamSet to_message(const link::ParamSet& in);
rosflight_log_msgs::ParamValue to_message(const link::ParamValue& in);
rosflight_log_msgs::CommandRequest to_message(const link::CommandRequest& in);
rosflight_log_msgs::CommandAck to_message(const link::CommandAck& in);
rosflight_log_msgs::MotorTest to_message(const link::MotorTest& in);
rosflight_log_msgs::ReportRequest to_message(const link::ReportRequest& in);
rosflight_log_msgs::CheckResult to_message(const link::CheckResult& in);
rosflight_log_msgs::Counters to_message(const link::Counters& in);
rosflight_log_msgs::Parameter to_message(std::string_view name, link::ParamType type,
                                         link::ParamBits value);

}  // namespace rosflight::messages
