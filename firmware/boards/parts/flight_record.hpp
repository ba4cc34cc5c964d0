// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/hal/samples.hpp"

namespace rosflight::boards::parts {

/// What the record keeps of one control pass, 100 times per second.
struct FlightMoment {
  static constexpr std::size_t kCommands = 10;
  hal::Time time{};
  hal::Vec3 accel_m_s2{};
  hal::Vec3 gyro_rad_s{};
  std::array<float, 4> q_WB{};  ///< Estimate; scalar first.
  std::array<float, kCommands> command{};
  std::array<float, hal::kOutputs> outputs{};  ///< 0..1, kept with 16 bits.
  std::uint16_t error_word{};
  std::uint8_t flags{};  ///< Sum of kArmed, kFailsafe, kOverride.

  static constexpr unsigned kArmed = 1, kFailsafe = 2, kOverride = 4;
};

/// The last moments of a flight, and its texts, in memory that start-up does not clear: a ring of slots of
/// 128 bytes, each with a number and a CRC-32; docs/link.md has its layout, because a ground tool receives
/// it as it is. A reset in the middle of a write costs the slot that was being written. 2100 slots (269 kB)
/// hold 20 s and 100 texts.
///
/// All of it belongs to the main loop; add() costs some 2000 instructions for its CRC, attach() after a reset
/// some 20 for each slot: it compares the CRC of the newest entry alone, the others are judged when read.
class FlightRecord {
 public:
  static constexpr std::size_t kSlotBytes = 128;
  static constexpr std::size_t kTextBytes = 100;

  enum class Kind : std::uint8_t { kNone = 0, kMoment = 1, kText = 2, kStart = 3 };
  struct Entry {
    Kind kind{Kind::kNone};
    std::uint32_t number{};  ///< Counts entries, from 1; a gap is a slot that was lost.
    FlightMoment moment{};   ///< Content of kMoment; its time is set for all kinds.
    std::array<char, kTextBytes + 1> text{};  ///< Content of kText.
    std::uint8_t severity{};                  ///< Severity of kText, as on the link.
  };

  /// @param memory  of `size` bytes, aligned for nothing; must outlive this.
  FlightRecord(std::uint8_t* memory, std::size_t size)
      : memory_{memory}, slots_{size / kSlotBytes} {}

  /// Once at the start. After a power cycle the memory is cleared (its error correction needs that too);
  /// after a reset what is intact is kept, and a start is entered behind it.
  /// @returns entries found.
  std::size_t attach(bool power_cycled, hal::Time now);

  /// Enters a moment; nothing while held.
  void add(const FlightMoment& moment);
  /// Enters a text, cut at kTextBytes; nothing while held.
  void add(hal::Time time, const char* text, std::uint8_t severity = 0);
  /// Keeps what there is: a board holds the record from disarming until the next arming.
  void hold(bool held) { held_ = held; }

  std::size_t capacity() const { return slots_; }
  /// Entries that can be read, damaged ones included.
  std::size_t size() const;
  /// Reads an entry; 0 is the oldest. @returns false if it is damaged or not there.
  bool read(std::size_t index, Entry& entry) const;

  /// Numbers of the entries that can be read, and the kSlotBytes of one of them.
  std::uint32_t oldest() const { return first_; }
  std::uint32_t newest() const { return next_ - 1; }
  const std::uint8_t* bytes(std::uint32_t number) const { return slot((number - 1) % slots_); }
  /// Reads kSlotBytes wherever they lie. @returns false if they are damaged or empty.
  static bool decode(const std::uint8_t* bytes, Entry& entry);

 private:
  std::uint8_t* slot(std::size_t index) const { return memory_ + index * kSlotBytes; }
  bool numbered(std::size_t index, std::uint32_t& number) const;
  std::uint32_t find_newest() const;
  void put(Kind kind, hal::Time time, const std::uint8_t* body, std::size_t size);

  std::uint8_t* memory_;
  std::size_t slots_;
  std::uint32_t next_{1};   ///< Number of the next entry; its slot is (number - 1) % slots_.
  std::uint32_t first_{1};  ///< Number of the oldest entry that may be there.
  bool held_{false};
};

}  // namespace rosflight::boards::parts
