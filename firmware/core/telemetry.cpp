// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/telemetry.hpp"

#include <algorithm>

namespace rosflight::core {
namespace {

constexpr std::uint8_t kOutputDecimation = 8;
constexpr int kParametersPerPass = 2;
constexpr std::uint32_t kMinShare = 600;    // bytes per second
constexpr std::uint32_t kAssumed = 48'000;  // bytes per second, until it has been measured
constexpr std::uint32_t kSlowLine = 2'000;  // bytes per second
constexpr std::size_t kRoomForOthers = 128;

/// The class of each message; all others are ordinary.
constexpr auto make_urgencies() {
  std::array<std::uint8_t, std::variant_size_v<link::Message>> qos{};
  for (std::uint8_t& one : qos) one = hal::Serial::kOrdinary;
  qos[link::Message(std::in_place_type<link::Imu>).index()] = hal::Serial::kUrgent;
  qos[link::Message(std::in_place_type<link::TimeSync>).index()] = hal::Serial::kTimely;
  return qos;
}
constexpr auto kUrgency = make_urgencies();

/// Bytes per second of a line that samples may use.
constexpr std::uint32_t budget(std::uint32_t line) {
  const std::uint32_t share = std::max(line / 4, kMinShare);
  return line > share ? line - share : 1;
}

/// Lists and texts leave this part of the transmit queue to the sensors.
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

/// @returns the size of the frame in bytes, accepted or not.
std::size_t Telemetry::put(const link::Message& message) {
  link::Frame frame;
  if (codec_.encode(message, frame) &&
      !serial_.write(frame.bytes.data(), frame.size, kUrgency[message.index()])) {
    ++dropped_;
  }
  return frame.size;
}

void Telemetry::send(const link::Message& message) {
  static_cast<void>(put(message));
}

// ---- samples, decimated to the capacity of the line

void Telemetry::set_line(std::uint32_t bytes_per_s) {
  line_bytes_per_s_ = bytes_per_s;
  const std::uint32_t every = (kAssumed - 1) / budget(bytes_per_s) + 1;
  every_.fill(every);
  // The kinds alternate, so that they are not all sent in one pass.
  for (std::size_t k = 0; k < waited_.size(); ++k) {
    waited_[k] = static_cast<std::uint16_t>(k * every / waited_.size());
  }
}

bool Telemetry::turn_of_many(Stream kind) {
  offered_[pace(kind)] += bytes_[kind];
  ++waited_[kind];
  return waited_[kind] >= every_[pace(kind)] && serial_.writable() >= kRoomForOthers + bytes_[kind];
}

[[gnu::noinline]] void Telemetry::send_sample(Stream kind, const link::Message& message) {
  const std::size_t bytes = put(message);
  bytes_[kind] = static_cast<std::uint8_t>(bytes);
  if (every_[pace(kind)] == 1) {
    offered_[pace(kind)] += static_cast<std::uint32_t>(bytes);
  } else {
    waited_[kind] = 0;
  }
}

[[gnu::noinline]] Telemetry::PerPace Telemetry::needed(std::uint32_t carried) const {
  std::uint32_t fast = offered_[kFast];
  const std::uint32_t slow = offered_[kSlow];
  const bool alike = slow > carried / 4;
  if (alike) {
    fast += slow;
  } else {
    carried -= slow;
  }
  const std::uint32_t every = (std::max<std::uint32_t>(fast, 1) - 1) / carried + 1;
  return {every, alike ? every : 1};
}

/// Once a second.
void Telemetry::measure(Time now) {
  const std::uint32_t ms = ms32(now - measured_);
  constexpr std::uint32_t kMinMeasured_ms = 500;  // the first second may be cut short
  if (serial_.carries_all()) {
    every_.fill(1);
  } else if (line_bytes_per_s_ > 0 && ms >= kMinMeasured_ms && measured_ > Time{0}) {
    for (std::uint32_t& bytes : offered_) {
      bytes = bytes / ms * 1000 + bytes % ms * 1000 / ms;
    }
    const std::uint32_t carried = budget(line_bytes_per_s_);
    const PerPace now_needed = needed(carried);
    const PerPace with_spare = needed(carried - carried / 11);
    for (std::size_t k = 0; k < kPaces; ++k) {
      every_[k] = std::max(now_needed[k], std::min(every_[k], with_spare[k]));
    }
  }
  measured_ = now;
  offered_ = {};
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

void Telemetry::stream(const Measurements& m, const AttitudeEstimate& attitude) {
  room_ = m.new_imu && !m.new_aid ? 1 : (m.new_imu ? 0 : kMessagesWithoutImu);
  if (m.new_imu) {
    if (turn(kImu)) {
      send_sample(kImu, link::Imu{static_cast<std::uint64_t>(m.imu.stamp.count()), m.imu.accel_m_s2,
                                  m.imu.gyro_rad_s, m.imu.temperature_K});
    }
    if (turn(kAttitude)) {
      const Quaternion& q = attitude.q_WB;
      const Vector3& w = attitude.rates_rad_s;
      send_sample(kAttitude,
                  link::Attitude{ms32(m.imu.stamp), {q.w, q.x, q.y, q.z}, {w.x(), w.y(), w.z()}});
    }
    if (imu_count_ == 0 && turn(kOutputs)) outputs_due_ = true;
    imu_count_ = static_cast<std::uint8_t>((imu_count_ + 1) % kOutputDecimation);
  }
  if (!m.new_aid) return;
  if (m.new_diff_pressure && turn(kDiffPressure)) {
    send_sample(kDiffPressure, link::DiffPressure{m.airspeed_m_s, m.diff_pressure.pressure_Pa,
                                                  m.diff_pressure.temperature_K});
  }
  if (m.new_baro && turn(kBaro)) {
    send_sample(kBaro, link::Baro{m.altitude_m, m.baro.pressure_Pa, m.baro.temperature_K});
  }
  if (m.new_mag && turn(kMag)) send_sample(kMag, link::Mag{m.mag.field_T});
  if (m.new_range && turn(kRange)) {
    send_sample(kRange, link::Range{static_cast<std::uint8_t>(m.range.kind), m.range.range_m,
                                    m.range.max_m, m.range.min_m});
  }
  if (m.new_battery && turn(kBattery)) {
    send_sample(kBattery, link::BatteryStatus{m.battery.voltage_V, m.battery.current_A});
  }
  if (m.new_gnss && turn(kGnss)) send_sample(kGnss, to_message(m.gnss));
}

void Telemetry::send_outputs(Time now, const hal::OutputValues& outputs) {
  outputs_due_ = false;
  send_sample(kOutputs, link::OutputRaw{static_cast<std::uint64_t>(hal::to_ms(now)), outputs});
}

void Telemetry::send_rc(Time now, const hal::RcFrame& frame) {
  rc_due_ = false;
  link::RcChannels message;
  message.time_boot_ms = ms32(now);
  const auto n = std::min<std::size_t>(frame.channel_count, message.pulse_us.size());
  for (std::size_t k = 0; k < n; ++k) message.pulse_us[k] = pulse_us(frame.channels[k]);
  message.count = static_cast<std::uint8_t>(n);
  message.rssi = frame.rssi;
  send_sample(kRc, message);
}

void Telemetry::note_peer_frame(Time now) {
  last_peer_frame_ = now;
  connected_ = true;
  if (!crash_waiting_) return;
  crash_waiting_ = false;
  send(crash_);
}

void Telemetry::report_crash(const CrashRecord& record, bool rearmed) {
  crash_ = {record.error_word, record.pc(), record.fault_count, rearmed ? 1u : 0u};
  crash_waiting_ = true;
}

void Telemetry::tenth(Time now, bool fixed_wing) {
  constexpr std::uint16_t kTenth_ms = 100;
  constexpr std::uint32_t kTenths = 10;
  const std::int64_t tenths = hal::quotient(hal::to_ms(now), kTenth_ms);
  const auto tenth = static_cast<std::uint32_t>(tenths);  // starts again after 13 years
  const bool first_of_second = next_tenth_ == Time{0} || tenth / kTenths != tenth_ / kTenths;
  tenth_ = tenth;
  next_tenth_ = hal::milliseconds((tenths + 1) * kTenth_ms);
  if (first_of_second) {
    measure(now);
    send(link::Heartbeat{fixed_wing ? link::VehicleType::kFixedWing
                                    : link::VehicleType::kMultirotor});
  }
  if (connected_ && now - last_peer_frame_ > kPeerSilence) connected_ = false;
  const bool slow = line_bytes_per_s_ > 0 && line_bytes_per_s_ < kSlowLine;
  if (!slow || tenth % 5 == 0) status_due_ = true;
}

bool Telemetry::has_room() const {
  return serial_.writable() > kRoomForStreams;
}

/// The kinds alternate, so that none delays another.
void Telemetry::send_waiting(Time now, const Waiting& w, Parameters& parameters, Log& log) {
  if (room_ == 0 && ++passed_over_ < kMaxPassedOver) return;
  passed_over_ = 0;
  int left = std::max<int>(room_, 1);
  constexpr int kKinds = 4;
  for (int k = 0; k < kKinds && left > 0; ++k) {
    next_waiting_ = static_cast<std::uint8_t>((next_waiting_ + 1) % kKinds);
    switch (next_waiting_) {
      case 0:
        if (outputs_due_) send_outputs(now, w.outputs), --left;
        break;
      case 1:
        if (rc_due_) send_rc(now, w.rc), --left;
        break;
      case 2:
        left -= send_parameters(parameters, left);
        break;
      default:
        if (connected_ && !log.empty() && has_room()) send(log.pop()), --left;
        break;
    }
  }
}

/// @returns the number sent.
int Telemetry::send_parameters(Parameters& parameters, int max_count) {
  int sent = 0;
  while (sent < std::min(max_count, kParametersPerPass) && has_room()) {
    Param id{};
    if (parameters.take_unreported(id)) {
      send_parameter(id, parameters);
    } else if (next_listed_ < kParamCount) {
      send_parameter(static_cast<Param>(next_listed_++), parameters);
    } else {
      break;
    }
    ++sent;
  }
  return sent;
}

}  // namespace rosflight::core
