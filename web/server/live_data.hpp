// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace rosflight::web::server {

/// What viewers of something running see: messages of channels, put in by one thread and taken out by
/// the server's.
///
/// A channel is of one of three kinds. Of a *state*, such as a position, only the latest message is
/// kept: a viewer that is slow, or came late, misses the others. Of an *exchange*, requests and
/// their answers, the last kKeptOfExchange are: a viewer that looks less often than they come has
/// both. Of an *event*, such as a text, all are kept in order, for viewers that come later too;
/// together at most kMaxEventBytes, then further ones are lost and counted. Putting in takes a lock
/// for the time of a copy and never waits for a viewer.
class LiveData {
 public:
  static constexpr std::size_t kMaxEventBytes = std::size_t{64} << 20U;
  static constexpr std::size_t kKeptOfExchange = 64;

  enum class Kind : std::uint8_t { kState, kExchange, kEvent };
  struct Channel {
    std::string topic;
    std::string type;    ///< Such as sensor_msgs/msg/Imu.
    std::string schema;  ///< Its definition, ros2msg.
    Kind kind{Kind::kState};
  };
  struct Message {
    std::size_t channel{};
    std::uint64_t time_ns{};
    std::vector<std::uint8_t> cdr;
  };
  using Shared = std::shared_ptr<const Message>;

  /// Something else runs from now on: forgets all channels and messages. Viewers begin again.
  void restart();

  /// @returns its number, from 0.
  std::size_t add_channel(Channel channel);

  /// @throws std::out_of_range  no such channel.
  void put(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> cdr);

  /// Where a viewer stands. A channel is not wanted until the viewer subscribes.
  struct Cursor {
    struct ChannelState {
      bool wanted{false};
      std::uint64_t version{0};   ///< Version of the newest at the last visit.
      std::size_t next_event{0};  ///< Into all events.
    };
    std::uint64_t run{0};     ///< Counts restarts.
    std::size_t channels{0};  ///< Seen by it.
    std::vector<ChannelState> channel_states;
  };
  struct News {
    bool restarted{false};          ///< Since the cursor began; then there is nothing for it.
    std::vector<Channel> channels;  ///< New ones; the first has the number Cursor::channels had.
    /// In wanted channels: new events in order, then what is new in each other channel, in order.
    std::vector<Shared> messages;
  };
  /// What is new since the cursor was last here; moves it.
  News news(Cursor& cursor) const;

  std::uint64_t events_lost() const;

 private:
  /// Appends events that the cursor wants and has not seen.
  void add_events(Cursor& cursor, News& news) const;

  /// The newest messages of a channel that is no event.
  struct Newest {
    std::uint64_t version{0};  ///< How many there were.
    std::deque<Shared> kept;
  };

  mutable std::mutex mutex_;
  std::uint64_t run_{1};
  std::vector<Channel> channels_;
  std::vector<Newest> newest_;  ///< One for each channel; unused by events.
  std::vector<Shared> events_;
  std::size_t event_bytes_{0};
  std::uint64_t lost_{0};
};

}  // namespace rosflight::web::server
