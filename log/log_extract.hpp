// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "log/log_observer.hpp"
#include "log/mcap_writer.hpp"

namespace rosflight::log {

/// A small log beside the log of a flight, for a page: every event and exchange, of each state the
/// first message of every kInterval_ms, no bulk (topic_kinds.hpp), nor what is made for ROS tools
/// alone of other topics. Messages are those of the log, byte for byte; in the file, which is not
/// compressed, each topic stands by itself: so it packs well as a whole. The first message is the
/// earliest.
class LogExtract final : public LogObserver {
 public:
  static constexpr std::uint32_t kInterval_ms = 20;
  /// Kept in memory until they are written, together.
  static constexpr std::size_t kMaxKept_bytes = std::size_t{64} << 20U;

  /// @param flight  as FlightLog's. @throws LogError  the file cannot be written; so do the others.
  LogExtract(std::filesystem::path path, const TextMap& flight);

  void on_logged(Topic topic, std::uint64_t time_ns, Bytes cdr) override;

  LogSummary close();

  /// A log without compression as the same log without indexes and summary, which a reader that takes all of it
  /// does without: half of a small log are indexes. @param mcap  whole, as close() has left it.
  static std::string without_indexes(Bytes mcap);

 private:
  static constexpr std::size_t kMaxTopics = 56;

  struct MessageEnd {
    std::uint64_t time_ns{};
    std::size_t end{};  ///< End of the message in `bytes`; it starts where the one before ends.
  };
  struct Kept {
    std::vector<std::uint8_t> bytes;
    std::vector<MessageEnd> messages;
  };

  McapWriter::ChannelId channel(std::size_t topic);
  void write_kept();

  McapWriter writer_;
  std::array<McapWriter::ChannelId, kMaxTopics> channels_{};
  std::array<std::uint64_t, kMaxTopics> next_due_ns_{};
  std::array<Kept, kMaxTopics> kept_{};
  std::size_t kept_bytes_{0};
};

}  // namespace rosflight::log
