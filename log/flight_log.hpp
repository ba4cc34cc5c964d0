// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <filesystem>
#include <string_view>

#include "link/messages.hpp"
#include "log/cdr.hpp"
#include "log/mcap_writer.hpp"
#include "log/serialize.hpp"
#include "sim/types.hpp"

namespace rosflight::log {

enum class Topic : std::uint8_t;  // flight_log_topics.hpp

/// The log of one flight: an MCAP file of ROS 2 messages under the topic names a ROSflight user
/// knows, which Foxglove, PlotJuggler and rosbag2 open. README.md lists the topics.
///
/// Times given are simulated (or, in real time, since the start); stamps in the file are epoch_ns
/// later, so that tools show a date. A message that carries a sample time of the FCU has that time
/// in its header; all others the time given. Channels appear with their first message: a missing
/// topic is a missing sensor. Same calls, same bytes. All functions throw LogError when the disk
/// does not take it.
class FlightLog {
 public:
  struct Options {
    /// Added to all times. Part of the bytes: for comparable logs take a fixed date, not today's.
    std::uint64_t epoch_ns{kDefaultEpoch_ns};
    std::uint32_t truth_every{1};  ///< Logs every n-th call of write_truth(); 0 logs none.
    double gravity_m_s2{9.80665};  ///< The simulation's; see serialize_state().
    McapWriter::Options mcap;
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
  /// only.
  void write_link(Direction direction, hal::Time time, const link::Message& message,
                  Bytes raw_frame);

  void write_setpoint(hal::Time time, const Setpoint& setpoint);

  void write_estimate(hal::Time time, const Estimate& estimate);

  /// Autonomy entered the phase `name`.
  void write_phase(hal::Time time, std::string_view name);

  /// A line of text for people, beside those of the FCU.
  void write_event(hal::Time time, link::Severity severity, std::string_view source,
                   std::string_view text);

  void write_parameter(hal::Time time, std::string_view name, link::ParamType type,
                       link::ParamBits value);

  /// The FCU's clock started from zero at `time` (default: at 0). Converts its sample times.
  void set_fcu_boot(hal::Time time) { fcu_boot_ns_ = stamp(time); }

  LogSummary close() { return writer_.close(); }

  const std::filesystem::path& path() const { return writer_.path(); }

 private:
  struct LinkVisitor;

  static constexpr std::size_t kMaxTopics = 48;

  std::uint64_t stamp(hal::Time time) const;
  std::uint64_t fcu_stamp_us(std::uint64_t boot_us) const { return fcu_boot_ns_ + boot_us * 1000; }
  std::uint64_t fcu_stamp_ms(std::uint64_t boot_ms) const { return fcu_stamp_us(boot_ms * 1000); }
  McapWriter::ChannelId channel(Topic topic);

  /// Serialises with `put(cdr)` and writes.
  template <class Put>
  void write(Topic topic, std::uint64_t log_time_ns, const Put& put);

  Options options_;
  McapWriter writer_;
  CdrWriter cdr_;
  std::array<McapWriter::ChannelId, kMaxTopics> channels_{};
  std::array<McapWriter::SchemaId, kMaxTopics> schemas_{};
  std::uint64_t fcu_boot_ns_{};
  std::uint32_t truth_calls_{0};
  bool has_attitude_{false};
  std::array<float, 4> q_NB_{};
};

}  // namespace rosflight::log
