// SPDX-License-Identifier: BSD-3-Clause
#include "log/flight_log.hpp"

#include <utility>
#include <variant>

#include "log/flight_log_topics.hpp"
#include "messages/board_inputs.hpp"
#include "messages/link.hpp"
#include "messages/simulation.hpp"
#include "messages/utf8.hpp"
#include "messages/world_sensors.hpp"

namespace rosflight::log {

using messages::to_message;

namespace {

messages::std_msgs::Header header(std::uint64_t stamp_ns, std::string_view frame = kBodyFrame) {
  return {messages::stamp_of(stamp_ns), std::string(frame)};
}

}  // namespace

static_assert(kTopics.size() <= 56, "raise FlightLog::kMaxTopics");

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
  const TopicType& kind = kTopics[index];
  const McapWriter::SchemaId schema = schema_of(kind.type, kind.schema());
  channels_[index] = writer_.add_channel(kind.name, schema, "cdr");
  return channels_[index];
}

/// Topics of one type share the schema of the first that came.
McapWriter::SchemaId FlightLog::schema_of(std::string_view type, std::string_view text) {
  McapWriter::SchemaId& schema = schemas_[type];
  if (schema == 0) schema = writer_.add_schema(type, "ros2msg", text);
  return schema;
}

template <Topic kTopic>
bool FlightLog::due(std::uint64_t now) {
  constexpr auto kIndex = static_cast<std::size_t>(kTopic);
  constexpr Thinning kThinning = kTopics[kIndex].thinning;
  const std::uint64_t interval_ns =
      1'000'000U *
      std::uint64_t{options_.detail == Detail::kFull ? kThinning.full_ms : kThinning.plot_ms};
  if (interval_ns == 0) return true;
  std::uint64_t& next_ns = next_due_ns_[kIndex];
  if (now < next_ns) return false;
  next_ns = (now / interval_ns + 1) * interval_ns;
  return true;
}

template <Topic kTopic, class Message>
void FlightLog::write(std::uint64_t log_time_ns, const Message& message) {
  static_assert(kTopics[static_cast<std::size_t>(kTopic)].type == Message::kName);
  cdr_.begin();
  serialize(cdr_, message);
  latest_ns_ = std::max(latest_ns_, log_time_ns);
  writer_.write(channel(kTopic), log_time_ns, log_time_ns, cdr_.bytes());
  for (LogObserver* observer : options_.observers)
    observer->on_logged(kTopic, log_time_ns, cdr_.bytes());
}

template <Topic kTopic, class Message>
void FlightLog::write(std::uint64_t log_time_ns, messages::std_msgs::Header header,
                      Message&& message) {
  message.header = std::move(header);
  write<kTopic>(log_time_ns, message);
}

void FlightLog::write_truth(const sim::Truth& truth, const hal::OutputValues& outputs) {
  const std::uint64_t now = stamp(truth.time);
  if (!due<Topic::kTruthState>(now)) return;  // The others are as rare or rarer.
  const auto inertial = header(now, kInertialFrame);
  const auto body = header(now, kBodyFrame);
  write<Topic::kTruthState>(now, inertial, to_message(truth, options_.gravity_m_s2));
  if (due<Topic::kTruthWind>(now))
    write<Topic::kTruthWind>(now, inertial, messages::wind_message(truth.air.wind_W));
  write<Topic::kForcesAndMoments>(now, body, to_message(truth.wrench));
  if (due<Topic::kPwmOutput>(now)) write<Topic::kPwmOutput>(now, body, to_message(outputs));
  messages::fill_vehicle(truth, outputs, vehicle_);
  write<Topic::kTruthVehicle>(now, body, vehicle_);
  write_motion(now, truth.body);
}

void FlightLog::write_motion(std::uint64_t now, const sim::BodyState& body) {
  const auto at = messages::stamp_of(now);
  if (due<Topic::kTf>(now)) {
    messages::fill_transform(at, body, transform_);
    write<Topic::kTf>(now, transform_);
  }
  if (due<Topic::kPose>(now)) write<Topic::kPose>(now, messages::pose_message(at, body));
  if (due<Topic::kOdometry>(now))
    write<Topic::kOdometry>(now, messages::odometry_message(at, body));
}

void FlightLog::write_description(hal::Time time, std::string_view urdf) {
  const std::uint64_t now = stamp(time);
  write<Topic::kTfStatic>(now, messages::fixed_transforms(messages::stamp_of(now)));
  write<Topic::kRobotDescription>(now, messages::std_msgs::String{std::string(urdf)});
}

void FlightLog::write_world_sample(hal::Time time, const std::string& name,
                                   const sim::WorldSample& sample) {
  const std::uint64_t now = stamp(time);
  const std::uint64_t measured = stamp(messages::measured_at(sample));
  latest_ns_ = std::max(latest_ns_, now);
  const auto put = [&]<class Message>(const std::string& topic, const Message& message) {
    McapWriter::ChannelId& id = world_channels_[topic];
    if (id == 0)
      id = writer_.add_channel("/" + topic, schema_of(Message::kName, Message::schema()), "cdr");
    cdr_.begin();
    serialize(cdr_, message);
    writer_.write(id, now, measured, cdr_.bytes());
  };
  messages::put_sample(messages::stamp_of(measured), name, sample, put);
}

void FlightLog::write_sensor_frames(hal::Time time, const std::string& name,
                                    const sim::Vector3& position_B, const sim::Matrix3& R_BS) {
  const std::uint64_t now = stamp(time);
  write<Topic::kTfStatic>(now,
                          messages::sensor_frames(messages::stamp_of(now), name, position_B, R_BS));
}

void FlightLog::write_path(hal::Time time, std::span<const std::array<double, 3>> points_W) {
  const std::uint64_t now = stamp(time);
  write<Topic::kPath>(now, messages::path_message(messages::stamp_of(now), points_W));
}

/// One overload per message: which topic, which stamp, which frame.
struct FlightLog::LinkVisitor {
  FlightLog& log;
  Direction direction;
  std::uint64_t now;

  template <Topic kTopic, class Message>
  void put(const Message& message, messages::std_msgs::Header header) const {
    if (log.due<kTopic>(now)) log.write<kTopic>(now, std::move(header), to_message(message));
  }
  template <Topic kTopic, class Message>
  void put(const Message& message, std::string_view frame = kBodyFrame) const {
    put<kTopic>(message, header(now, frame));
  }
  template <Topic kTopic, class Message>
  void put_both_ways(const Message& message) const {
    auto out = to_message(message);
    out.direction = static_cast<std::uint8_t>(direction);
    log.write<kTopic>(now, header(now), out);
  }

  void operator()(const std::monostate& /*none*/) const {}
  void operator()(const link::Heartbeat& m) const { put_both_ways<Topic::kHeartbeat>(m); }
  void operator()(const link::TimeSync& m) const { put_both_ways<Topic::kTimeSync>(m); }
  void operator()(const link::ParamRequestRead& m) const { put<Topic::kParamRequestRead>(m); }
  void operator()(const link::ParamRequestList& m) const { put<Topic::kParamRequestList>(m); }
  void operator()(const link::ParamSet& m) const { put<Topic::kParamSet>(m); }
  void operator()(const link::OffboardControl& m) const { put<Topic::kCommand>(m); }
  void operator()(const link::AuxCommand& m) const { put<Topic::kAuxCommand>(m); }
  void operator()(const link::ExternalAttitude& m) const {
    put<Topic::kExternalAttitude>(m, kInertialFrame);
  }
  void operator()(const link::CommandRequest& m) const { put<Topic::kCommandRequest>(m); }
  void operator()(const link::ParamValue& m) const { put<Topic::kParamValue>(m); }
  void operator()(const link::CommandAck& m) const { put<Topic::kCommandAck>(m); }
  void operator()(const link::MotorTest& m) const { put<Topic::kMotorTest>(m); }
  void operator()(const link::ReportRequest& m) const { put<Topic::kReportRequest>(m); }
  void operator()(const link::CheckResult& m) const { put<Topic::kCheckResult>(m); }
  void operator()(const link::Counters& m) const { put<Topic::kCounters>(m); }
  // A record read from a board is a file of its own.
  void operator()(const link::RecordRequest& /*m*/) const {}
  void operator()(const link::RecordPart& /*m*/) const {}
  void operator()(const link::Mag& m) const { put<Topic::kMagnetometer>(m, kBodyFrame); }
  void operator()(const link::Baro& m) const { put<Topic::kBaro>(m); }
  void operator()(const link::DiffPressure& m) const { put<Topic::kAirspeed>(m); }
  void operator()(const link::Range& m) const { put<Topic::kRange>(m, kBodyFrame); }
  void operator()(const link::RcChannels& m) const {
    put<Topic::kRcRaw>(m, header(log.fcu_stamp_ms(m.time_boot_ms)));
  }
  void operator()(const link::OutputRaw& m) const {
    put<Topic::kOutputRaw>(m, header(log.fcu_stamp_ms(m.time_boot_ms)));
  }
  void operator()(const link::Status& m) const { put<Topic::kStatus>(m); }
  void operator()(const link::Version& m) const { log.write<Topic::kVersion>(now, to_message(m)); }
  void operator()(const link::HardError& m) const { put<Topic::kHardError>(m); }
  void operator()(const link::Gnss& m) const {
    const auto sampled = header(log.fcu_stamp_us(m.time_boot_us), kInertialFrame);
    put<Topic::kGnss>(m, sampled);
    log.write<Topic::kFix>(now, messages::fix_message(sampled.stamp, m));
  }
  void operator()(const link::BatteryStatus& m) const { put<Topic::kBattery>(m); }

  void operator()(const link::Attitude& m) const {
    log.attitude_ = m;
    const auto sampled = header(log.fcu_stamp_ms(m.time_boot_ms), kInertialFrame);
    put<Topic::kAttitude>(m, sampled);
    if (log.due<Topic::kAttitudeEuler>(now))
      log.write<Topic::kAttitudeEuler>(now, sampled, messages::euler_message(m));
  }

  void operator()(const link::Imu& m) const {
    const auto sampled = header(log.fcu_stamp_us(m.time_boot_us), kBodyFrame);
    log.write<Topic::kImu>(now, sampled,
                           log.attitude_ ? to_message(m, *log.attitude_) : to_message(m));
    if (!log.due<Topic::kImuTemperature>(now)) return;
    log.write<Topic::kImuTemperature>(now, sampled, messages::imu_temperature(m));
  }

  void operator()(const link::StatusText& m) const {
    log.write_text(now, m.severity, "fcu", {m.text.data(), m.text.size()});
  }
};

void FlightLog::write_link(Direction direction, hal::Time time, const link::Message& message,
                           Bytes raw_frame) {
  const std::uint64_t now = stamp(time);
  std::visit(LinkVisitor{*this, direction, now}, message);
  if (raw_frame.empty()) return;
  // One message for many frames: each message costs 50 bytes beside its contents, most of a frame's own size.
  constexpr std::uint64_t kInterval_ns = 50'000'000;
  if (now - raw_start_ns_ >= kInterval_ns) write_raw_frames(now);
  if (raw_frames_.length.empty()) raw_start_ns_ = now;
  raw_frames_.delay_us.push_back(static_cast<std::uint32_t>((now - raw_start_ns_) / 1000));
  raw_frames_.direction.push_back(static_cast<std::uint8_t>(direction));
  raw_frames_.length.push_back(static_cast<std::uint16_t>(raw_frame.size()));
  raw_frames_.data.insert(raw_frames_.data.end(), raw_frame.begin(), raw_frame.end());
}

void FlightLog::write_raw_frames(std::uint64_t now) {
  if (raw_frames_.length.empty()) return;
  write<Topic::kRawFrames>(now, header(raw_start_ns_), raw_frames_);
  raw_frames_.delay_us.clear();
  raw_frames_.direction.clear();
  raw_frames_.length.clear();
  raw_frames_.data.clear();
}

std::uint32_t FlightLog::inputs_delay_us(std::uint64_t now) {
  constexpr std::uint64_t kInterval_ns = 500'000'000;
  if (now - inputs_start_ns_ >= kInterval_ns) write_inputs(now);
  if (inputs_.kind.empty()) inputs_start_ns_ = inputs_last_ns_ = now;
  const std::uint64_t before_ns = std::exchange(inputs_last_ns_, now);
  return static_cast<std::uint32_t>((now - before_ns) / 1000);
}

void FlightLog::write_inputs(hal::Time time, const sim::SensorSamples& samples,
                             const hal::RcFrame* receiver) {
  const auto& s = samples;
  const bool any = s.has_imu || s.has_mag || s.has_baro || s.has_diff_pressure || s.has_range ||
                   s.has_gnss || s.has_battery || receiver != nullptr;
  if (options_.detail != Detail::kFull || !any) return;
  messages::append(samples, receiver, time, inputs_delay_us(stamp(time)), inputs_);
}

void FlightLog::write_inputs(hal::Time time, Bytes read) {
  if (options_.detail != Detail::kFull) return;
  messages::append(read, inputs_delay_us(stamp(time)), inputs_);
}

void FlightLog::write_inputs(std::uint64_t now) {
  if (inputs_.kind.empty()) return;
  write<Topic::kBoardInputs>(now, header(inputs_start_ns_), inputs_);
  inputs_ = {};
}

LogSummary FlightLog::close() {
  write_inputs(latest_ns_);
  write_raw_frames(latest_ns_);
  return writer_.close();
}

void FlightLog::write_setpoint(hal::Time time,
                               messages::roscopter_msgs::TrajectoryCommand setpoint) {
  const std::uint64_t now = stamp(time);
  if (!due<Topic::kSetpoint>(now)) return;
  write<Topic::kSetpoint>(now, header(now, kInertialFrame), setpoint);
}

void FlightLog::write_estimate(hal::Time time, messages::rosflight_log_msgs::Estimate estimate) {
  const std::uint64_t now = stamp(time);
  if (due<Topic::kEstimateOdometry>(now)) {
    write<Topic::kEstimateOdometry>(now,
                                    messages::odometry_message(messages::stamp_of(now), estimate));
  }
  if (due<Topic::kEstimate>(now))
    write<Topic::kEstimate>(now, header(now, kInertialFrame), estimate);
}

void FlightLog::write_settings(hal::Time time, std::string_view yaml) {
  write<Topic::kSettings>(stamp(time), messages::std_msgs::String{messages::clean_utf8(yaml)});
}

void FlightLog::write_phase(hal::Time time, std::string_view name) {
  const std::uint64_t now = stamp(time);
  write<Topic::kPhase>(
      now, messages::rosflight_log_msgs::Phase{header(now), messages::clean_utf8(name)});
}

void FlightLog::write_text(std::uint64_t now, link::Severity severity, std::string_view source,
                           std::string_view text) {
  auto message = to_message(severity, source, text);
  message.stamp = messages::stamp_of(now);
  write<Topic::kTexts>(now, message);
}

void FlightLog::write_event(hal::Time time, link::Severity severity, std::string_view source,
                            std::string_view text) {
  write_text(stamp(time), severity, source, text);
}

void FlightLog::write_parameter(hal::Time time, std::string_view name, link::ParamType type,
                                link::ParamBits value) {
  const std::uint64_t now = stamp(time);
  write<Topic::kParameter>(now, header(now), to_message(name, type, value));
}

}  // namespace rosflight::log
