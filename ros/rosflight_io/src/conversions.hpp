// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/aux_command.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/error.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/output_raw.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>

#include "link/messages.hpp"

/// Link structs to ROS messages and back: fields only, headers are the caller's. Frames stay as on
/// the link (body front-right-down, north-east-down); units as the ROS type wants them.
namespace rosflight_io {

namespace link = rosflight::link;

/// Orientation is left as it is.
void fill(const link::Imu& in, sensor_msgs::msg::Imu& out);
/// In degrees Celsius, as the type says (ROSflight 2.x: kelvin).
void fill(const link::Imu& in, sensor_msgs::msg::Temperature& out);
void fill(const link::Attitude& in, rosflight_msgs::msg::Attitude& out);
/// x roll, y pitch, z yaw [rad], Z-Y-X convention.
void fill(const link::Attitude& in, geometry_msgs::msg::Vector3Stamped& out);
void fill(const link::Mag& in, sensor_msgs::msg::MagneticField& out);
void fill(const link::Baro& in, rosflight_msgs::msg::Barometer& out);
void fill(const link::DiffPressure& in, rosflight_msgs::msg::Airspeed& out);
void fill(const link::Range& in, sensor_msgs::msg::Range& out);
/// The first 8 channels; the message has no room for more.
void fill(const link::RcChannels& in, rosflight_msgs::msg::RCRaw& out);
void fill(const link::OutputRaw& in, rosflight_msgs::msg::OutputRaw& out);
void fill(const link::Gnss& in, rosflight_msgs::msg::GNSS& out);
void fill(const link::BatteryStatus& in, rosflight_msgs::msg::BatteryStatus& out);
void fill(const link::Status& in, rosflight_msgs::msg::Status& out);
void fill(const link::HardError& in, rosflight_msgs::msg::Error& out);

link::OffboardControl to_link(const rosflight_msgs::msg::Command& in);
link::AuxCommand to_link(const rosflight_msgs::msg::AuxCommand& in);
link::ExternalAttitude to_link(const rosflight_msgs::msg::Attitude& in);

/// "armed", "failsafe": one text for each error bit of Status, nullptr beyond the last.
const char* error_text(int bit);
/// "pass-through", "rate", "angle".
const char* control_mode_text(int mode);

}  // namespace rosflight_io
