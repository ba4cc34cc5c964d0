// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "messages/geometry_msgs.hpp"
#include "messages/rcl_interfaces.hpp"
#include "messages/ros_frames.hpp"
#include "messages/roscopter_msgs.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "messages/rosflight_msgs.hpp"
#include "messages/sensor_msgs.hpp"
#include "messages/std_msgs.hpp"

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
  kRawFrames,
  kTruthState,
  kTruthWind,
  kForcesAndMoments,
  kPwmOutput,
  kTruthVehicle,
  kSetpoint,
  kEstimate,
  kPhase,
  kParameter,
  kTexts,
  kTf,
  kTfStatic,
  kPose,
  kOdometry,
  kEstimateOdometry,
  kPath,
  kFix,
  kRobotDescription,
  kBoardInputs,
  kSettings
};

/// The shortest time between two messages of a topic [ms], in logs for plots and in full ones: the
/// first message of every interval is written. 0: all.
struct Thinning {
  std::uint32_t plot_ms{};
  std::uint32_t full_ms{};
};
inline constexpr Thinning kAll{};
inline constexpr Thinning kPlot100Hz{10, 0};
inline constexpr Thinning kPlot50Hz{20, 0};
/// Repeats what another topic or the link's bytes hold.
inline constexpr Thinning kRepeat{50, 50};
inline constexpr Thinning kPose{100, 100};
inline constexpr Thinning kOdometry{200, 200};  ///< Large messages of ROS that repeat others.

struct TopicType {
  std::string_view name;
  std::string_view type;
  std::string_view (*schema)();
  Thinning thinning;
};

template <class Message>
constexpr TopicType of(std::string_view name, Thinning thinning = kAll) {
  return {name, Message::kName, &Message::schema, thinning};
}

/// Names down to /external_attitude, /sim/ (but for truth_vehicle) and /trajectory_command:
/// ROSflight 2.x.
inline constexpr std::array kTopics{
    of<messages::sensor_msgs::Imu>("/imu/data"),
    of<messages::sensor_msgs::Temperature>("/imu/temperature", kRepeat),
    of<messages::rosflight_msgs::Attitude>("/attitude", kPlot100Hz),
    of<messages::geometry_msgs::Vector3Stamped>("/attitude/euler", kRepeat),
    of<messages::rosflight_msgs::Barometer>("/baro"),
    of<messages::sensor_msgs::MagneticField>("/magnetometer"),
    of<messages::rosflight_msgs::Airspeed>("/airspeed"),
    of<messages::sensor_msgs::Range>("/range"),
    of<messages::rosflight_msgs::GNSS>("/gnss"),
    of<messages::rosflight_msgs::BatteryStatus>("/battery"),
    of<messages::rosflight_msgs::RCRaw>("/rc_raw"),
    of<messages::rosflight_msgs::OutputRaw>("/output_raw", kPlot100Hz),
    of<messages::rosflight_msgs::Status>("/status"),
    of<messages::std_msgs::String>("/version"),
    of<messages::rosflight_msgs::Error>("/status/rosflight_errors"),
    of<messages::rosflight_msgs::Command>("/command", kPlot50Hz),
    of<messages::rosflight_msgs::AuxCommand>("/aux_command"),
    of<messages::rosflight_msgs::Attitude>("/external_attitude", kRepeat),
    of<messages::rosflight_log_msgs::Heartbeat>("/link/heartbeat"),
    of<messages::rosflight_log_msgs::TimeSync>("/link/time_sync"),
    of<messages::rosflight_log_msgs::ParamRequestRead>("/link/param_request_read"),
    of<messages::rosflight_log_msgs::ParamRequestList>("/link/param_request_list"),
    of<messages::rosflight_log_msgs::ParamSet>("/link/param_set"),
    of<messages::rosflight_log_msgs::ParamValue>("/link/param_value"),
    of<messages::rosflight_log_msgs::CommandRequest>("/link/command_request"),
    of<messages::rosflight_log_msgs::CommandAck>("/link/command_ack"),
    of<messages::rosflight_log_msgs::MotorTest>("/link/motor_test"),
    of<messages::rosflight_log_msgs::ReportRequest>("/link/report_request"),
    of<messages::rosflight_log_msgs::CheckResult>("/link/check_result"),
    of<messages::rosflight_log_msgs::Counters>("/link/counters"),
    of<messages::rosflight_log_msgs::RawFrames>("/link/raw"),
    of<messages::rosflight_msgs::SimState>("/sim/truth_state", kPlot100Hz),
    of<messages::geometry_msgs::Vector3Stamped>("/sim/truth_wind", kRepeat),
    of<messages::geometry_msgs::WrenchStamped>("/sim/forces_and_moments", kPlot100Hz),
    of<messages::rosflight_msgs::PwmOutput>("/sim/pwm_output", kRepeat),
    of<messages::rosflight_log_msgs::TruthVehicle>("/sim/truth_vehicle", kPlot100Hz),
    of<messages::roscopter_msgs::TrajectoryCommand>("/trajectory_command", kPlot50Hz),
    of<messages::rosflight_log_msgs::Estimate>("/autonomy/estimate", kPlot50Hz),
    of<messages::rosflight_log_msgs::Phase>("/autonomy/phase"),
    of<messages::rosflight_log_msgs::Parameter>("/parameters"),
    of<messages::rcl_interfaces::Log>("/rosout"),
    // For tools that do not know ROSflight, in the frames of REP-103 and REP-105.
    of<messages::tf2_msgs::TFMessage>("/tf", kRepeat),
    of<messages::tf2_msgs::TFMessage>("/tf_static"),
    of<messages::geometry_msgs::PoseStamped>("/sim/pose", kPose),
    of<messages::nav_msgs::Odometry>("/sim/odometry", kOdometry),
    of<messages::nav_msgs::Odometry>("/autonomy/odometry", kOdometry),
    of<messages::nav_msgs::Path>("/autonomy/path"),
    of<messages::sensor_msgs::NavSatFix>("/gnss/fix"),
    of<messages::std_msgs::String>("/robot_description"),
    of<messages::rosflight_log_msgs::BoardInputs>("/board/inputs"),
    of<messages::std_msgs::String>("/settings"),
};
static_assert(kTopics.size() == static_cast<std::size_t>(Topic::kSettings) + 1);

inline constexpr std::string_view kInertialFrame = messages::kNedFrame;
inline constexpr std::string_view kBodyFrame = messages::kBodyFrame;

}  // namespace rosflight::log
