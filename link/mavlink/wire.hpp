// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <mavlink_rosflight/rosflight/mavlink.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "link/messages.hpp"
#include "link/text.hpp"

/// Our structs to those of the generated headers and back, field by field; same order as
/// messages.hpp. Private to the codec.
namespace rosflight::link::mavlink {

inline constexpr std::uint8_t kDialectVersion = 2;  ///< <version> of rosflight.xml.

/// The 32 bits of a parameter travel in a float field without ever being a float.
inline void copy_bits(const ParamBits& from, float& to) {
  std::memcpy(&to, &from.bits, sizeof to);
}
inline void copy_bits(const float& from, ParamBits& to) {
  std::memcpy(&to.bits, &from, sizeof from);
}

/// Our struct as the generated one, field by field. Units are equal on both sides.
inline void pack(const Heartbeat& m, mavlink_heartbeat_t& w) {
  w = {0, static_cast<std::uint8_t>(m.type), 0, 0, 0, kDialectVersion};
}
/// The generated struct as ours.
inline void unpack(const mavlink_heartbeat_t& w, Heartbeat& m) {
  m.type = VehicleType{w.type};
}

inline void pack(const TimeSync& m, mavlink_timesync_t& w) {
  w = {m.tc1_ns, m.ts1_ns};
}
inline void unpack(const mavlink_timesync_t& w, TimeSync& m) {
  m = {w.tc1, w.ts1};
}

inline void pack(const ParamRequestRead& m, mavlink_param_request_read_t& w) {
  w.param_index = m.index;
  w.target_system = m.target_system;
  w.target_component = MAV_COMP_ID_ALL;
  copy_text<kParamNameLength>(m.name.data(), w.param_id);
}
inline void unpack(const mavlink_param_request_read_t& w, ParamRequestRead& m) {
  m.target_system = w.target_system;
  m.index = w.param_index;
  copy_text<kParamNameLength>(w.param_id, m.name.data());
}

inline void pack(const ParamRequestList& m, mavlink_param_request_list_t& w) {
  w = {m.target_system, MAV_COMP_ID_ALL};
}
inline void unpack(const mavlink_param_request_list_t& w, ParamRequestList& m) {
  m.target_system = w.target_system;
}

inline void pack(const ParamSet& m, mavlink_param_set_t& w) {
  copy_bits(m.value, w.param_value);
  w.target_system = m.target_system;
  w.target_component = MAV_COMP_ID_ALL;
  copy_text<kParamNameLength>(m.name.data(), w.param_id);
  w.param_type = m.type;
}
inline void unpack(const mavlink_param_set_t& w, ParamSet& m) {
  m.target_system = w.target_system;
  copy_text<kParamNameLength>(w.param_id, m.name.data());
  copy_bits(w.param_value, m.value);
  m.type = w.param_type;
}

inline void pack(const OffboardControl& m, mavlink_offboard_control_t& w) {
  std::memcpy(w.u, m.u.data(), sizeof w.u);
  w.ignore = m.ignore;
  w.mode = m.mode;
}
inline void unpack(const mavlink_offboard_control_t& w, OffboardControl& m) {
  m.mode = w.mode;
  m.ignore = w.ignore;
  std::memcpy(m.u.data(), w.u, sizeof w.u);
}

inline void pack(const AuxCommand& m, mavlink_rosflight_aux_cmd_t& w) {
  std::memcpy(w.aux_cmd_array, m.value.data(), sizeof w.aux_cmd_array);
  std::memcpy(w.type_array, m.type.data(), sizeof w.type_array);
}
inline void unpack(const mavlink_rosflight_aux_cmd_t& w, AuxCommand& m) {
  std::memcpy(m.type.data(), w.type_array, sizeof w.type_array);
  std::memcpy(m.value.data(), w.aux_cmd_array, sizeof w.aux_cmd_array);
}

inline void pack(const ExternalAttitude& m, mavlink_external_attitude_t& w) {
  w = {m.q_WB[0], m.q_WB[1], m.q_WB[2], m.q_WB[3]};
}
inline void unpack(const mavlink_external_attitude_t& w, ExternalAttitude& m) {
  m.q_WB = {w.qw, w.qx, w.qy, w.qz};
}

inline void pack(const CommandRequest& m, mavlink_rosflight_cmd_t& w) {
  w.command = m.command;
}
inline void unpack(const mavlink_rosflight_cmd_t& w, CommandRequest& m) {
  m.command = w.command;
}

inline void pack(const ParamValue& m, mavlink_param_value_t& w) {
  copy_bits(m.value, w.param_value);
  w.param_count = m.count;
  w.param_index = m.index;
  copy_text<kParamNameLength>(m.name.data(), w.param_id);
  w.param_type = static_cast<std::uint8_t>(m.type);
}
inline void unpack(const mavlink_param_value_t& w, ParamValue& m) {
  copy_text<kParamNameLength>(w.param_id, m.name.data());
  copy_bits(w.param_value, m.value);
  m.type = ParamType{w.param_type};
  m.count = w.param_count;
  m.index = w.param_index;
}

inline void pack(const CommandAck& m, mavlink_rosflight_cmd_ack_t& w) {
  w = {m.command, std::uint8_t{m.success}};
}
inline void unpack(const mavlink_rosflight_cmd_ack_t& w, CommandAck& m) {
  m = {w.command, w.success != ROSFLIGHT_CMD_FAILED};
}

inline void pack(const Attitude& m, mavlink_attitude_quaternion_t& w) {
  w = {m.time_boot_ms, m.q_WB[0],        m.q_WB[1],        m.q_WB[2],
       m.q_WB[3],      m.rates_rad_s[0], m.rates_rad_s[1], m.rates_rad_s[2]};
}
inline void unpack(const mavlink_attitude_quaternion_t& w, Attitude& m) {
  m.time_boot_ms = w.time_boot_ms;
  m.q_WB = {w.q1, w.q2, w.q3, w.q4};
  m.rates_rad_s = {w.rollspeed, w.pitchspeed, w.yawspeed};
}

inline void pack(const Imu& m, mavlink_small_imu_t& w) {
  w = {m.time_boot_us,  m.accel_m_s2[0], m.accel_m_s2[1], m.accel_m_s2[2],
       m.gyro_rad_s[0], m.gyro_rad_s[1], m.gyro_rad_s[2], m.temperature_K};
}
inline void unpack(const mavlink_small_imu_t& w, Imu& m) {
  m.time_boot_us = w.time_boot_us;
  m.accel_m_s2 = {w.xacc, w.yacc, w.zacc};
  m.gyro_rad_s = {w.xgyro, w.ygyro, w.zgyro};
  m.temperature_K = w.temperature;
}

inline void pack(const Mag& m, mavlink_small_mag_t& w) {
  w = {m.field_T[0], m.field_T[1], m.field_T[2]};
}
inline void unpack(const mavlink_small_mag_t& w, Mag& m) {
  m.field_T = {w.xmag, w.ymag, w.zmag};
}

inline void pack(const Baro& m, mavlink_small_baro_t& w) {
  w = {m.altitude_m, m.pressure_Pa, m.temperature_K};
}
inline void unpack(const mavlink_small_baro_t& w, Baro& m) {
  m = {w.altitude, w.pressure, w.temperature};
}

inline void pack(const DiffPressure& m, mavlink_diff_pressure_t& w) {
  w = {m.airspeed_m_s, m.pressure_Pa, m.temperature_K};
}
inline void unpack(const mavlink_diff_pressure_t& w, DiffPressure& m) {
  m = {w.velocity, w.diff_pressure, w.temperature};
}

inline void pack(const Range& m, mavlink_small_range_t& w) {
  w = {m.range_m, m.max_m, m.min_m, m.kind};
}
inline void unpack(const mavlink_small_range_t& w, Range& m) {
  m = {w.type, w.range, w.max_range, w.min_range};
}

// The eighteen pulses are eighteen fields on the wire, side by side.
inline constexpr std::size_t kPulseOffset = offsetof(mavlink_rc_channels_t, chan1_raw);
static_assert(offsetof(mavlink_rc_channels_t, chancount) ==
              kPulseOffset + kRcChannels * sizeof(std::uint16_t));

inline void pack(const RcChannels& m, mavlink_rc_channels_t& w) {
  w.time_boot_ms = m.time_boot_ms;
  std::memcpy(reinterpret_cast<std::uint8_t*>(&w) + kPulseOffset, m.pulse_us.data(),
              sizeof m.pulse_us);
  w.chancount = m.count;
  w.rssi = m.rssi;
}
inline void unpack(const mavlink_rc_channels_t& w, RcChannels& m) {
  m.time_boot_ms = w.time_boot_ms;
  std::memcpy(m.pulse_us.data(), reinterpret_cast<const std::uint8_t*>(&w) + kPulseOffset,
              sizeof m.pulse_us);
  m.count = w.chancount;
  m.rssi = w.rssi;
}

inline void pack(const OutputRaw& m, mavlink_rosflight_output_raw_t& w) {
  w.stamp = m.time_boot_ms;
  std::memcpy(w.values, m.values.data(), sizeof w.values);
}
inline void unpack(const mavlink_rosflight_output_raw_t& w, OutputRaw& m) {
  m.time_boot_ms = w.stamp;
  std::memcpy(m.values.data(), w.values, sizeof w.values);
}

inline void pack(const Status& m, mavlink_rosflight_status_t& w) {
  w.rc_override = m.rc_override;
  w.num_errors = m.sensor_errors;
  w.loop_time_us = m.loop_time_us;
  w.armed = m.armed;
  w.failsafe = m.failsafe;
  w.offboard = m.offboard;
  w.error_code = m.error_code;
  w.control_mode = m.control_mode;
}
inline void unpack(const mavlink_rosflight_status_t& w, Status& m) {
  m.armed = w.armed != 0;
  m.failsafe = w.failsafe != 0;
  m.offboard = w.offboard != 0;
  m.rc_override = w.rc_override;
  m.error_code = w.error_code;
  m.control_mode = w.control_mode;
  m.sensor_errors = w.num_errors;
  m.loop_time_us = w.loop_time_us;
}

inline void pack(const Version& m, mavlink_rosflight_version_t& w) {
  copy_terminated<kTextLength>(m.text.data(), w.version);
}
inline void unpack(const mavlink_rosflight_version_t& w, Version& m) {
  copy_terminated<kTextLength>(w.version, m.text.data());
}

inline void pack(const HardError& m, mavlink_rosflight_hard_error_t& w) {
  w = {m.error_code, m.pc, m.reset_count, m.rearm};
}
inline void unpack(const mavlink_rosflight_hard_error_t& w, HardError& m) {
  m = {w.error_code, w.pc, w.reset_count, w.doRearm};
}

inline void pack(const Gnss& m, mavlink_rosflight_gnss_t& w) {
  w.seconds = m.unix_s;
  w.lat = m.latitude_deg;
  w.lon = m.longitude_deg;
  w.rosflight_timestamp = m.time_boot_us;
  w.nanos = m.unix_ns;
  w.height = m.height_msl_m;
  w.vel_n = m.velocity_ned_m_s[0];
  w.vel_e = m.velocity_ned_m_s[1];
  w.vel_d = m.velocity_ned_m_s[2];
  w.h_acc = m.horizontal_accuracy_m;
  w.v_acc = m.vertical_accuracy_m;
  w.s_acc = m.speed_accuracy_m_s;
  w.fix_type = m.fix;
  w.num_sat = m.satellites;
}
inline void unpack(const mavlink_rosflight_gnss_t& w, Gnss& m) {
  m.unix_s = w.seconds;
  m.unix_ns = w.nanos;
  m.fix = w.fix_type;
  m.satellites = w.num_sat;
  m.latitude_deg = w.lat;
  m.longitude_deg = w.lon;
  m.height_msl_m = w.height;
  m.velocity_ned_m_s = {w.vel_n, w.vel_e, w.vel_d};
  m.horizontal_accuracy_m = w.h_acc;
  m.vertical_accuracy_m = w.v_acc;
  m.speed_accuracy_m_s = w.s_acc;
  m.time_boot_us = w.rosflight_timestamp;
}

inline void pack(const BatteryStatus& m, mavlink_rosflight_battery_status_t& w) {
  w = {m.voltage_V, m.current_A};
}
inline void unpack(const mavlink_rosflight_battery_status_t& w, BatteryStatus& m) {
  m = {w.battery_voltage, w.battery_current};
}

inline void pack(const StatusText& m, mavlink_statustext_t& w) {
  w.severity = static_cast<std::uint8_t>(m.severity);
  copy_terminated<kTextLength>(m.text.data(), w.text);
}
inline void unpack(const mavlink_statustext_t& w, StatusText& m) {
  m.severity = Severity{w.severity};
  copy_terminated<kTextLength>(w.text, m.text.data());
}

inline void pack(const MotorTest& m, mavlink_motor_test_t& w) {
  w = {m.value, m.target_system, m.motor};
}
inline void unpack(const mavlink_motor_test_t& w, MotorTest& m) {
  m = {w.target_system, w.motor, w.value};
}

inline void pack(const ReportRequest& m, mavlink_report_request_t& w) {
  w = {m.target_system, m.kind};
}
inline void unpack(const mavlink_report_request_t& w, ReportRequest& m) {
  m = {w.target_system, w.kind};
}

inline void pack(const CheckResult& m, mavlink_check_result_t& w) {
  w.index = m.index;
  w.count = m.count;
  w.result = m.result;
  copy_text<kCheckNameLength>(m.name.data(), w.name);
  copy_terminated<kTextLength>(m.reason.data(), w.reason);
}
inline void unpack(const mavlink_check_result_t& w, CheckResult& m) {
  m.index = w.index;
  m.count = w.count;
  m.result = w.result;
  copy_text<kCheckNameLength>(w.name, m.name.data());
  copy_terminated<kTextLength>(w.reason, m.reason.data());
}

inline void pack(const Counters& m, mavlink_counters_t& w) {
  w.longest_pass = m.longest_pass_us;
  w.pass_budget = m.pass_budget_us;
  w.passes_over_budget = m.passes_over_budget;
  w.passes = m.passes;
  w.frames_dropped = m.frames_dropped;
  w.tx_dropped = m.tx_dropped;
  w.texts_lost = m.texts_lost;
  std::memcpy(w.imu_jitter, m.imu_jitter.data(), sizeof w.imu_jitter);
  std::memcpy(w.rejected, m.rejected.data(), sizeof w.rejected);
}
inline void unpack(const mavlink_counters_t& w, Counters& m) {
  m.longest_pass_us = w.longest_pass;
  m.pass_budget_us = w.pass_budget;
  m.passes_over_budget = w.passes_over_budget;
  m.passes = w.passes;
  m.frames_dropped = w.frames_dropped;
  m.tx_dropped = w.tx_dropped;
  m.texts_lost = w.texts_lost;
  std::memcpy(m.imu_jitter.data(), w.imu_jitter, sizeof w.imu_jitter);
  std::memcpy(m.rejected.data(), w.rejected, sizeof w.rejected);
}

inline void pack(const RecordRequest& m, mavlink_record_request_t& w) {
  w.target_system = m.target_system;
  w.first = m.first;
  w.count = m.count;
}
inline void unpack(const mavlink_record_request_t& w, RecordRequest& m) {
  m = {w.target_system, w.first, w.count};
}

inline void pack(const RecordPart& m, mavlink_record_part_t& w) {
  w.number = m.number;
  w.oldest = m.oldest;
  w.newest = m.newest;
  w.part = m.part;
  std::memcpy(w.bytes, m.bytes.data(), sizeof w.bytes);
}
inline void unpack(const mavlink_record_part_t& w, RecordPart& m) {
  m.number = w.number;
  m.oldest = w.oldest;
  m.newest = w.newest;
  m.part = w.part;
  std::memcpy(m.bytes.data(), w.bytes, sizeof w.bytes);
}

}  // namespace rosflight::link::mavlink
