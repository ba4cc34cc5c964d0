// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/telemetry.hpp"

#include <algorithm>

namespace rosflight::core {
namespace {

constexpr std::uint8_t kOutputDecimation = 8;
constexpr int kParametersPerPass = 2;
/// Lists and texts leave this much of the transmit queue to the sensors.
constexpr std::size_t kRoomForStreams = 256;

std::uint32_t ms32(Time t) {
  return static_cast<std::uint32_t>(hal::to_ms(t));
}

std::uint16_t pulse_us(float fraction) {
  // In this order a NaN becomes 0.
  return static_cast<std::uint16_t>(
      std::min(std::max(0.0f, 1000.0f + 1000.0f * fraction), 65535.0f));
}

link::Gnss to_message(const hal::GnssSample& s) {
  return {s.unix_s,
          s.unix_ns,
          static_cast<std::uint8_t>(s.fix),
          s.satellites,
          s.latitude_deg,
          s.longitude_deg,
          s.height_msl_m,
          s.velocity_ned_m_s,
          s.horizontal_accuracy_m,
          s.vertical_accuracy_m,
          s.speed_accuracy_m_s,
          static_cast<std::uint64_t>(s.stamp.count())};
}

}  // namespace

void Telemetry::send(const link::Message& message, std::uint8_t qos) {
  link::Frame frame;
  if (codec_.encode(message, frame)) serial_.write(frame.bytes.data(), frame.size, qos);
}

void Telemetry::send_parameter(Param id, const Parameters& parameters) {
  const ParamRow& row = Parameters::row(id);
  send(link::ParamValue{row.name,
                        {parameters.bits(id)},
                        row.type,
                        static_cast<std::uint16_t>(kParamCount),
                        static_cast<std::uint16_t>(id)});
}

void Telemetry::send_ack(std::uint8_t command, bool success) {
  send(link::CommandAck{command, success});
}

void Telemetry::stream(Time now, const Measurements& m, const AttitudeEstimate& attitude,
                       const hal::OutputValues& outputs) {
  if (m.new_imu) {
    send(link::Imu{static_cast<std::uint64_t>(m.imu.stamp.count()), m.imu.accel_m_s2,
                   m.imu.gyro_rad_s, m.imu.temperature_K},
         hal::Serial::kUrgent);
    const Quaternion& q = attitude.q_NB;
    const Vector3& w = attitude.rates_rad_s;
    send(link::Attitude{ms32(m.imu.stamp), {q.w, q.x, q.y, q.z}, {w.x(), w.y(), w.z()}});
    stream_outputs(now, outputs);
  }
  if (m.new_diff_pressure) {
    send(link::DiffPressure{m.airspeed_m_s, m.diff_pressure.pressure_Pa,
                            m.diff_pressure.temperature_K});
  }
  if (m.new_baro) send(link::Baro{m.altitude_m, m.baro.pressure_Pa, m.baro.temperature_K});
  if (m.new_mag) send(link::Mag{m.mag.field_T});
  if (m.new_range) {
    send(link::Range{static_cast<std::uint8_t>(m.range.kind), m.range.range_m, m.range.max_m,
                     m.range.min_m});
  }
  if (m.new_battery) send(link::BatteryStatus{m.battery.voltage_V, m.battery.current_A});
  if (m.new_gnss) send(to_message(m.gnss));
}

void Telemetry::stream_outputs(Time now, const hal::OutputValues& outputs) {
  if (imu_count_ == 0) send(link::OutputRaw{static_cast<std::uint64_t>(hal::to_ms(now)), outputs});
  imu_count_ = static_cast<std::uint8_t>((imu_count_ + 1) % kOutputDecimation);
}

void Telemetry::send_rc(Time now, const hal::RcFrame& frame) {
  link::RcChannels message;
  message.time_boot_ms = ms32(now);
  const auto n = std::min<std::size_t>(frame.channel_count, message.pulse_us.size());
  for (std::size_t k = 0; k < n; ++k) message.pulse_us[k] = pulse_us(frame.channels[k]);
  message.count = static_cast<std::uint8_t>(n);
  send(message);
}

void Telemetry::heard_peer(Time now) {
  last_heard_ = now;
  connected_ = true;
  if (!crash_waiting_) return;
  crash_waiting_ = false;
  send(crash_);
}

void Telemetry::report_crash(const CrashRecord& record, bool rearmed) {
  crash_ = {record.error_word, record.pc(), record.fault_count, rearmed ? 1u : 0u};
  crash_waiting_ = true;
}

bool Telemetry::tick(Time now, bool fixed_wing) {
  if (now >= next_tenth_) {
    constexpr std::int64_t kTenth_us = 100'000;
    const std::int64_t tenth = now.count() / kTenth_us;
    const bool first_of_second =
        next_tenth_ == Time{0} || tenth / 10 != (next_tenth_.count() / kTenth_us - 1) / 10;
    next_tenth_ = Time{(tenth + 1) * kTenth_us};
    if (first_of_second) {
      send(link::Heartbeat{fixed_wing ? link::VehicleType::kFixedWing
                                      : link::VehicleType::kMultirotor});
    }
    if (connected_ && now - last_heard_ > kPeerSilence) connected_ = false;
    status_due_ = true;
  }
  const bool due = status_due_;
  status_due_ = false;
  return due;
}

void Telemetry::send_backlog(Parameters& parameters, Log& log) {
  const bool listing = next_listed_ < kParamCount;
  if (!listing && log.empty() && !parameters.has_unreported()) return;
  for (int k = 0; k < kParametersPerPass && serial_.writable() > kRoomForStreams; ++k) {
    Param id{};
    if (parameters.take_unreported(id)) {
      send_parameter(id, parameters);
    } else if (next_listed_ < kParamCount) {
      send_parameter(static_cast<Param>(next_listed_++), parameters);
    }
  }
  if (connected_ && !log.empty() && serial_.writable() > kRoomForStreams) send(log.pop());
}

}  // namespace rosflight::core
