// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/constants.hpp"
#include "link/messages.hpp"
#include "log/log_observer.hpp"
#include "log/mcap_writer.hpp"
#include "messages/roscopter_msgs.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "messages/tf2_msgs.hpp"
#include "sim/types.hpp"
#include "sim/world_sensors/samples.hpp"

namespace rosflight::log {

enum class Direction : std::uint8_t { kFcuToCompanion = 0, kCompanionToFcu = 1 };
/// How much of a flight its log contains.
enum class Detail : std::uint8_t {
  kPlot,  ///< All sensor data and link bytes; the rest at rates that a plot needs (README.md).
  kFull   ///< Every step; only topics that repeat what others hold are thinned.
};

/// The log of one flight: an MCAP file of ROS 2 messages under the topic names a ROSflight user
/// knows, which Foxglove, PlotJuggler and rosbag2 open. README.md lists the topics.
///
/// Times given are simulated (or, in real time, since the start); stamps in the file are epoch_ns
/// later, so that tools show a date. A message that carries a sample time of the FCU has that time
/// in its header; all others the time given. Channels appear with their first message: a missing
/// topic is a missing sensor. Every header names a frame; what has no direction is of the body.
/// Same calls, same LogSummary::sha256. All functions throw LogError when the disk is full or broken
/// (McapWriter says when).
class FlightLog {
 public:
  struct Options {
    /// Added to all times. Part of the bytes: for comparable logs take a fixed date, not today's.
    std::uint64_t epoch_ns{kDefaultEpoch_ns};
    Detail detail{Detail::kPlot};
    double gravity_m_s2{base::kStandardGravity_m_s2};  ///< The simulation's; added to the specific
                                                       ///< force of the truth.
    McapWriter::Options mcap;
    std::vector<LogObserver*> observers;  ///< They outlive the log and do not enter the file.
  };
  static constexpr std::uint64_t kDefaultEpoch_ns =
      1'767'225'600'000'000'000;  ///< 2026-01-01T00:00:00Z.

  /// @param flight  Facts about the flight for people and scripts (vehicle, mission, seed, ...):
  /// metadata
  ///                record "flight".
  FlightLog(std::filesystem::path path, const Options& options, const TextMap& flight);

  /// A file of the flight (vehicle, mission): MCAP attachment. Ends a chunk: not for every second.
  void attach(std::string_view name, std::string_view media_type, std::string_view contents);

  /// A table of facts, such as all parameters: MCAP metadata record. Ends a chunk.
  void add_metadata(std::string_view name, const TextMap& entries) {
    writer_.add_metadata(name, entries);
  }

  /// True motion, forces, wind and air, and what drives the actuators.
  void write_truth(const sim::Truth& truth, const hal::OutputValues& outputs);

  /// A message that crossed the link at `time`, decoded and as bytes. std::monostate logs the bytes
  /// only. Bytes (at most 65535) are written together with those of the next 50 ms.
  void write_link(Direction direction, hal::Time time, const link::Message& message,
                  Bytes raw_frame);

  /// What the board received, for a replay: sensors and receiver (nullptr: nothing), and the bytes
  /// that its firmware read. Only in full logs; those of 500 ms are one message.
  void write_inputs(hal::Time time, const sim::SensorSamples& samples,
                    const hal::RcFrame* receiver);
  void write_inputs(hal::Time time, Bytes read);

  /// Where guidance wants the vehicle. The header is made here, like that of the next one.
  void write_setpoint(hal::Time time, messages::roscopter_msgs::TrajectoryCommand setpoint);

  /// The state estimate that guidance uses.
  void write_estimate(hal::Time time, messages::rosflight_log_msgs::Estimate estimate);

  /// Autonomy entered the phase `name`.
  void write_phase(hal::Time time, std::string_view name);

  /// A line of text for people, beside those of the FCU.
  void write_event(hal::Time time, link::Severity severity, std::string_view source,
                   std::string_view text);

  void write_parameter(hal::Time time, std::string_view name, link::ParamType type,
                       link::ParamBits value);

  /// The vehicle as ROS tools draw it, and the frames that never move. @param urdf  its links are
  /// fixed to base_link.
  void write_description(hal::Time time, std::string_view urdf);
  /// The vehicle file as it is in force from now on.
  void write_settings(hal::Time time, std::string_view yaml);

  /// A sample of a sensor of the world, when it arrives: topics /NAME/scan, /NAME/image_raw and /NAME/camera_info,
  /// /NAME/pose or /NAME/range, stamped with the time of measurement.
  void write_world_sample(hal::Time time, const std::string& name, const sim::WorldSample& sample);
  /// Its frames on the vehicle. @param R_BS  axes of the sensor, front-right-down, to those of the body.
  void write_sensor_frames(hal::Time time, const std::string& name, const sim::Vector3& position_B,
                           const sim::Matrix3& R_BS);

  /// The path as it is planned from here on: points in NED.
  void write_path(hal::Time time, std::span<const std::array<double, 3>> points_W);

  /// The FCU's clock started from zero at `time` (default: at 0). Converts its sample times.
  void set_fcu_boot(hal::Time time) { fcu_boot_ns_ = stamp(time); }

  LogSummary close();

  const std::filesystem::path& path() const { return writer_.path(); }

 private:
  struct LinkVisitor;

  static constexpr std::size_t kMaxTopics = 56;

  std::uint64_t stamp(hal::Time time) const;
  std::uint64_t fcu_stamp_us(std::uint64_t boot_us) const { return fcu_boot_ns_ + boot_us * 1000; }
  std::uint64_t fcu_stamp_ms(std::uint64_t boot_ms) const { return fcu_stamp_us(boot_ms * 1000); }
  McapWriter::ChannelId channel(Topic topic);
  McapWriter::SchemaId schema_of(std::string_view type, std::string_view text);
  /// At `now`, so that the file is in the order of time.
  void write_raw_frames(std::uint64_t now);
  /// Delay after the last input of inputs_ [us]; starts a new message when it is due.
  std::uint32_t inputs_delay_us(std::uint64_t now);
  void write_inputs(std::uint64_t now);
  /// What ROS tools draw of the true motion.
  void write_motion(std::uint64_t now, const sim::BodyState& body);
  void write_text(std::uint64_t now, link::Severity severity, std::string_view source,
                  std::string_view text);
  /// Whether a message of the topic at `now` goes into the log. Call it once for each.
  template <Topic kTopic>
  bool due(std::uint64_t now);

  template <Topic kTopic, class Message>
  void write(std::uint64_t log_time_ns, const Message& message);
  /// Writes a message with this header.
  template <Topic kTopic, class Message>
  void write(std::uint64_t log_time_ns, messages::std_msgs::Header header, Message&& message);

  Options options_;
  McapWriter writer_;
  messages::CdrWriter cdr_;
  std::array<McapWriter::ChannelId, kMaxTopics> channels_{};
  std::map<std::string_view, McapWriter::SchemaId> schemas_;     ///< By type.
  std::map<std::string, McapWriter::ChannelId> world_channels_;  ///< By topic.
  std::uint64_t fcu_boot_ns_{};
  std::optional<link::Attitude> attitude_;              ///< The latest.
  messages::rosflight_log_msgs::RawFrames raw_frames_;  ///< Not written yet.
  std::uint64_t raw_start_ns_{};                        ///< Time of the first of raw_frames_.
  messages::rosflight_log_msgs::BoardInputs inputs_;    ///< Likewise.
  std::uint64_t inputs_start_ns_{};
  std::uint64_t inputs_last_ns_{};  ///< Time of the last input.
  std::uint64_t latest_ns_{};       ///< Latest time of all messages.
  // Kept for their memory.
  messages::rosflight_log_msgs::TruthVehicle vehicle_;
  messages::tf2_msgs::TFMessage transform_;
  std::array<std::uint64_t, kMaxTopics> next_due_ns_{};
};

}  // namespace rosflight::log
