// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/time.hpp"
#include "sim/random.hpp"

/// The wire between flight control unit and companion, byte by byte in simulated time.
namespace rosflight::sim {

using hal::Time;

/// Bytes in order of arrival, in a ring of fixed size.
class ByteRing {
 public:
  /// @param capacity  in bytes.
  explicit ByteRing(std::size_t capacity) : bytes_(capacity) {}

  std::size_t size() const { return size_; }
  std::size_t room() const { return bytes_.size() - size_; }
  /// `count` <= room().
  void put(const std::uint8_t* data, std::size_t count);
  /// `count` <= size(); `data` may be nullptr: the bytes are then thrown away.
  void take(std::uint8_t* data, std::size_t count);
  /// Discards all bytes.
  void clear() { first_ = size_ = 0; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t first_{0};
  std::size_t size_{0};
};

/// One direction of an asynchronous serial line, with the queues at both of its ends.
///
///     push() -> [urgent | timely | ordinary queue] -> wire -> [receive queue] -> pop()
///
/// The wire takes frame_bits / baud seconds per byte (921600 baud 8N1: 10.85 us, 92 160 bytes/s).
/// The sum is kept in microsecond-bauds (1e6 frame_bits of them are one byte), so it is exact for
/// ever. A byte is received when its last bit is through. Frames go out whole, the waiting frame of
/// the most urgent class next; a frame that does not fit its class is dropped whole and counted.
/// The receive queue drops single bytes, as a UART does.
///
/// Owns its queues, taken at construction; nothing else is allocated. Cost: a few copies per frame.
class SerialLine {
 public:
  static constexpr std::size_t kClasses = 3;
  static constexpr std::size_t kUrgent = 0;    ///< hal::Serial qos 0.
  static constexpr std::size_t kTimely = 1;    ///< 1 to 254.
  static constexpr std::size_t kOrdinary = 2;  ///< 255.

  struct Config {
    std::uint32_t baud{921600};
    std::uint32_t frame_bits{10};  ///< Start, eight data and stop bit.
    std::array<std::size_t, kClasses> transmit_capacity_bytes{1024, 1024, 4096};
    std::size_t receive_capacity_bytes{4096};
    double corruption_per_byte{0.0};  ///< Probability that one bit of a byte is turned over.
  };

  struct Counters {
    std::uint64_t bytes_sent{};      ///< That went over the wire, or vanished from a cut one.
    std::uint64_t bytes_vanished{};  ///< Sent while cut.
    std::uint64_t bytes_corrupted{};
    std::uint64_t bytes_overrun{};  ///< Arrived at a full receive queue.
    std::uint64_t frames_sent{};
    std::array<std::uint64_t, kClasses> frames_dropped{};
  };

  /// @param stream  decides which bytes are corrupted; unused at probability 0.
  /// @throws std::invalid_argument  baud or frame_bits 0, a capacity 0, a probability outside 0..1.
  SerialLine(const Config& config, RandomStream stream);

  /// Queues a frame at `now`. @returns false if it was dropped: empty, or its class is full.
  bool push(Time now, const std::uint8_t* data, std::size_t size, std::uint8_t qos);
  /// Moves what the wire has carried by `now` to the receive queue. Time never goes back.
  void advance(Time now);
  /// Advances, then copies what has arrived, `capacity` bytes at most. @returns their number.
  std::size_t pop(Time now, std::uint8_t* data, std::size_t capacity);

  /// Puts bytes at the far end at once, past the wire, as far as there is room: for a replay.
  void receive(const std::uint8_t* data, std::size_t size) {
    received_.put(data, std::min(size, received_.room()));
  }

  /// Number of bytes that pop() would return now.
  std::size_t waiting(Time now) {
    advance(now);
    return received_.size();
  }

  /// Largest frame of that class that push() would accept now, in bytes.
  std::size_t writable(std::uint8_t qos = 255) const {
    return classes_[class_of(qos)].bytes.room();
  }
  /// Number of bytes queued or on the wire.
  std::size_t queued() const;
  /// While cut, bytes leave the sender as ever and nothing arrives. Call advance(now) first.
  void set_cut(bool cut) { cut_ = cut; }
  bool cut() const { return cut_; }
  /// Changes the probability that one bit of a byte is turned over. Call advance(now) first.
  void set_corruption(double per_byte);
  const Counters& counters() const { return counters_; }

  /// Index of the queue of a quality of service.
  static constexpr std::size_t class_of(std::uint8_t qos) { return hal::Serial::class_of(qos); }

 private:
  struct Class {
    explicit Class(std::size_t capacity) : bytes{capacity}, sizes(capacity) {}
    ByteRing bytes;
    std::vector<std::uint32_t> sizes;  ///< Sizes of the frames in `bytes`, a ring.
    std::size_t first{0};
    std::size_t frames{0};
  };

  bool start_next_frame();
  void deliver(std::size_t count);
  void corrupt(std::uint8_t* data, std::size_t count);
  void draw_next_corruption();

  std::int64_t byte_cost_;  ///< [us baud]
  std::int64_t baud_;
  Time last_{};
  std::int64_t spent_{0};  ///< On the byte that is on the wire [us baud].
  std::array<Class, kClasses> classes_;
  std::size_t sending_{0};    ///< Class of the frame on the wire.
  std::size_t remaining_{0};  ///< Bytes of that frame not sent yet; 0: the wire is idle.
  ByteRing received_;
  bool cut_{false};
  double log_intact_;                 ///< ln(1 - corruption_per_byte); 0: never corrupts.
  std::uint64_t until_corruption_{};  ///< Intact bytes before the next corrupted one.
  RandomStream stream_;
  Counters counters_;
};

/// Both directions.
struct SerialCable {
  /// @param source  of the corrupted bytes, one stream per direction.
  SerialCable(const SerialLine::Config& config, const RandomSource& source)
      : to_companion{config, source.stream("cable/to_companion")},
        to_board{config, source.stream("cable/to_board")} {}

  /// Advances both directions.
  void advance(Time now) { to_companion.advance(now), to_board.advance(now); }
  /// Cuts or restores both directions.
  void set_cut(bool cut) { to_companion.set_cut(cut), to_board.set_cut(cut); }
  /// Changes the noise of both directions.
  void set_corruption(double per_byte) {
    to_companion.set_corruption(per_byte), to_board.set_corruption(per_byte);
  }

  SerialLine to_companion;
  SerialLine to_board;
};

}  // namespace rosflight::sim
