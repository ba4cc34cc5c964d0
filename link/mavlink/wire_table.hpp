// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <variant>

#include "link/codec.hpp"
#include "link/mavlink/checksum.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "link/mavlink/wire.hpp"
#include "link/messages.hpp"

/// One row per alternative of link::Message: how it is framed and which functions do its payload. Ids,
/// lengths and CRC_EXTRA are those of the generated headers. Private to the codec.
///
/// There are two tables, so that an FCU carries no code that only a companion needs.
namespace rosflight::link::mavlink {

inline constexpr std::uint8_t kStartByte = 0xFE;
inline constexpr std::size_t kHeaderBytes = 6;
inline constexpr std::size_t kOverheadBytes = kHeaderBytes + sizeof(std::uint16_t);

template <typename M, typename... Ms>
inline constexpr bool is_any_of = (std::is_same_v<M, Ms> || ...);

struct Row {
  std::uint8_t id;
  std::uint8_t length;  ///< Payload bytes.
  std::uint8_t crc_extra;
  std::uint8_t alternative;  ///< Index in link::Message.
  // nullptr: this end does not send it, or has no use for it.
  void (*pack)(const Message& message, std::uint8_t* payload);
  void (*unpack)(const std::uint8_t* payload, Message& message);
};

struct Table {
  std::array<Row, std::variant_size_v<Message>> rows;
};

/// What an FCU only receives, and what it also receives; it only sends all others.
template <typename M>
inline constexpr bool kFcuReceivesOnly =
    is_any_of<M, ParamRequestRead, ParamRequestList, ParamSet, OffboardControl, AuxCommand,
              ExternalAttitude, CommandRequest, MotorTest, ReportRequest, RecordRequest>;
template <typename M>
inline constexpr bool kFcuReceives = kFcuReceivesOnly<M> || is_any_of<M, Heartbeat, TimeSync>;

// The generated structs are in wire order without gaps, so their first kLength bytes are the
// payload.

/// Writes the payload of the alternative Ours of the message.
template <typename Ours, typename Wire, std::uint8_t kLength>
void pack_as(const Message& message, std::uint8_t* payload) {
  const Ours* const ours = std::get_if<Ours>(&message);
  if (ours == nullptr) return;  // not reached: the row was chosen by the alternative
  Wire wire;
  pack(*ours, wire);
  std::memcpy(payload, &wire, kLength);
}

/// Makes `message` an Ours with the values of the payload.
template <typename Ours, typename Wire, std::uint8_t kLength>
void unpack_as(const std::uint8_t* payload, Message& message) {
  Wire wire;
  std::memcpy(&wire, payload, kLength);
  unpack(wire, message.emplace<Ours>());
}

/// The row of one message of the dialect.
template <bool kFcu, typename Ours, typename Wire, std::uint8_t kId, std::uint8_t kLength,
          std::uint8_t kCrcExtra>
constexpr Row row() {
  static_assert(sizeof(Wire) >= kLength && sizeof(Wire) < kLength + alignof(Wire));
  constexpr std::size_t kAlternative = Message(std::in_place_type<Ours>).index();
  return {kId,
          kLength,
          kCrcExtra,
          static_cast<std::uint8_t>(kAlternative),
          kFcu && kFcuReceivesOnly<Ours> ? nullptr : &pack_as<Ours, Wire, kLength>,
          kFcu && !kFcuReceives<Ours> ? nullptr : &unpack_as<Ours, Wire, kLength>};
}

inline constexpr std::uint8_t kNoRow = 0;  ///< std::monostate.

/// @tparam kFcu  only the directions that an FCU needs.
template <bool kFcu>
inline constexpr Table kTable = {{{
    {},
    row<kFcu, Heartbeat, mavlink_heartbeat_t, MAVLINK_MSG_ID_HEARTBEAT,
        MAVLINK_MSG_ID_HEARTBEAT_LEN, MAVLINK_MSG_ID_HEARTBEAT_CRC>(),
    row<kFcu, TimeSync, mavlink_timesync_t, MAVLINK_MSG_ID_TIMESYNC, MAVLINK_MSG_ID_TIMESYNC_LEN,
        MAVLINK_MSG_ID_TIMESYNC_CRC>(),
    row<kFcu, ParamRequestRead, mavlink_param_request_read_t, MAVLINK_MSG_ID_PARAM_REQUEST_READ,
        MAVLINK_MSG_ID_PARAM_REQUEST_READ_LEN, MAVLINK_MSG_ID_PARAM_REQUEST_READ_CRC>(),
    row<kFcu, ParamRequestList, mavlink_param_request_list_t, MAVLINK_MSG_ID_PARAM_REQUEST_LIST,
        MAVLINK_MSG_ID_PARAM_REQUEST_LIST_LEN, MAVLINK_MSG_ID_PARAM_REQUEST_LIST_CRC>(),
    row<kFcu, ParamSet, mavlink_param_set_t, MAVLINK_MSG_ID_PARAM_SET, MAVLINK_MSG_ID_PARAM_SET_LEN,
        MAVLINK_MSG_ID_PARAM_SET_CRC>(),
    row<kFcu, OffboardControl, mavlink_offboard_control_t, MAVLINK_MSG_ID_OFFBOARD_CONTROL,
        MAVLINK_MSG_ID_OFFBOARD_CONTROL_LEN, MAVLINK_MSG_ID_OFFBOARD_CONTROL_CRC>(),
    row<kFcu, AuxCommand, mavlink_rosflight_aux_cmd_t, MAVLINK_MSG_ID_ROSFLIGHT_AUX_CMD,
        MAVLINK_MSG_ID_ROSFLIGHT_AUX_CMD_LEN, MAVLINK_MSG_ID_ROSFLIGHT_AUX_CMD_CRC>(),
    row<kFcu, ExternalAttitude, mavlink_external_attitude_t, MAVLINK_MSG_ID_EXTERNAL_ATTITUDE,
        MAVLINK_MSG_ID_EXTERNAL_ATTITUDE_LEN, MAVLINK_MSG_ID_EXTERNAL_ATTITUDE_CRC>(),
    row<kFcu, CommandRequest, mavlink_rosflight_cmd_t, MAVLINK_MSG_ID_ROSFLIGHT_CMD,
        MAVLINK_MSG_ID_ROSFLIGHT_CMD_LEN, MAVLINK_MSG_ID_ROSFLIGHT_CMD_CRC>(),
    row<kFcu, ParamValue, mavlink_param_value_t, MAVLINK_MSG_ID_PARAM_VALUE,
        MAVLINK_MSG_ID_PARAM_VALUE_LEN, MAVLINK_MSG_ID_PARAM_VALUE_CRC>(),
    row<kFcu, CommandAck, mavlink_rosflight_cmd_ack_t, MAVLINK_MSG_ID_ROSFLIGHT_CMD_ACK,
        MAVLINK_MSG_ID_ROSFLIGHT_CMD_ACK_LEN, MAVLINK_MSG_ID_ROSFLIGHT_CMD_ACK_CRC>(),
    row<kFcu, Attitude, mavlink_attitude_quaternion_t, MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
        MAVLINK_MSG_ID_ATTITUDE_QUATERNION_LEN, MAVLINK_MSG_ID_ATTITUDE_QUATERNION_CRC>(),
    row<kFcu, Imu, mavlink_small_imu_t, MAVLINK_MSG_ID_SMALL_IMU, MAVLINK_MSG_ID_SMALL_IMU_LEN,
        MAVLINK_MSG_ID_SMALL_IMU_CRC>(),
    row<kFcu, Mag, mavlink_small_mag_t, MAVLINK_MSG_ID_SMALL_MAG, MAVLINK_MSG_ID_SMALL_MAG_LEN,
        MAVLINK_MSG_ID_SMALL_MAG_CRC>(),
    row<kFcu, Baro, mavlink_small_baro_t, MAVLINK_MSG_ID_SMALL_BARO, MAVLINK_MSG_ID_SMALL_BARO_LEN,
        MAVLINK_MSG_ID_SMALL_BARO_CRC>(),
    row<kFcu, DiffPressure, mavlink_diff_pressure_t, MAVLINK_MSG_ID_DIFF_PRESSURE,
        MAVLINK_MSG_ID_DIFF_PRESSURE_LEN, MAVLINK_MSG_ID_DIFF_PRESSURE_CRC>(),
    row<kFcu, Range, mavlink_small_range_t, MAVLINK_MSG_ID_SMALL_RANGE,
        MAVLINK_MSG_ID_SMALL_RANGE_LEN, MAVLINK_MSG_ID_SMALL_RANGE_CRC>(),
    row<kFcu, RcChannels, mavlink_rc_channels_t, MAVLINK_MSG_ID_RC_CHANNELS,
        MAVLINK_MSG_ID_RC_CHANNELS_LEN, MAVLINK_MSG_ID_RC_CHANNELS_CRC>(),
    row<kFcu, OutputRaw, mavlink_rosflight_output_raw_t, MAVLINK_MSG_ID_ROSFLIGHT_OUTPUT_RAW,
        MAVLINK_MSG_ID_ROSFLIGHT_OUTPUT_RAW_LEN, MAVLINK_MSG_ID_ROSFLIGHT_OUTPUT_RAW_CRC>(),
    row<kFcu, Status, mavlink_rosflight_status_t, MAVLINK_MSG_ID_ROSFLIGHT_STATUS,
        MAVLINK_MSG_ID_ROSFLIGHT_STATUS_LEN, MAVLINK_MSG_ID_ROSFLIGHT_STATUS_CRC>(),
    row<kFcu, Version, mavlink_rosflight_version_t, MAVLINK_MSG_ID_ROSFLIGHT_VERSION,
        MAVLINK_MSG_ID_ROSFLIGHT_VERSION_LEN, MAVLINK_MSG_ID_ROSFLIGHT_VERSION_CRC>(),
    row<kFcu, HardError, mavlink_rosflight_hard_error_t, MAVLINK_MSG_ID_ROSFLIGHT_HARD_ERROR,
        MAVLINK_MSG_ID_ROSFLIGHT_HARD_ERROR_LEN, MAVLINK_MSG_ID_ROSFLIGHT_HARD_ERROR_CRC>(),
    row<kFcu, Gnss, mavlink_rosflight_gnss_t, MAVLINK_MSG_ID_ROSFLIGHT_GNSS,
        MAVLINK_MSG_ID_ROSFLIGHT_GNSS_LEN, MAVLINK_MSG_ID_ROSFLIGHT_GNSS_CRC>(),
    row<kFcu, BatteryStatus, mavlink_rosflight_battery_status_t,
        MAVLINK_MSG_ID_ROSFLIGHT_BATTERY_STATUS, MAVLINK_MSG_ID_ROSFLIGHT_BATTERY_STATUS_LEN,
        MAVLINK_MSG_ID_ROSFLIGHT_BATTERY_STATUS_CRC>(),
    row<kFcu, StatusText, mavlink_statustext_t, MAVLINK_MSG_ID_STATUSTEXT,
        MAVLINK_MSG_ID_STATUSTEXT_LEN, MAVLINK_MSG_ID_STATUSTEXT_CRC>(),
    row<kFcu, MotorTest, mavlink_motor_test_t, MAVLINK_MSG_ID_MOTOR_TEST,
        MAVLINK_MSG_ID_MOTOR_TEST_LEN, MAVLINK_MSG_ID_MOTOR_TEST_CRC>(),
    row<kFcu, ReportRequest, mavlink_report_request_t, MAVLINK_MSG_ID_REPORT_REQUEST,
        MAVLINK_MSG_ID_REPORT_REQUEST_LEN, MAVLINK_MSG_ID_REPORT_REQUEST_CRC>(),
    row<kFcu, CheckResult, mavlink_check_result_t, MAVLINK_MSG_ID_CHECK_RESULT,
        MAVLINK_MSG_ID_CHECK_RESULT_LEN, MAVLINK_MSG_ID_CHECK_RESULT_CRC>(),
    row<kFcu, Counters, mavlink_counters_t, MAVLINK_MSG_ID_COUNTERS, MAVLINK_MSG_ID_COUNTERS_LEN,
        MAVLINK_MSG_ID_COUNTERS_CRC>(),
    row<kFcu, RecordRequest, mavlink_record_request_t, MAVLINK_MSG_ID_RECORD_REQUEST,
        MAVLINK_MSG_ID_RECORD_REQUEST_LEN, MAVLINK_MSG_ID_RECORD_REQUEST_CRC>(),
    row<kFcu, RecordPart, mavlink_record_part_t, MAVLINK_MSG_ID_RECORD_PART,
        MAVLINK_MSG_ID_RECORD_PART_LEN, MAVLINK_MSG_ID_RECORD_PART_CRC>(),
}}};
inline constexpr const std::array<Row, std::variant_size_v<Message>>& kRows = kTable<false>.rows;

/// Row i describes alternative i.
constexpr bool rows_follow_message() {
  for (std::size_t i = 1; i < kRows.size(); ++i) {
    if (kRows[i].alternative != i) return false;
  }
  return true;
}
static_assert(rows_follow_message(), "row i belongs to alternative i of link::Message");

/// Index of the row of each id; kNoRow where the dialect has no message.
constexpr std::array<std::uint8_t, 256> index_rows() {
  std::array<std::uint8_t, 256> of_id{};
  for (std::size_t i = 1; i < kRows.size(); ++i) of_id[kRows[i].id] = static_cast<std::uint8_t>(i);
  return of_id;
}
inline constexpr std::array<std::uint8_t, 256> kRowOfId = index_rows();

/// The row of an id; nullptr if the dialect has no such message.
inline const Row* find_row(const Table& table, std::uint8_t id) {
  const std::uint8_t index = kRowOfId[id];
  return index == kNoRow ? nullptr : &table.rows[index];
}

/// Length of the largest payload in bytes.
constexpr std::size_t max_payload_bytes() {
  std::size_t max = 0;
  for (const Row& row : kRows) max = row.length > max ? row.length : max;
  return max;
}
inline constexpr std::size_t kMaxPayload = max_payload_bytes();

}  // namespace rosflight::link::mavlink
