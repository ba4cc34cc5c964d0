// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace rosflight::log {

/// What a flight log can contain, in the order of kTopics.
enum class Topic : std::uint8_t {
  kImu,
  kImuTemperature,
  kAttitude,
  kAttitudeEuler,
  kBaro,
  kMagnetometer,
  kAirspeed,
  kRange,
  kGnss,
  kBattery,
  kRcRaw,
  kOutputRaw,
  kStatus,
  kVersion,
  kHardError,
  kCommand,
  kAuxCommand,
  kExternalAttitude,
  kHeartbeat,
  kTimeSync,
  kParamRequestRead,
  kParamRequestList,
  kParamSet,
  kParamValue,
  kCommandRequest,
  kCommandAck,
  kMotorTest,
  kReportRequest,
  kCheckResult,
  kCounters,
  kRawFrame,
  kTruthState,
  kTruthWind,
  kForcesAndMoments,
  kPwmOutput,
  kTruthVehicle,
  kSetpoint,
  kEstimate,
  kPhase,
  kParameter,
  kTexts
};

struct TopicType {
  std::string_view name;
  std::string_view type;
};

/// Names down to /external_attitude, /sim/ (but for truth_vehicle) and /trajectory_command:
/// ROSflight 2.x.
inline constexpr std::array kTopics{
    TopicType{"/imu/data", "sensor_msgs/msg/Imu"},
    TopicType{"/imu/temperature", "sensor_msgs/msg/Temperature"},
    TopicType{"/attitude", "rosflight_msgs/msg/Attitude"},
    TopicType{"/attitude/euler", "geometry_msgs/msg/Vector3Stamped"},
    TopicType{"/baro", "rosflight_msgs/msg/Barometer"},
    TopicType{"/magnetometer", "sensor_msgs/msg/MagneticField"},
    TopicType{"/airspeed", "rosflight_msgs/msg/Airspeed"},
    TopicType{"/range", "sensor_msgs/msg/Range"},
    TopicType{"/gnss", "rosflight_msgs/msg/GNSS"},
    TopicType{"/battery", "rosflight_msgs/msg/BatteryStatus"},
    TopicType{"/rc_raw", "rosflight_msgs/msg/RCRaw"},
    TopicType{"/output_raw", "rosflight_msgs/msg/OutputRaw"},
    TopicType{"/status", "rosflight_msgs/msg/Status"},
    TopicType{"/version", "std_msgs/msg/String"},
    TopicType{"/status/rosflight_errors", "rosflight_msgs/msg/Error"},
    TopicType{"/command", "rosflight_msgs/msg/Command"},
    TopicType{"/aux_command", "rosflight_msgs/msg/AuxCommand"},
    TopicType{"/external_attitude", "rosflight_msgs/msg/Attitude"},
    TopicType{"/link/heartbeat", "rosflight_log_msgs/msg/Heartbeat"},
    TopicType{"/link/time_sync", "rosflight_log_msgs/msg/TimeSync"},
    TopicType{"/link/param_request_read", "rosflight_log_msgs/msg/ParamRequestRead"},
    TopicType{"/link/param_request_list", "rosflight_log_msgs/msg/ParamRequestList"},
    TopicType{"/link/param_set", "rosflight_log_msgs/msg/ParamSet"},
    TopicType{"/link/param_value", "rosflight_log_msgs/msg/ParamValue"},
    TopicType{"/link/command_request", "rosflight_log_msgs/msg/CommandRequest"},
    TopicType{"/link/command_ack", "rosflight_log_msgs/msg/CommandAck"},
    TopicType{"/link/motor_test", "rosflight_log_msgs/msg/MotorTest"},
    TopicType{"/link/report_request", "rosflight_log_msgs/msg/ReportRequest"},
    TopicType{"/link/check_result", "rosflight_log_msgs/msg/CheckResult"},
    TopicType{"/link/counters", "rosflight_log_msgs/msg/Counters"},
    TopicType{"/link/raw", "rosflight_log_msgs/msg/RawFrame"},
    TopicType{"/sim/truth_state", "rosflight_msgs/msg/SimState"},
    TopicType{"/sim/truth_wind", "geometry_msgs/msg/Vector3Stamped"},
    TopicType{"/sim/forces_and_moments", "geometry_msgs/msg/WrenchStamped"},
    TopicType{"/sim/pwm_output", "rosflight_msgs/msg/PwmOutput"},
    TopicType{"/sim/truth_vehicle", "rosflight_log_msgs/msg/TruthVehicle"},
    TopicType{"/trajectory_command", "roscopter_msgs/msg/TrajectoryCommand"},
    TopicType{"/autonomy/estimate", "rosflight_log_msgs/msg/Estimate"},
    TopicType{"/autonomy/phase", "rosflight_log_msgs/msg/Phase"},
    TopicType{"/parameters", "rosflight_log_msgs/msg/Parameter"},
    TopicType{"/rosout", "rcl_interfaces/msg/Log"},
};
static_assert(kTopics.size() == static_cast<std::size_t>(Topic::kTexts) + 1);

inline constexpr std::string_view kInertialFrame = "NED";
inline constexpr std::string_view kBodyFrame = "body";

}  // namespace rosflight::log
