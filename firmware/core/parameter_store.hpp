// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/checksum.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

enum class [[nodiscard]] StoreResult : std::uint8_t {
  kOk,
  kBlank,    ///< Storage can be read and was never written: all 0x00 or all 0xFF.
  kDamaged,  ///< Storage can be read and is not blank, but holds no valid set.
  kFailed,   ///< The medium failed or is too small; the previous set is unchanged.
  kBusy      ///< Not finished: call step() again.
};

/// Keeps the parameter table in non-volatile memory so that a cut of power at any byte of a write
/// leaves the old or the new set, never a mixture.
///
/// Storage holds two slots of half its size. A save goes to the slot that does not hold the newest
/// set:
///
///     magic u32 | sequence u32 | count u16 | reserved u16
///     count x { name 16 | type u8 | bits u32 }
///     CRC-32
///
/// little-endian; the CRC covers all before it and is the last to be written. The slot with a valid
/// CRC and the later sequence number (a 32-bit number that may wrap) is in force. Values are found
/// by name, so a firmware with other parameters reads those that it has; unknown names and values
/// out of range are skipped and counted.
///
/// The last 64 bytes of a slot are a record of their own, so that a gyro calibration writes one
/// block:
///
///     magic u32 | sequence u32 of the set it belongs to | three biases, bits u32 | CRC-32
///
/// It counts if its CRC is right, its sequence is that of the set and its values are in range;
/// otherwise the biases of the set stand.
///
/// Writes go in blocks of at most 64 bytes, whole parameters in each, and every block is read back
/// and compared in the same step. Nothing is allocated; 28 bytes of state.
class ParameterStore {
 public:
  static constexpr std::size_t kEntryBytes = link::kParamNameLength + 1 + 4;
  static constexpr std::size_t kSetBytes = 12 + kParamCount * kEntryBytes + 4;
  static constexpr std::size_t kBlockBytes = 64;
  static constexpr std::size_t kSlotBytes = kSetBytes + kBlockBytes;

  struct LoadReport {
    std::uint16_t loaded{};
    std::uint16_t skipped{};  ///< Unknown name, other type or out of range.
    link::ParamName first_skipped{};
    /// Something newer is lost: the other slot is damaged, unreadable or blank and may have been the
    /// newer, or the newest gyro biases are damaged.
    bool fell_back{};
  };

  /// @param storage  must outlive this.
  explicit ParameterStore(hal::Storage& storage) : storage_{storage} {}

  /// Whether the medium has room for two slots.
  bool present() const { return storage_.size() / 2 >= kSlotBytes; }

  /// Reads a whole slot, then takes over its values all at once if they are valid. After a failure the
  /// live table is untouched. Parameters that the set does not name keep their values. Not while busy().
  /// A set is read once, and the set before a valid one not at all: after a restart in flight each
  /// parameter costs the time of its 21 bytes. Feeds the watchdog of `system` meanwhile.
  StoreResult load(Parameters& parameters, LoadReport& report, hal::System* system = nullptr);

  /// Starts to store all values. @returns kBusy; kFailed if the medium is too small or neither slot
  /// can be read (a slot that cannot be read now may hold a valid set).
  StoreResult begin(const Parameters& parameters);
  /// Starts to store the three gyro biases alone, beside the set in force: one block.
  /// @returns kBusy; kFailed if no set is known to be in force.
  StoreResult begin_gyro_bias(const Parameters& parameters);
  /// Writes one block and compares it. @returns kBusy until the end; then kOk or kFailed. A value
  /// that changes meanwhile may be stored or not.
  StoreResult step(const Parameters& parameters);
  bool busy() const { return writing_ != Writing::kNothing; }
  /// After a step() that returned kOk: marks in the table what is stored now.
  void mark_saved(Parameters& parameters) const;

  /// All steps at once, for the start; feeds the watchdog of `system` between them.
  StoreResult save(const Parameters& parameters, hal::System* system = nullptr);
  /// One block at once.
  StoreResult save_gyro_bias(const Parameters& parameters);

 private:
  enum class Writing : std::uint8_t { kNothing, kRecordOfSet, kSet, kGyroBias };
  enum class Condition : std::uint8_t {
    kBlank,
    kUnread,  ///< Begins as a set does; what follows is not known.
    kValid,
    kDamaged,
    kUnreadable
  };
  struct Slot {
    Condition condition{Condition::kUnreadable};
    bool sequence_known{};
    std::uint8_t erased{};  ///< What all bytes of a blank slot are.
    std::uint16_t count{};
    std::uint32_t sequence{};
    Crc32 crc{};  ///< Checksum so far: that of the header.
    bool valid() const { return condition == Condition::kValid; }
  };
  using Slots = std::array<Slot, 2>;
  /// What a reading is for, besides finding out which slot is in force.
  struct Reading {
    const Parameters* live{};  ///< If not null: `loaded` becomes this with the values of the set.
    Parameters* loaded{};
    LoadReport* report{};
    hal::System* system{};
  };
  Slot look(std::size_t index);
  void read(std::size_t index, Slot& slot, const Reading& reading);
  Condition read_set(std::size_t index, const Slot& slot, const Reading& reading);
  void require_erased(std::size_t index, Slot& slot, std::size_t begin, std::size_t end);
  bool survey(Slots& slots, const Reading& reading);
  static bool second_is_later(const Slots& slots);
  static bool is_before(const Slot& other, const Slot& valid);
  static bool may_be_newer(const Slot& other, const Slot& valid);
  static void take(std::size_t k, const std::uint8_t* entry, const Reading& reading);
  bool read_gyro_bias(std::size_t index, Parameters& loaded);
  std::size_t fill(const Parameters& parameters, std::uint8_t* block);
  bool write_block(std::size_t at, const std::uint8_t* block, std::size_t size);
  StoreResult finish(bool ok);
  std::size_t offset(std::size_t index) const { return index * (storage_.size() / 2); }
  std::size_t record_offset(std::size_t index) const {
    return offset(index) + storage_.size() / 2 - kBlockBytes;
  }

  hal::Storage& storage_;
  Parameters::Version begun_{};  ///< Version of the values when the save began.
  Crc32 crc_;
  std::uint32_t sequence_{0};  ///< Sequence number of the newest set.
  std::uint16_t entry_{0};     ///< The next to be written.
  std::uint16_t at_{0};        ///< Where it goes in its slot.
  std::uint8_t newest_{1};     ///< Slot of the newest set; a save goes to the other.
  bool surveyed_{false};       ///< The two above are known.
  bool set_in_force_{false};   ///< There is a valid set in slot newest_.
  bool whole_{false};          ///< The last save was one of all values.
  Writing writing_{Writing::kNothing};
};

}  // namespace rosflight::core
