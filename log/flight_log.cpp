// SPDX-License-Identifier: BSD-3-Clause
#include "log/flight_log.hpp"

#include <variant>

#include "log/flight_log_topics.hpp"
#include "log/schemas.hpp"
#include "log/utf8.hpp"

namespace rosflight::log {

static_assert(kTopics.size() <= 48, "raise FlightLog::kMaxTopics");

FlightLog::FlightLog(std::filesystem::path path, const Options& options, const TextMap& flight)
    : options_(options), writer_(std::move(path), options.mcap), fcu_boot_ns_(options.epoch_ns) {
  writer_.add_metadata("flight", flight);
}

void FlightLog::attach(std::string_view name, std::string_view media_type,
                       std::string_view contents) {
  writer_.attach(name, media_type, options_.epoch_ns, as_bytes(contents));
}

std::uint64_t FlightLog::stamp(hal::Time time) const {
  return options_.epoch_ns + static_cast<std::uint64_t>(time.count()) * 1000;
}

McapWriter::ChannelId FlightLog::channel(Topic topic) {
  const auto index = static_cast<std::size_t>(topic);
  if (channels_[index] != 0) return channels_[index];
  // Topics of one type share the schema of the first that came.
  McapWriter::SchemaId schema = 0;
  for (std::size_t k = 0; k < kTopics.size() && schema == 0; ++k) {
    if (kTopics[k].type == kTopics[index].type) schema = schemas_[k];
  }
  if (schema == 0) {
    schema = writer_.add_schema(kTopics[index].type, "ros2msg", schema_text(kTopics[index].type));
  }
  schemas_[index] = schema;
  channels_[index] = writer_.add_channel(kTopics[index].name, schema, "cdr");
  return channels_[index];
}

template <class Put>
void FlightLog::write(Topic topic, std::uint64_t log_time_ns, const Put& put) {
  cdr_.begin();
  put(cdr_);
  writer_.write(channel(topic), log_time_ns, log_time_ns, cdr_.bytes());
}

void FlightLog::write_truth(const sim::Truth& truth, const hal::OutputValues& outputs) {
  if (options_.truth_every == 0 || truth_calls_++ % options_.truth_every != 0) return;
  const std::uint64_t now = stamp(truth.time);
  const Header inertial{now, kInertialFrame};
  const Header body{now, kBodyFrame};
  write(Topic::kTruthState, now,
        [&](CdrWriter& out) { serialize_state(out, inertial, truth, options_.gravity_m_s2); });
  write(Topic::kTruthWind, now, [&](CdrWriter& out) {
    serialize_vector(out, inertial,
                     {truth.air.wind_N.x(), truth.air.wind_N.y(), truth.air.wind_N.z()});
  });
  write(Topic::kForcesAndMoments, now,
        [&](CdrWriter& out) { serialize_wrench(out, body, truth.wrench); });
  write(Topic::kPwmOutput, now, [&](CdrWriter& out) { serialize_pwm(out, body, outputs); });
  write(Topic::kTruthVehicle, now,
        [&](CdrWriter& out) { serialize_vehicle(out, body, truth, outputs); });
}

/// One overload per message: which topic, which stamp, which frame.
struct FlightLog::LinkVisitor {
  FlightLog& log;
  Direction direction;
  std::uint64_t now;

  template <class Message>
  void put(Topic topic, const Message& message, const Header& header) const {
    log.write(topic, now, [&](CdrWriter& out) { serialize(out, header, message); });
  }
  template <class Message>
  void put(Topic topic, const Message& message) const {
    put(topic, message, {now, {}});
  }
  template <class Message>
  void put_both_ways(Topic topic, const Message& message) const {
    log.write(topic, now, [&](CdrWriter& out) { serialize(out, {now, {}}, direction, message); });
  }

  void operator()(const std::monostate& /*none*/) const {}
  void operator()(const link::Heartbeat& m) const { put_both_ways(Topic::kHeartbeat, m); }
  void operator()(const link::TimeSync& m) const { put_both_ways(Topic::kTimeSync, m); }
  void operator()(const link::ParamRequestRead& m) const { put(Topic::kParamRequestRead, m); }
  void operator()(const link::ParamRequestList& m) const { put(Topic::kParamRequestList, m); }
  void operator()(const link::ParamSet& m) const { put(Topic::kParamSet, m); }
  void operator()(const link::OffboardControl& m) const { put(Topic::kCommand, m); }
  void operator()(const link::AuxCommand& m) const { put(Topic::kAuxCommand, m); }
  void operator()(const link::ExternalAttitude& m) const {
    put(Topic::kExternalAttitude, m, {now, kInertialFrame});
  }
  void operator()(const link::CommandRequest& m) const { put(Topic::kCommandRequest, m); }
  void operator()(const link::ParamValue& m) const { put(Topic::kParamValue, m); }
  void operator()(const link::CommandAck& m) const { put(Topic::kCommandAck, m); }
  void operator()(const link::MotorTest& m) const { put(Topic::kMotorTest, m); }
  void operator()(const link::ReportRequest& m) const { put(Topic::kReportRequest, m); }
  void operator()(const link::CheckResult& m) const { put(Topic::kCheckResult, m); }
  void operator()(const link::Counters& m) const { put(Topic::kCounters, m); }
  void operator()(const link::Mag& m) const { put(Topic::kMagnetometer, m, {now, kBodyFrame}); }
  void operator()(const link::Baro& m) const { put(Topic::kBaro, m); }
  void operator()(const link::DiffPressure& m) const { put(Topic::kAirspeed, m); }
  void operator()(const link::Range& m) const { put(Topic::kRange, m, {now, kBodyFrame}); }
  void operator()(const link::RcChannels& m) const {
    put(Topic::kRcRaw, m, {log.fcu_stamp_ms(m.time_boot_ms), {}});
  }
  void operator()(const link::OutputRaw& m) const {
    put(Topic::kOutputRaw, m, {log.fcu_stamp_ms(m.time_boot_ms), {}});
  }
  void operator()(const link::Status& m) const { put(Topic::kStatus, m); }
  void operator()(const link::Version& m) const { put(Topic::kVersion, m); }
  void operator()(const link::HardError& m) const { put(Topic::kHardError, m); }
  void operator()(const link::Gnss& m) const {
    put(Topic::kGnss, m, {log.fcu_stamp_us(m.time_boot_us), kInertialFrame});
  }
  void operator()(const link::BatteryStatus& m) const { put(Topic::kBattery, m); }

  void operator()(const link::Attitude& m) const {
    log.has_attitude_ = true;
    log.q_NB_ = m.q_NB;
    const Header header{log.fcu_stamp_ms(m.time_boot_ms), kInertialFrame};
    put(Topic::kAttitude, m, header);
    log.write(Topic::kAttitudeEuler, now,
              [&](CdrWriter& out) { serialize_vector(out, header, euler_angles(m.q_NB)); });
  }

  void operator()(const link::Imu& m) const {
    const Header header{log.fcu_stamp_us(m.time_boot_us), kBodyFrame};
    const auto* const attitude = log.has_attitude_ ? &log.q_NB_ : nullptr;
    log.write(Topic::kImu, now, [&](CdrWriter& out) { serialize_imu(out, header, m, attitude); });
    log.write(Topic::kImuTemperature, now, [&](CdrWriter& out) {
      serialize_temperature(out, header, static_cast<double>(m.temperature_K));
    });
  }

  void operator()(const link::StatusText& m) const {
    log.write(Topic::kTexts, now, [&](CdrWriter& out) {
      serialize_text(out, now, m.severity, "fcu", {m.text.data(), m.text.size()});
    });
  }
};

void FlightLog::write_link(Direction direction, hal::Time time, const link::Message& message,
                           Bytes raw_frame) {
  const std::uint64_t now = stamp(time);
  std::visit(LinkVisitor{*this, direction, now}, message);
  if (raw_frame.empty()) return;
  write(Topic::kRawFrame, now,
        [&](CdrWriter& out) { serialize(out, {now, {}}, direction, raw_frame); });
}

void FlightLog::write_setpoint(hal::Time time, const Setpoint& setpoint) {
  const std::uint64_t now = stamp(time);
  write(Topic::kSetpoint, now,
        [&](CdrWriter& out) { serialize(out, {now, kInertialFrame}, setpoint); });
}

void FlightLog::write_estimate(hal::Time time, const Estimate& estimate) {
  const std::uint64_t now = stamp(time);
  write(Topic::kEstimate, now,
        [&](CdrWriter& out) { serialize(out, {now, kInertialFrame}, estimate); });
}

void FlightLog::write_phase(hal::Time time, std::string_view name) {
  const std::uint64_t now = stamp(time);
  write(Topic::kPhase, now, [&](CdrWriter& out) { serialize_phase(out, {now, {}}, name); });
}

void FlightLog::write_event(hal::Time time, link::Severity severity, std::string_view source,
                            std::string_view text) {
  const std::uint64_t now = stamp(time);
  write(Topic::kTexts, now,
        [&](CdrWriter& out) { serialize_text(out, now, severity, source, text); });
}

void FlightLog::write_parameter(hal::Time time, std::string_view name, link::ParamType type,
                                link::ParamBits value) {
  const std::uint64_t now = stamp(time);
  write(Topic::kParameter, now,
        [&](CdrWriter& out) { serialize_parameter(out, {now, {}}, name, type, value); });
}

}  // namespace rosflight::log
