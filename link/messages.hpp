// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

/// The messages between flight control unit (FCU) and companion, as plain structs. Units and
/// frames are those of the wire, so that a codec only packs and unpacks: SI, body axes
/// front-right-down, quaternions scalar first (body to north-east-down). Ids and layouts:
/// docs/link.md.
namespace rosflight::link {

inline constexpr std::size_t kOutputs = 14;
inline constexpr std::size_t kCommandAxes = 10;  ///< Fx Fy Fz Qx Qy Qz and four free ones.
inline constexpr std::size_t kParamNameLength = 16;
inline constexpr std::size_t kTextLength = 50;
inline constexpr std::size_t kRcChannels = 18;
inline constexpr std::size_t kCheckNameLength = 16;
inline constexpr std::size_t kCounterBins = 8;
inline constexpr std::size_t kRecordPartBytes = 64;  ///< Half of an entry.

/// A name of at most 16 characters, NUL-padded; a name of exactly 16 has no NUL.
using ParamName = std::array<char, kParamNameLength>;

enum class ParamType : std::uint8_t { kInt32 = 6, kFloat = 9 };

/// The 32 bits of a parameter as they are transmitted; the ParamType beside them gives their type.
struct ParamBits {
  std::uint32_t bits{};
};

enum class VehicleType : std::uint8_t { kGeneric = 0, kFixedWing = 1, kMultirotor = 2 };

// ---- both directions

struct Heartbeat {
  VehicleType type{VehicleType::kGeneric};  ///< Companion: generic.
};

/// Time synchronisation. Request: tc1 = 0, ts1 = companion time. Answer: tc1 = FCU boot clock, ts1
/// echoed.
struct TimeSync {
  std::int64_t tc1_ns{};
  std::int64_t ts1_ns{};
};

// ---- companion to FCU

struct ParamRequestRead {
  std::uint8_t target_system{1};
  std::int16_t index{-1};  ///< >= 0 selects by index, negative by name.
  ParamName name{};
};

struct ParamRequestList {
  std::uint8_t target_system{1};
};

struct ParamSet {
  std::uint8_t target_system{1};
  ParamName name{};
  ParamBits value{};
  std::uint8_t type{};  ///< A ParamType if the sender behaves.
};

enum class OffboardMode : std::uint8_t {
  kPassThrough = 0,              ///< u = forces [N or fraction] and torques, straight to the mixer.
  kRatesThrottle = 1,            ///< u = throttle x y z, roll, pitch, yaw rate [rad/s].
  kRollPitchYawrateThrottle = 2  ///< u = throttle x y z, roll, pitch [rad], yaw rate [rad/s].
};

struct OffboardControl {
  std::uint8_t mode{};     ///< An OffboardMode if the sender behaves.
  std::uint16_t ignore{};  ///< Bit k set: axis k carries no command.
  std::array<float, kCommandAxes> u{};
};

enum class AuxType : std::uint8_t { kDisabled = 0, kServo = 1, kMotor = 2 };

struct AuxCommand {
  std::array<std::uint8_t, kOutputs> type{};  ///< AuxTypes if the sender behaves.
  std::array<float, kOutputs> value{};
};

struct ExternalAttitude {
  std::array<float, 4> q_WB{1.0f, 0.0f, 0.0f, 0.0f};  ///< w, x, y, z; need not be normalised.
};

enum class Command : std::uint8_t {
  kRcCalibration = 0,
  kAccelCalibration = 1,
  kGyroCalibration = 2,
  kBaroCalibration = 3,
  kAirspeedCalibration = 4,
  kReadParams = 5,
  kWriteParams = 6,
  kSetParamDefaults = 7,
  kReboot = 8,
  kRebootToBootloader = 9,
  kSendVersion = 10
};

struct CommandRequest {
  std::uint8_t command{};  ///< A Command if the sender behaves.
};

/// Runs one motor on the bench; must be repeated while it runs.
struct MotorTest {
  std::uint8_t target_system{1};
  std::uint8_t motor{};  ///< Output number, from 0.
  float value{};         ///< 0 to 1; the FCU has a limit of its own.
};

enum class ReportKind : std::uint8_t { kChecks = 0, kCounters = 1 };

struct ReportRequest {
  std::uint8_t target_system{1};
  std::uint8_t kind{};  ///< A ReportKind if the sender behaves.
};

/// Requests entries of the flight record, each answered by two RecordParts.
struct RecordRequest {
  std::uint8_t target_system{1};
  std::uint32_t first{};  ///< Number of the first one; 0: the oldest.
  std::uint16_t count{};  ///< 0: the answer is one part without an entry.
};

// ---- FCU to companion

struct ParamValue {
  ParamName name{};
  ParamBits value{};
  ParamType type{ParamType::kInt32};
  std::uint16_t count{};  ///< Number of parameters; the same for a whole run.
  std::uint16_t index{};
};

struct CommandAck {
  std::uint8_t command{};
  bool success{};
};

struct Attitude {
  std::uint32_t time_boot_ms{};
  std::array<float, 4> q_WB{1.0f, 0.0f, 0.0f, 0.0f};
  std::array<float, 3> rates_rad_s{};  ///< Low-passed, bias removed.
};

struct Imu {
  std::uint64_t time_boot_us{};
  std::array<float, 3> accel_m_s2{};
  std::array<float, 3> gyro_rad_s{};
  float temperature_K{};
};

struct Mag {
  std::array<float, 3> field_T{};
};

struct Baro {
  float altitude_m{};
  float pressure_Pa{};
  float temperature_K{};
};

struct DiffPressure {
  float airspeed_m_s{};  ///< Indicated, signed.
  float pressure_Pa{};
  float temperature_K{};
};

struct Range {
  std::uint8_t kind{};  ///< 0 sonar, 1 lidar.
  float range_m{};
  float max_m{};
  float min_m{};
};

struct RcChannels {
  std::uint32_t time_boot_ms{};
  std::array<std::uint16_t, kRcChannels> pulse_us{};
  std::uint8_t count{};
  std::uint8_t rssi{};
};

struct OutputRaw {
  std::uint64_t time_boot_ms{};  ///< Milliseconds, although the wire has 64 bits for it.
  std::array<float, kOutputs> values{};
};

struct Status {
  bool armed{};
  bool failsafe{};
  bool offboard{};  ///< An axis 0..5 of the last offboard command is in force.
  std::uint16_t rc_override{};
  std::uint8_t error_code{};
  std::uint8_t control_mode{};  ///< As OffboardMode.
  std::int16_t sensor_errors{};
  std::int16_t loop_time_us{};
};

struct Version {
  std::array<char, kTextLength> text{};  ///< NUL-terminated and NUL-padded.
};

struct HardError {
  std::uint32_t error_code{};
  std::uint32_t pc{};
  std::uint32_t reset_count{};
  std::uint32_t rearm{};
};

struct Gnss {
  std::int64_t unix_s{};
  std::int32_t unix_ns{};
  std::uint8_t fix{};
  std::uint8_t satellites{};
  double latitude_deg{};
  double longitude_deg{};
  float height_msl_m{};
  std::array<float, 3> velocity_ned_m_s{};
  float horizontal_accuracy_m{};
  float vertical_accuracy_m{};
  float speed_accuracy_m_s{};
  std::uint64_t time_boot_us{};
};

struct BatteryStatus {
  float voltage_V{};
  float current_A{};
};

enum class Severity : std::uint8_t { kCritical = 2, kError = 3, kWarning = 4, kInfo = 6 };

struct StatusText {
  Severity severity{Severity::kInfo};
  std::array<char, kTextLength> text{};  ///< NUL-terminated and NUL-padded.
};

enum class CheckOutcome : std::uint8_t { kPass = 0, kWarning = 1, kRefuses = 2 };

/// One line of the checks before arming; a ReportRequest is answered by all of them.
struct CheckResult {
  std::uint8_t index{};
  std::uint8_t count{};   ///< Lines of the list.
  std::uint8_t result{};  ///< A CheckOutcome if the sender behaves.
  std::array<char, kCheckNameLength> name{};
  std::array<char, kTextLength> reason{};  ///< NUL-terminated and NUL-padded; empty if it passed.
};

/// The counters of the FCU since its start; the answer to a ReportRequest.
struct Counters {
  std::uint32_t longest_pass_us{};
  std::uint32_t pass_budget_us{};
  std::uint32_t passes_over_budget{};
  std::uint32_t passes{};
  std::uint32_t frames_dropped{};  ///< Received and rejected.
  std::uint32_t tx_dropped{};      ///< Frames that the serial port rejected.
  std::uint32_t texts_lost{};
  std::array<std::uint32_t, kCounterBins> imu_jitter{};  ///< IMU intervals by their deviation.
  std::array<std::uint32_t, kCounterBins> rejected{};    ///< Sensor samples by cause.
};

/// One half of an entry of the flight record as it lies in the memory of the FCU; docs/link.md has its
/// layout. In halves, because a whole one would be the longest message by far.
struct RecordPart {
  std::uint32_t number{};  ///< Number of the entry; 0: none.
  std::uint32_t oldest{};  ///< Number of the oldest entry that there is.
  std::uint32_t newest{};
  std::uint8_t part{};  ///< 0, 1.
  std::array<std::uint8_t, kRecordPartBytes> bytes{};
};

using Message =
    std::variant<std::monostate, Heartbeat, TimeSync, ParamRequestRead, ParamRequestList, ParamSet,
                 OffboardControl, AuxCommand, ExternalAttitude, CommandRequest, ParamValue,
                 CommandAck, Attitude, Imu, Mag, Baro, DiffPressure, Range, RcChannels, OutputRaw,
                 Status, Version, HardError, Gnss, BatteryStatus, StatusText, MotorTest,
                 ReportRequest, CheckResult, Counters, RecordRequest, RecordPart>;

}  // namespace rosflight::link
