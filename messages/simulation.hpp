// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/samples.hpp"
#include "messages/geometry_msgs.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "messages/rosflight_msgs.hpp"
#include "messages/sensor_msgs.hpp"
#include "sim/types.hpp"

/// Truth and samples of the simulator as ROS 2 messages and back. SI, north-east-down and
/// front-right-down on both sides, as ROSflight 2.x has them; units where a .msg file says
/// otherwise. Headers are the caller's.
namespace rosflight::messages {

// ---- truth

/// Acceleration: the inertial one in body axes (gravity and ground included, without w x v), and
/// the derivative of the body rate. @param gravity_m_s2  the simulation's.
rosflight_msgs::SimState to_message(const sim::Truth& truth, double gravity_m_s2);
sim::BodyState body_state(const rosflight_msgs::SimState& in);
/// Motion and accelerations of a truth; the rest of it stays. @returns false, with nothing changed,
/// for a message with a NaN or a quaternion that is none: other people's nodes send this.
bool from_message(const rosflight_msgs::SimState& in, double gravity_m_s2, sim::Truth& truth);

geometry_msgs::Vector3Stamped wind_message(const sim::Vector3& wind_W);
/// @returns false, with nothing changed, if a number is not finite. So does the next one.
bool from_message(const geometry_msgs::Vector3Stamped& in, sim::Vector3& wind_W);
geometry_msgs::WrenchStamped to_message(const sim::Wrench& wrench);
bool from_message(const geometry_msgs::WrenchStamped& in, sim::Wrench& wrench);

/// Outputs, rotors, battery and air. Keeps the memory of `out`.
void fill_vehicle(const sim::Truth& truth, const hal::OutputValues& outputs,
                  rosflight_log_msgs::TruthVehicle& out);

// ---- outputs and receiver

/// 0..1 to 1000..2000 us, whole microseconds, rounded down as ROSflight does; a NaN is 1000.
std::uint16_t pulse_us(float value);
/// The other way: 1000 us are 0, 2000 us are 1; not limited.
float fraction(std::uint16_t pulse_us);

rosflight_msgs::PwmOutput to_message(const hal::OutputValues& outputs);
/// Pulses beyond 1000..2000 are cut.
void from_message(const rosflight_msgs::PwmOutput& in, hal::OutputValues& outputs);
/// Pulses as they are: the firmware judges levels that no transmitter sends.
void from_message(const rosflight_msgs::RCRaw& in, hal::RcFrame& frame);

// ---- sensors; stamps are the caller's

sensor_msgs::Imu imu_message(const sim::Vector3& accel_m_s2, const sim::Vector3& gyro_rad_s);
sensor_msgs::Imu to_message(const hal::ImuSample& in);
sensor_msgs::Temperature imu_temperature(const hal::ImuSample& in);  ///< In degrees Celsius.
float temperature_K(const sensor_msgs::Temperature& in);
sensor_msgs::MagneticField to_message(const hal::MagSample& in);
rosflight_msgs::Barometer to_message(const hal::BaroSample& in);
rosflight_msgs::Airspeed to_message(const hal::DiffPressureSample& in);
sensor_msgs::Range to_message(const hal::RangeSample& in);
rosflight_msgs::BatteryStatus to_message(const hal::BatterySample& in);
rosflight_msgs::GNSS to_message(const hal::GnssSample& in);

void from_message(const sensor_msgs::Imu& in, hal::ImuSample& out);
void from_message(const sensor_msgs::MagneticField& in, hal::MagSample& out);
void from_message(const rosflight_msgs::Barometer& in, hal::BaroSample& out);
void from_message(const rosflight_msgs::Airspeed& in, hal::DiffPressureSample& out);
void from_message(const sensor_msgs::Range& in, hal::RangeSample& out);
void from_message(const rosflight_msgs::BatteryStatus& in, hal::BatterySample& out);
/// A kind of fix that does not exist is none.
void from_message(const rosflight_msgs::GNSS& in, hal::GnssSample& out);

}  // namespace rosflight::messages
