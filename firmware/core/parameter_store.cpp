// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameter_store.hpp"

#include <algorithm>
#include <cstring>

namespace rosflight::core {
namespace {

constexpr std::uint32_t kMagic = 0x31504652u;      // "RFP1"
constexpr std::uint32_t kGyroMagic = 0x31474652u;  // "RFG1"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kRecordBytes = 24;
constexpr std::size_t kRecordCovered = kRecordBytes - kCrcBytes;
constexpr std::array<Param, 3> kGyroBias{Param::kGyroXBias, Param::kGyroYBias, Param::kGyroZBias};

using Block = std::array<std::uint8_t, ParameterStore::kBlockBytes>;

void put_u32(std::uint8_t* p, std::uint32_t v) {
  for (int k = 0; k < 4; ++k) p[k] = static_cast<std::uint8_t>(v >> (8 * k));
}
std::uint32_t get_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}

bool all_are(const std::uint8_t* data, std::size_t size, std::uint8_t value) {
  return std::all_of(data, data + size, [value](std::uint8_t byte) { return byte == value; });
}

std::uint32_t crc_of(const std::uint8_t* data, std::size_t size) {
  Crc32 crc;
  crc.add(data, size);
  return crc.value();
}

/// The record of gyro biases that belongs to the set `sequence`.
void fill_record(const Parameters& parameters, std::uint32_t sequence, std::uint8_t* record) {
  put_u32(record, kGyroMagic);
  put_u32(record + 4, sequence);
  for (std::size_t k = 0; k < kGyroBias.size(); ++k) {
    put_u32(record + 8 + 4 * k, parameters.bits(kGyroBias[k]));
  }
  put_u32(record + kRecordCovered, crc_of(record, kRecordCovered));
}

}  // namespace

// ---- reading

/// Reads the header. What follows our magic stays unread; without it a slot is blank, as far as that
/// was read, or damaged.
ParameterStore::Slot ParameterStore::look(std::size_t index) {
  std::array<std::uint8_t, kHeaderBytes> header{};
  const std::size_t slot_bytes = storage_.size() / 2;
  Slot slot;  // unreadable
  if (slot_bytes < kHeaderBytes + kCrcBytes ||
      !storage_.read(offset(index), header.data(), header.size())) {
    return slot;
  }
  if (get_u32(header.data()) != kMagic) {
    slot.erased = header[0];
    const bool erased = (slot.erased == 0x00 || slot.erased == 0xFF) &&
                        all_are(header.data(), header.size(), slot.erased);
    slot.condition = erased ? Condition::kBlank : Condition::kDamaged;
    return slot;
  }
  slot.sequence_known = true;
  slot.sequence = get_u32(&header[4]);
  slot.count = static_cast<std::uint16_t>(get_u32(&header[8]) & 0xFFFFu);
  slot.crc.add(header.data(), header.size());
  const bool fits = kHeaderBytes + slot.count * kEntryBytes + kCrcBytes <= slot_bytes;
  slot.condition = fits ? Condition::kUnread : Condition::kDamaged;
  return slot;
}

/// Reads what look() left. A slot is blank if it is erased where a set and its record of gyro biases
/// go. Where neither slot has a set, survey() looks at the rest of it too.
void ParameterStore::read(std::size_t index, Slot& slot, const Reading& reading) {
  const std::size_t slot_bytes = storage_.size() / 2;
  if (slot.condition == Condition::kUnread) slot.condition = read_set(index, slot, reading);
  require_erased(index, slot, kHeaderBytes, std::min(kSetBytes, slot_bytes));
  require_erased(index, slot, slot_bytes - std::min(kBlockBytes, slot_bytes), slot_bytes);
  if (reading.system != nullptr) reading.system->feed_watchdog();
}

/// One reading both checks the set and takes its values, which count only if it was valid.
ParameterStore::Condition ParameterStore::read_set(std::size_t index, const Slot& slot,
                                                   const Reading& reading) {
  constexpr std::size_t kReadsBetweenFeeds = 32;
  std::array<std::uint8_t, kEntryBytes> entry{};
  std::size_t at = offset(index) + kHeaderBytes;
  Crc32 crc = slot.crc;
  for (std::size_t k = 0; k < slot.count; ++k, at += kEntryBytes) {
    if (reading.system != nullptr && k % kReadsBetweenFeeds == 0) reading.system->feed_watchdog();
    if (!storage_.read(at, entry.data(), entry.size())) return Condition::kUnreadable;
    crc.add(entry.data(), entry.size());
    if (reading.live != nullptr) take(k, entry.data(), reading);
  }
  if (!storage_.read(at, entry.data(), kCrcBytes)) return Condition::kUnreadable;
  return get_u32(entry.data()) == crc.value() ? Condition::kValid : Condition::kDamaged;
}

void ParameterStore::take(std::size_t k, const std::uint8_t* entry, const Reading& reading) {
  link::ParamName name{};
  std::memcpy(name.data(), entry, name.size());
  // Usually the same firmware wrote the set, in the order of the table.
  const bool in_order = k < kParamCount && Parameters::row(static_cast<Param>(k)).name == name;
  // Where a set was cut off nothing is written, and nothing is searched for.
  const bool named = name[0] != '\0' && name[0] != '\xFF';
  const std::size_t found = in_order ? k : (named ? Parameters::find(name) : kParamCount);
  const SetResult result =
      found == kParamCount ? SetResult::kWrongType
                           : reading.loaded->set_bits(static_cast<Param>(found), entry[name.size()],
                                                      get_u32(entry + name.size() + 1), false);
  const bool taken = result == SetResult::kChanged || result == SetResult::kUnchanged;
  LoadReport& report = *reading.report;
  if (!taken && report.skipped == 0) report.first_skipped = name;
  ++(taken ? report.loaded : report.skipped);
}

/// A blank slot that is not erased from `begin` to `end` is damaged; one that cannot be read there,
/// unreadable.
void ParameterStore::require_erased(std::size_t index, Slot& slot, std::size_t begin,
                                    std::size_t end) {
  Block block{};
  for (std::size_t at = begin; slot.condition == Condition::kBlank && at < end;) {
    const std::size_t n = std::min(block.size(), end - at);
    if (!storage_.read(offset(index) + at, block.data(), n)) {
      slot.condition = Condition::kUnreadable;
    } else if (!all_are(block.data(), n, slot.erased)) {
      slot.condition = Condition::kDamaged;
    }
    at += n;
  }
}

/// Which of the slots that begin as a set does has the later number.
bool ParameterStore::second_is_later(const Slots& slots) {
  constexpr std::uint32_t kHalf = 0x80000000u;
  if (slots[1].condition != Condition::kUnread) return false;
  if (slots[0].condition != Condition::kUnread) return true;
  const std::uint32_t ahead = slots[1].sequence - slots[0].sequence;
  return ahead != 0 && ahead < kHalf;
}

bool ParameterStore::is_before(const Slot& other, const Slot& valid) {
  return other.sequence_known && other.sequence + 1 == valid.sequence;
}

/// The set before the valid one may be damaged without a loss; any other number belongs to a newer
/// set, or is damaged itself. A blank slot is expected beside the first set only: after two sets
/// both slots have been written.
bool ParameterStore::may_be_newer(const Slot& other, const Slot& valid) {
  if (other.condition == Condition::kUnreadable) return true;
  if (other.condition == Condition::kBlank) return valid.sequence > 1;
  return other.condition == Condition::kDamaged && !is_before(other, valid);
}

/// Determines which slot is in force and which is written next. The later set is read first; if it is
/// valid, the one before it is not read. @returns false if neither can be read.
bool ParameterStore::survey(Slots& slots, const Reading& reading) {
  slots = {look(0), look(1)};
  set_in_force_ = false;
  sequence_ = 0;
  newest_ = 1;
  const std::size_t later = second_is_later(slots) ? 1 : 0;
  for (const std::size_t index : {later, 1 - later}) {
    Slot& slot = slots[index];
    if (set_in_force_) {
      if (!is_before(slot, slots[newest_])) read(index, slot, {{}, {}, {}, reading.system});
      break;
    }
    read(index, slot, reading);
    if (slot.valid()) {
      set_in_force_ = true;
      sequence_ = slot.sequence;
      newest_ = static_cast<std::uint8_t>(index);
    } else if (reading.live != nullptr) {
      *reading.loaded = *reading.live;
      *reading.report = {};
    }
  }
  if (!set_in_force_) {  // defaults will be written over what is blank
    require_erased(0, slots[0], kSetBytes, storage_.size() / 2);
    require_erased(1, slots[1], kSetBytes, storage_.size() / 2);
  }
  surveyed_ =
      slots[0].condition != Condition::kUnreadable && slots[1].condition != Condition::kUnreadable;
  return set_in_force_ || surveyed_;
}

StoreResult ParameterStore::load(Parameters& parameters, LoadReport& report, hal::System* system) {
  Slots slots;
  Parameters loaded = parameters;
  report = {};
  if (!survey(slots, {&parameters, &loaded, &report, system})) return StoreResult::kFailed;
  if (!set_in_force_) {
    const bool damaged =
        slots[0].condition == Condition::kDamaged || slots[1].condition == Condition::kDamaged;
    return damaged ? StoreResult::kDamaged : StoreResult::kBlank;
  }
  report.fell_back = may_be_newer(slots[1 - newest_], slots[newest_]);
  if (!read_gyro_bias(newest_, loaded)) report.fell_back = true;
  if (report.loaded == kParamCount) loaded.mark_saved(loaded.version());
  parameters = loaded;
  return StoreResult::kOk;
}

/// @returns false if the record is damaged; that of an earlier set is ignored.
bool ParameterStore::read_gyro_bias(std::size_t index, Parameters& loaded) {
  std::array<std::uint8_t, kRecordBytes> record{};
  if (!present()) return true;
  if (!storage_.read(record_offset(index), record.data(), record.size())) return false;
  if (all_are(record.data(), record.size(), record[0])) return true;  // erased
  if (get_u32(record.data()) != kGyroMagic ||
      get_u32(&record[kRecordCovered]) != crc_of(record.data(), kRecordCovered)) {
    return false;
  }
  if (get_u32(&record[4]) != sequence_) return true;
  Parameters corrected = loaded;
  for (std::size_t k = 0; k < kGyroBias.size(); ++k) {
    const SetResult result =
        corrected.set_bits(kGyroBias[k], static_cast<std::uint8_t>(ParamType::kFloat),
                           get_u32(&record[8 + 4 * k]), false);
    if (result != SetResult::kChanged && result != SetResult::kUnchanged) return false;
  }
  loaded = corrected;
  return true;
}

// ---- writing

StoreResult ParameterStore::begin(const Parameters& parameters) {
  if (!present()) return StoreResult::kFailed;
  if (!surveyed_) {
    Slots slots;
    if (!survey(slots, {})) return StoreResult::kFailed;
  }
  begun_ = parameters.version();
  crc_ = {};
  entry_ = 0;
  at_ = 0;
  writing_ = Writing::kRecordOfSet;
  return StoreResult::kBusy;
}

StoreResult ParameterStore::begin_gyro_bias(const Parameters& parameters) {
  if (!present() || busy() || !surveyed_ || !set_in_force_) return StoreResult::kFailed;
  begun_ = parameters.version();
  writing_ = Writing::kGyroBias;
  return StoreResult::kBusy;
}

/// Fills a block with the next entries of the set, whole ones, so that no value is stored half old
/// and half new. Empty after the checksum has been written.
std::size_t ParameterStore::fill(const Parameters& parameters, std::uint8_t* block) {
  std::size_t used = 0;
  if (at_ == 0) {
    put_u32(block, kMagic);
    put_u32(block + 4, sequence_ + 1);
    put_u32(block + 8, static_cast<std::uint32_t>(kParamCount));
    used = kHeaderBytes;
  }
  for (; entry_ < kParamCount && used + kEntryBytes <= kBlockBytes; used += kEntryBytes) {
    const auto id = static_cast<Param>(entry_++);
    const ParamRow& row = Parameters::row(id);
    std::uint8_t* const entry = block + used;
    std::memcpy(entry, row.name.data(), row.name.size());
    entry[row.name.size()] = static_cast<std::uint8_t>(row.type);
    put_u32(entry + row.name.size() + 1, parameters.bits(id));
  }
  crc_.add(block, used);
  const std::size_t behind = at_ + used + kCrcBytes;
  if (behind == kSetBytes && used + kCrcBytes <= kBlockBytes) {
    put_u32(block + used, crc_.value());
    used += kCrcBytes;
  }
  return used;
}

bool ParameterStore::write_block(std::size_t at, const std::uint8_t* block, std::size_t size) {
  Block back{};
  return storage_.write(at, block, size) && storage_.read(at, back.data(), size) &&
         std::memcmp(back.data(), block, size) == 0;
}

StoreResult ParameterStore::step(const Parameters& parameters) {
  if (!busy()) return StoreResult::kFailed;
  Block block{};
  const std::size_t target = newest_ == 0 ? 1 : 0;
  if (writing_ == Writing::kGyroBias) {
    fill_record(parameters, sequence_, block.data());
    begun_ = parameters.version();
    const bool ok = write_block(record_offset(newest_), block.data(), kRecordBytes);
    return finish(ok && storage_.flush());
  }
  if (writing_ == Writing::kRecordOfSet) {  // first, so that the set is complete with its last byte
    fill_record(parameters, sequence_ + 1, block.data());
    writing_ = Writing::kSet;
    const bool ok = write_block(record_offset(target), block.data(), kRecordBytes);
    return ok ? StoreResult::kBusy : finish(false);
  }
  const std::size_t used = fill(parameters, block.data());
  if (!write_block(offset(target) + at_, block.data(), used)) return finish(false);
  at_ = static_cast<std::uint16_t>(at_ + used);
  return at_ < kSetBytes ? StoreResult::kBusy : finish(storage_.flush());
}

StoreResult ParameterStore::finish(bool ok) {
  whole_ = writing_ == Writing::kSet;
  writing_ = Writing::kNothing;
  if (!ok) return StoreResult::kFailed;
  if (whole_) {
    newest_ = newest_ == 0 ? 1 : 0;
    ++sequence_;
    set_in_force_ = true;
    surveyed_ = true;
  }
  return StoreResult::kOk;
}

void ParameterStore::mark_saved(Parameters& parameters) const {
  if (whole_) {
    parameters.mark_saved(begun_);
  } else {
    parameters.mark_gyro_bias_saved(begun_);
  }
}

StoreResult ParameterStore::save(const Parameters& parameters, hal::System* system) {
  StoreResult result = begin(parameters);
  while (result == StoreResult::kBusy) {
    if (system != nullptr) system->feed_watchdog();
    result = step(parameters);
  }
  return result;
}

StoreResult ParameterStore::save_gyro_bias(const Parameters& parameters) {
  const StoreResult begun = begin_gyro_bias(parameters);
  return begun == StoreResult::kBusy ? step(parameters) : begun;
}

}  // namespace rosflight::core
