// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/parameters.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

enum class [[nodiscard]] StoreResult : std::uint8_t {
  kOk,
  kBlank,   ///< Storage can be read and holds no valid set.
  kFailed,  ///< The medium refused or is too small; what was stored before is still there.
};

/// Keeps the parameter table in non-volatile memory so that a cut of power at any byte of a write
/// leaves the old or the new set, never a mixture.
///
/// Storage holds two slots of half its size. A save goes to the slot that does not hold the newest
/// set:
///
///     magic u32 | sequence u32 | count u16 | reserved u16 | count x {name 16, type u8, bits u32} |
///     CRC-32
///
/// little-endian; the CRC covers all before it and is the last to be written. The slot with a valid
/// CRC and the later sequence number (a 32-bit number that may wrap) is in force. Values are found
/// by name, so a firmware with other parameters still reads what it knows; unknown names and values
/// out of range are skipped and counted. Streams through a 64-byte buffer.
class ParameterStore {
 public:
  static constexpr std::size_t kEntryBytes = link::kParamNameLength + 1 + 4;
  static constexpr std::size_t kSlotBytes = 12 + kParamCount * kEntryBytes + 4;

  struct LoadReport {
    std::uint16_t loaded{};
    std::uint16_t skipped{};  ///< Unknown name, other type or out of range.
  };

  explicit ParameterStore(hal::Storage& storage) : storage_{storage} {}

  /// Validates a whole slot first, then takes over its values all at once. After a failure the live
  /// table is untouched. Parameters that the set does not name keep their values.
  StoreResult load(Parameters& parameters, LoadReport& report);

  /// Stores all values. May block as long as the medium does: call it disarmed or while arming.
  StoreResult save(const Parameters& parameters);

 private:
  struct Slot {
    bool valid{};
    bool unreadable{};  ///< Nobody knows what is in it.
    std::uint32_t sequence{};
    std::uint16_t count{};
    std::uint32_t crc{};
  };
  Slot inspect(std::size_t index) const;
  static bool newest_is_second(const Slot& first, const Slot& second);
  std::size_t offset(std::size_t index) const { return index * (storage_.size() / 2); }

  hal::Storage& storage_;
};

}  // namespace rosflight::core
