// SPDX-License-Identifier: BSD-3-Clause
#include "log/schemas.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "log/output_file.hpp"

namespace rosflight::log {
namespace {

constexpr std::array kCommon{
    MessageDefinition{"builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec\n"},
    MessageDefinition{"std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    MessageDefinition{"std_msgs/msg/String", "string data\n"},
    MessageDefinition{"geometry_msgs/msg/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    MessageDefinition{"geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    MessageDefinition{"geometry_msgs/msg/Quaternion",
                      "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
    MessageDefinition{"geometry_msgs/msg/Pose",
                      "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    MessageDefinition{"geometry_msgs/msg/Twist",
                      "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    MessageDefinition{"geometry_msgs/msg/Accel",
                      "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    MessageDefinition{"geometry_msgs/msg/Wrench",
                      "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"},
    MessageDefinition{"geometry_msgs/msg/Vector3Stamped",
                      "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n"},
    MessageDefinition{"geometry_msgs/msg/WrenchStamped",
                      "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"},
    MessageDefinition{"sensor_msgs/msg/Imu", R"(std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
)"},
    MessageDefinition{"sensor_msgs/msg/MagneticField", R"(std_msgs/Header header
geometry_msgs/Vector3 magnetic_field
float64[9] magnetic_field_covariance
)"},
    MessageDefinition{"sensor_msgs/msg/Temperature", R"(std_msgs/Header header
float64 temperature
float64 variance
)"},
    MessageDefinition{"sensor_msgs/msg/Range", R"(std_msgs/Header header
uint8 ULTRASOUND=0
uint8 INFRARED=1
uint8 radiation_type
float32 field_of_view
float32 min_range
float32 max_range
float32 range
float32 variance
)"},
    MessageDefinition{"rcl_interfaces/msg/Log", R"(uint8 DEBUG=10
uint8 INFO=20
uint8 WARN=30
uint8 ERROR=40
uint8 FATAL=50
builtin_interfaces/Time stamp
uint8 level
string name
string msg
string file
string function
uint32 line
)"},
};

constexpr std::array kRosflight{
    MessageDefinition{"rosflight_msgs/msg/Airspeed", R"(std_msgs/Header header
float32 velocity
float32 differential_pressure
float32 temperature
)"},
    MessageDefinition{"rosflight_msgs/msg/Attitude", R"(std_msgs/Header header
geometry_msgs/Quaternion attitude
geometry_msgs/Vector3 angular_velocity
)"},
    MessageDefinition{"rosflight_msgs/msg/AuxCommand", R"(uint8 AUX_COMMAND_DISABLED=0
uint8 AUX_COMMAND_SERVO=1
uint8 AUX_COMMAND_MOTOR=2
std_msgs/Header header
uint8[14] type_array
float32[14] values
)"},
    MessageDefinition{"rosflight_msgs/msg/Barometer", R"(std_msgs/Header header
float32 altitude
float32 pressure
float32 temperature
)"},
    MessageDefinition{"rosflight_msgs/msg/BatteryStatus", R"(std_msgs/Header header
float32 voltage
float32 current
)"},
    MessageDefinition{"rosflight_msgs/msg/Command", R"(uint8 MODE_PASS_THROUGH=0
uint8 MODE_ROLLRATE_PITCHRATE_YAWRATE_THROTTLE=1
uint8 MODE_ROLL_PITCH_YAWRATE_THROTTLE=2
uint16 IGNORE_NONE=0
uint16 IGNORE_VALUE0=1
uint16 IGNORE_VALUE1=2
uint16 IGNORE_VALUE2=4
uint16 IGNORE_VALUE3=8
uint16 IGNORE_VALUE4=16
uint16 IGNORE_VALUE5=32
uint16 IGNORE_VALUE6=64
uint16 IGNORE_VALUE7=128
uint16 IGNORE_VALUE8=256
uint16 IGNORE_VALUE9=512
std_msgs/Header header
uint8 mode
uint16 ignore
float32[10] u
)"},
    MessageDefinition{"rosflight_msgs/msg/Error", R"(std_msgs/Header header
string error_message
uint32 error_code
uint32 reset_count
bool rearm
uint32 pc
)"},
    MessageDefinition{"rosflight_msgs/msg/GNSS", R"(uint8 GNSS_FIX_TYPE_NO_FIX=0
uint8 GNSS_FIX_TYPE_DEAD_RECKONING_ONLY=1
uint8 GNSS_FIX_TYPE_2D_FIX=2
uint8 GNSS_FIX_TYPE_3D_FIX=3
uint8 GNSS_FIX_TYPE_GNSS_PLUS_DEAD_RECKONING=4
uint8 GNSS_FIX_TYPE_TIME_FIX_ONLY=5
std_msgs/Header header
uint8 fix_type
uint8 num_sat
float64 lat
float64 lon
float32 alt
float32 horizontal_accuracy
float32 vertical_accuracy
float32 vel_n
float32 vel_e
float32 vel_d
float32 speed_accuracy
int64 gnss_unix_seconds
int32 gnss_unix_nanos
)"},
    MessageDefinition{"rosflight_msgs/msg/OutputRaw",
                      "std_msgs/Header header\nfloat32[14] values\n"},
    MessageDefinition{"rosflight_msgs/msg/PwmOutput",
                      "std_msgs/Header header\nuint16[14] values\n"},
    MessageDefinition{"rosflight_msgs/msg/RCRaw", "std_msgs/Header header\nuint16[8] values\n"},
    MessageDefinition{"rosflight_msgs/msg/SimState", R"(std_msgs/Header header
geometry_msgs/Pose pose
geometry_msgs/Twist twist
geometry_msgs/Accel acceleration
)"},
    MessageDefinition{"rosflight_msgs/msg/Status", R"(uint16 OVERRIDE_NO_OVERRIDE=0
uint16 OVERRIDE_ATT_SWITCH=1
uint16 OVERRIDE_THR_SWITCH=2
uint16 OVERRIDE_X=4
uint16 OVERRIDE_Y=8
uint16 OVERRIDE_Z=16
uint16 OVERRIDE_T=32
uint16 OVERRIDE_OFFBOARD_X_INACTIVE=64
uint16 OVERRIDE_OFFBOARD_Y_INACTIVE=128
uint16 OVERRIDE_OFFBOARD_Z_INACTIVE=256
uint16 OVERRIDE_OFFBOARD_T_INACTIVE=512
std_msgs/Header header
bool armed
bool failsafe
uint16 rc_override
bool offboard
uint8 control_mode
uint8 error_code
int16 num_errors
int16 loop_time_us
)"},
    MessageDefinition{"roscopter_msgs/msg/TrajectoryCommand", R"(std_msgs/Header header
float32[3] position
float32[3] velocity
float32[3] acceleration
float32 psi
float32 psi_dot
float32 psi_dot_dot
)"},
};

constexpr std::array kOwn{
    MessageDefinition{"rosflight_log_msgs/msg/RawFrame",
                      R"(# One frame as it crossed the serial cable.
uint8 FCU_TO_COMPANION=0
uint8 COMPANION_TO_FCU=1
std_msgs/Header header
uint8 direction
uint8[] data
)"},
    MessageDefinition{"rosflight_log_msgs/msg/Heartbeat", R"(uint8 GENERIC=0
uint8 FIXED_WING=1
uint8 MULTIROTOR=2
std_msgs/Header header
uint8 direction
uint8 vehicle_type
)"},
    MessageDefinition{"rosflight_log_msgs/msg/TimeSync", R"(std_msgs/Header header
uint8 direction
int64 tc1  # ns: 0 in a request, FCU boot clock in an answer
int64 ts1  # ns: clock of the companion, echoed in the answer
)"},
    MessageDefinition{"rosflight_log_msgs/msg/ParamRequestRead", R"(std_msgs/Header header
uint8 target_system
int16 index  # negative: by name
string name
)"},
    MessageDefinition{"rosflight_log_msgs/msg/ParamRequestList",
                      "std_msgs/Header header\nuint8 target_system\n"},
    MessageDefinition{"rosflight_log_msgs/msg/ParamSet", R"(uint8 INT32=6
uint8 FLOAT=9
std_msgs/Header header
uint8 target_system
string name
uint8 type
float64 value  # exact; NaN if the type is neither of the two
uint32 bits    # as they travelled
)"},
    MessageDefinition{"rosflight_log_msgs/msg/ParamValue", R"(uint8 INT32=6
uint8 FLOAT=9
std_msgs/Header header
string name
uint8 type
float64 value  # exact
uint32 bits    # as they travelled
uint16 index
uint16 count
)"},
    MessageDefinition{"rosflight_log_msgs/msg/CommandRequest",
                      "std_msgs/Header header\nuint8 command  # ROSFLIGHT_CMD code\n"},
    MessageDefinition{"rosflight_log_msgs/msg/CommandAck",
                      "std_msgs/Header header\nuint8 command\nbool success\n"},
    MessageDefinition{"rosflight_log_msgs/msg/MotorTest", R"(std_msgs/Header header
uint8 target_system
uint8 motor    # output, from 0
float32 value  # 0 to 1
)"},
    MessageDefinition{"rosflight_log_msgs/msg/ReportRequest", R"(uint8 CHECKS=0
uint8 COUNTERS=1
std_msgs/Header header
uint8 target_system
uint8 kind
)"},
    MessageDefinition{"rosflight_log_msgs/msg/CheckResult", R"(uint8 PASS=0
uint8 WARNING=1
uint8 REFUSES=2
std_msgs/Header header
uint8 index
uint8 count
uint8 result
string name
string reason
)"},
    MessageDefinition{"rosflight_log_msgs/msg/Counters", R"(std_msgs/Header header
uint32 longest_pass  # us
uint32 pass_budget   # us
uint32 passes_over_budget
uint32 passes
uint32 frames_dropped
uint32 tx_dropped
uint32 texts_lost
uint32[8] imu_jitter
uint32[8] rejected
)"},
    MessageDefinition{"rosflight_log_msgs/msg/Parameter", R"(uint8 INT32=6
uint8 FLOAT=9
std_msgs/Header header
string name
uint8 type
float64 value  # exact
)"},
    MessageDefinition{
        "rosflight_log_msgs/msg/Estimate",
        R"(# What guidance is told of the vehicle; sigma: standard deviations by the filter.
std_msgs/Header header
float32[3] position         # m, north-east-down
float32[3] velocity         # m/s, over ground
float32[4] attitude         # w, x, y, z: takes body coordinates to north-east-down
float32[3] gyro_bias        # rad/s, body axes
float32[3] accel_bias       # m/s^2, body axes
float32[2] wind             # m/s, north, east; NaN where the filter has none
float32 airspeed            # m/s; NaN likewise
float32 course              # rad
float32[3] position_sigma
float32[3] velocity_sigma
float32[3] attitude_sigma   # rad, about body axes
float32[2] wind_sigma
# Of each aid (GNSS horizontal, GNSS altitude, GNSS velocity, barometer, heading, range, pitot, sideslip, rest):
float32[9] innovation       # squared, over its covariance and degrees of freedom: 1 on average
bool[9] refusing
)"},
    MessageDefinition{"rosflight_log_msgs/msg/Phase", "std_msgs/Header header\nstring name\n"},
    MessageDefinition{"rosflight_log_msgs/msg/TruthVehicle", R"(std_msgs/Header header
float32[14] outputs                    # 0..1, commands to the actuators
float64[] rotor_speed                  # rad/s
float64 battery_voltage                # V
float64 battery_current                # A
bool on_ground
geometry_msgs/Vector3 specific_force   # m/s^2, body axes: what an ideal accelerometer reads
float64 air_density                    # kg/m^3
float64 air_pressure                   # Pa
float64 air_temperature                # K
)"},
};

constexpr auto join() {
  std::array<MessageDefinition, kCommon.size() + kRosflight.size() + kOwn.size()> all{};
  auto* out = all.begin();
  out = std::copy(kCommon.begin(), kCommon.end(), out);
  out = std::copy(kRosflight.begin(), kRosflight.end(), out);
  std::copy(kOwn.begin(), kOwn.end(), out);
  return all;
}

constexpr auto kDefinitions = join();

/// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" are the same type.
std::string short_name(std::string_view name) {
  constexpr std::string_view kMiddle = "/msg/";
  std::string text(name);
  const std::size_t at = text.find(kMiddle);
  if (at != std::string::npos) text.replace(at, kMiddle.size(), "/");
  return text;
}

const MessageDefinition& find_definition(std::string_view name) {
  const std::string wanted = short_name(name);
  for (const MessageDefinition& definition : kDefinitions) {
    if (short_name(definition.name) == wanted) return definition;
  }
  throw LogError("no message definition for " + std::string(name));
}

/// Types named in `text` by package/Type, in order of appearance.
std::vector<std::string> types_inside(std::string_view text) {
  std::vector<std::string> types;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    const std::string_view type = text.substr(0, std::min(text.find(' '), end));
    if (type.find('/') != std::string_view::npos) types.emplace_back(type);
    text.remove_prefix(end + 1);
  }
  return types;
}

}  // namespace

std::span<const MessageDefinition> message_definitions() {
  return kDefinitions;
}

std::string schema_text(std::string_view name) {
  const MessageDefinition& root = find_definition(name);
  std::string out(root.text);
  std::vector<std::string> wanted = types_inside(root.text);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const std::string type = wanted[k];
    if (std::find(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(k), type) !=
        wanted.begin() + static_cast<std::ptrdiff_t>(k)) {
      continue;
    }
    const MessageDefinition& inner = find_definition(type);
    out += std::string(80, '=') + "\nMSG: " + type + "\n";
    out += inner.text;
    const auto more = types_inside(inner.text);
    wanted.insert(wanted.end(), more.begin(), more.end());
  }
  return out;
}

}  // namespace rosflight::log
