// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/flight_record.hpp"

#include <algorithm>
#include <cstring>

#include "base/crc32.hpp"
#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

// CRC u32 | number u32 | time i64 | kind u8 | flags u8 | error word u16 | body
constexpr std::size_t kCrcBytes = 4, kNumberAt = 4, kTimeAt = 8, kKindAt = 16, kFlagsAt = 17,
                      kErrorsAt = 18, kBodyAt = 20;
constexpr std::size_t kFloats = 3 + 3 + 4 + FlightMoment::kCommands;
constexpr std::size_t kOutputsAt = kBodyAt + 4 * kFloats;
static_assert(kOutputsAt + 2 * hal::kOutputs <= FlightRecord::kSlotBytes);
static_assert(kBodyAt + FlightRecord::kTextBytes <= FlightRecord::kSlotBytes);
constexpr float kOutputSteps = 65535.0f;

std::uint32_t crc_of(const std::uint8_t* slot) {
  base::Crc32 crc;
  crc.add(slot + kCrcBytes, FlightRecord::kSlotBytes - kCrcBytes);
  return crc.value();
}

bool intact(const std::uint8_t* slot) {
  return le32(slot + kNumberAt) != 0 && le32(slot) == crc_of(slot);
}

void put_time(std::uint8_t* p, hal::Time time) {
  const auto us = static_cast<std::uint64_t>(time.count());
  put_le32(p, static_cast<std::uint32_t>(us & 0xFFFFFFFFu));
  put_le32(p + 4, static_cast<std::uint32_t>(us >> 32));
}
hal::Time get_time(const std::uint8_t* p) {
  const std::uint64_t us = static_cast<std::uint64_t>(le32(p + 4)) << 32 | le32(p);
  return hal::Time{static_cast<std::int64_t>(us)};
}

/// NaN becomes 0.
std::uint16_t steps(float output) {
  const float limited = output > 0.0f ? std::min(output, 1.0f) : 0.0f;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
  return static_cast<std::uint16_t>(limited * kOutputSteps + 0.5f);
}

/// The floats of a moment in their order in a slot.
template <class Moment, class Visit>
void visit_floats(Moment& m, Visit visit) {
  std::size_t at = kBodyAt;
  const auto all = [&](auto& values) {
    for (auto& value : values) {
      visit(value, at);
      at += sizeof(float);
    }
  };
  all(m.accel_m_s2);
  all(m.gyro_rad_s);
  all(m.q_WB);
  all(m.command);
}

}  // namespace

/// Whether the slot has a number that belongs there.
bool FlightRecord::numbered(std::size_t index, std::uint32_t& number) const {
  number = le32(slot(index) + kNumberAt);
  return number != 0 && (number - 1) % slots_ == index;
}

/// Number of the newest intact entry, 0 if there is none. A reset damages one slot, so a memory whose
/// newest ones are all damaged holds something else.
std::uint32_t FlightRecord::find_newest() const {
  constexpr int kAttempts = 8;
  std::uint32_t below = 0xFFFFFFFFu;
  for (int k = 0; k < kAttempts; ++k) {
    std::uint32_t newest = 0;
    for (std::size_t index = 0; index < slots_; ++index) {
      std::uint32_t number = 0;
      if (numbered(index, number) && number < below) newest = std::max(newest, number);
    }
    if (newest == 0 || intact(bytes(newest))) return newest;
    below = newest;
  }
  return 0;
}

std::size_t FlightRecord::attach(bool power_cycled, hal::Time now) {
  next_ = 1;
  first_ = 1;
  const std::uint32_t newest = power_cycled ? 0 : find_newest();
  if (newest == 0) {
    std::fill_n(memory_, slots_ * kSlotBytes, std::uint8_t{0});
    put(Kind::kStart, now, nullptr, 0);
    return 0;
  }
  next_ = newest + 1;
  first_ = newest;
  for (std::size_t index = 0; index < slots_; ++index) {
    std::uint32_t number = 0;
    if (numbered(index, number) && number < first_ && newest - number < slots_) first_ = number;
  }
  const std::size_t found = size();
  put(Kind::kStart, now, nullptr, 0);
  return found;
}

std::size_t FlightRecord::size() const {
  return next_ - first_;
}

void FlightRecord::put(Kind kind, hal::Time time, const std::uint8_t* body, std::size_t size) {
  if (slots_ == 0) return;
  std::array<std::uint8_t, kSlotBytes> made{};
  put_le32(&made[kNumberAt], next_);
  put_time(&made[kTimeAt], time);
  made[kKindAt] = static_cast<std::uint8_t>(kind);
  if (size > 0) std::memcpy(&made[kFlagsAt], body, size);
  put_le32(&made[0], crc_of(made.data()));
  std::copy(made.begin(), made.end(), slot((next_ - 1) % slots_));
  ++next_;
  if (next_ - first_ > slots_) ++first_;
}

void FlightRecord::add(const FlightMoment& moment) {
  if (held_) return;
  std::array<std::uint8_t, kSlotBytes> made{};
  made[kFlagsAt] = moment.flags;
  put_le16(&made[kErrorsAt], moment.error_word);
  visit_floats(moment, [&made](const float& value, std::size_t at) {
    std::memcpy(&made[at], &value, sizeof(float));
  });
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    put_le16(&made[kOutputsAt + 2 * k], steps(moment.outputs[k]));
  }
  put(Kind::kMoment, moment.time, &made[kFlagsAt], kSlotBytes - kFlagsAt);
}

void FlightRecord::add(hal::Time time, const char* text, std::uint8_t severity) {
  if (held_) return;
  std::array<std::uint8_t, kSlotBytes> made{};
  made[kFlagsAt] = severity;
  const std::size_t length = std::min(std::strlen(text), kTextBytes);
  std::memcpy(&made[kBodyAt], text, length);
  put(Kind::kText, time, &made[kFlagsAt], kSlotBytes - kFlagsAt);
}

bool FlightRecord::read(std::size_t index, Entry& entry) const {
  if (index >= size()) return false;
  const auto wanted = static_cast<std::uint32_t>(first_ + index);
  return decode(bytes(wanted), entry) && entry.number == wanted;
}

bool FlightRecord::decode(const std::uint8_t* at, Entry& entry) {
  if (!intact(at)) return false;
  entry = {};
  entry.kind = static_cast<Kind>(at[kKindAt]);
  entry.number = le32(at + kNumberAt);
  entry.moment.time = get_time(at + kTimeAt);
  if (entry.kind == Kind::kText) {
    std::memcpy(entry.text.data(), at + kBodyAt, kTextBytes);
    entry.severity = at[kFlagsAt];
  } else if (entry.kind == Kind::kMoment) {
    entry.moment.flags = at[kFlagsAt];
    entry.moment.error_word = static_cast<std::uint16_t>(le16(at + kErrorsAt));
    visit_floats(entry.moment, [at](float& value, std::size_t place_of) {
      std::memcpy(&value, at + place_of, sizeof(float));
    });
    for (std::size_t k = 0; k < hal::kOutputs; ++k) {
      const auto raw = static_cast<std::uint16_t>(le16(at + kOutputsAt + 2 * k));
      entry.moment.outputs[k] = static_cast<float>(raw) / kOutputSteps;
    }
  }
  return true;
}

}  // namespace rosflight::boards::parts
