// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameter_store.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/core/checksum.hpp"

namespace rosflight::core {
namespace {

constexpr std::uint32_t kMagic = 0x31504652u;  // "RFP1"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kBufferBytes = 64;

void put_u32(std::uint8_t* p, std::uint32_t v) {
  for (int k = 0; k < 4; ++k) p[k] = static_cast<std::uint8_t>(v >> (8 * k));
}
std::uint32_t get_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}

/// Collects bytes and writes them in ascending order.
class Stream {
 public:
  Stream(hal::Storage& storage, std::size_t offset) : storage_{storage}, offset_{offset} {}

  void add(const std::uint8_t* data, std::size_t size) {
    crc_.add(data, size);
    append(data, size);
  }
  bool finish() {
    std::array<std::uint8_t, 4> crc{};
    put_u32(crc.data(), crc_.value());
    append(crc.data(), crc.size());
    drain();
    return ok_ && storage_.flush();
  }

 private:
  void append(const std::uint8_t* data, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k) {
      buffer_[used_++] = data[k];
      if (used_ == buffer_.size()) drain();
    }
  }
  void drain() {
    if (used_ > 0) ok_ = ok_ && storage_.write(offset_, buffer_.data(), used_);
    offset_ += used_;
    used_ = 0;
  }

  hal::Storage& storage_;
  std::size_t offset_;
  std::array<std::uint8_t, kBufferBytes> buffer_{};
  std::size_t used_{0};
  Crc32 crc_;
  bool ok_{true};
};

}  // namespace

ParameterStore::Slot ParameterStore::inspect(std::size_t index) const {
  std::array<std::uint8_t, kBufferBytes> buffer{};
  const std::size_t start = offset(index);
  const std::size_t slot_bytes = storage_.size() / 2;
  Slot slot;
  slot.unreadable = true;  // until its last byte has been read
  if (slot_bytes < kHeaderBytes + 4 || !storage_.read(start, buffer.data(), kHeaderBytes)) {
    return slot;
  }
  if (get_u32(buffer.data()) != kMagic) return {};
  slot.sequence = get_u32(buffer.data() + 4);
  slot.count = static_cast<std::uint16_t>(get_u32(buffer.data() + 8) & 0xFFFFu);
  const std::size_t body = kHeaderBytes + slot.count * kEntryBytes;
  if (body + 4 > slot_bytes) return {};
  Crc32 crc;
  for (std::size_t at = 0; at < body;) {
    const std::size_t n = std::min(buffer.size(), body - at);
    if (!storage_.read(start + at, buffer.data(), n)) return slot;
    crc.add(buffer.data(), n);
    at += n;
  }
  if (!storage_.read(start + body, buffer.data(), 4)) return slot;
  slot.unreadable = false;
  slot.crc = crc.value();
  slot.valid = get_u32(buffer.data()) == slot.crc;
  return slot;
}

bool ParameterStore::newest_is_second(const Slot& first, const Slot& second) {
  constexpr std::uint32_t kHalf = 0x80000000u;
  const bool later = second.sequence != first.sequence && second.sequence - first.sequence < kHalf;
  return second.valid && (!first.valid || later);
}

StoreResult ParameterStore::load(Parameters& parameters, LoadReport& report) {
  const Slot a = inspect(0);
  const Slot b = inspect(1);
  if (!a.valid && !b.valid) {
    return a.unreadable || b.unreadable ? StoreResult::kFailed : StoreResult::kBlank;
  }
  const bool use_b = newest_is_second(a, b);
  const Slot& slot = use_b ? b : a;
  report = {};
  Parameters loaded = parameters;  // the medium may still fail halfway
  Crc32 crc;
  std::array<std::uint8_t, kEntryBytes> entry{};
  if (!storage_.read(offset(use_b ? 1 : 0), entry.data(), kHeaderBytes)) {
    return StoreResult::kFailed;
  }
  crc.add(entry.data(), kHeaderBytes);
  for (std::size_t k = 0; k < slot.count; ++k) {
    const std::size_t at = offset(use_b ? 1 : 0) + kHeaderBytes + k * kEntryBytes;
    if (!storage_.read(at, entry.data(), entry.size())) return StoreResult::kFailed;
    crc.add(entry.data(), entry.size());
    link::ParamName name{};
    std::memcpy(name.data(), entry.data(), name.size());
    // As a rule this very firmware wrote the set, in the order of the table.
    const bool in_order = k < kParamCount && Parameters::row(static_cast<Param>(k)).name == name;
    const std::size_t index = in_order ? k : Parameters::find(name);
    const SetResult result = index == kParamCount
                                 ? SetResult::kWrongType
                                 : loaded.set_bits(static_cast<Param>(index), entry[name.size()],
                                                   get_u32(&entry[name.size() + 1]), false);
    const bool taken = result == SetResult::kChanged || result == SetResult::kUnchanged;
    ++(taken ? report.loaded : report.skipped);
  }
  if (crc.value() != slot.crc) return StoreResult::kFailed;  // read differently a second time
  if (report.loaded == kParamCount) loaded.mark_saved();
  parameters = loaded;
  return StoreResult::kOk;
}

StoreResult ParameterStore::save(const Parameters& parameters) {
  if (storage_.size() / 2 < kSlotBytes) return StoreResult::kFailed;
  const Slot a = inspect(0);
  const Slot b = inspect(1);
  const bool newest_is_b = newest_is_second(a, b);
  const std::uint32_t newest = newest_is_b ? b.sequence : (a.valid ? a.sequence : 0);
  const bool write_b = !newest_is_b && a.valid;

  Stream stream(storage_, offset(write_b ? 1 : 0));
  std::array<std::uint8_t, kHeaderBytes> header{};
  put_u32(header.data(), kMagic);
  put_u32(&header[4], newest + 1);
  put_u32(&header[8], static_cast<std::uint32_t>(kParamCount));
  stream.add(header.data(), header.size());
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    const ParamRow& row = Parameters::row(id);
    std::array<std::uint8_t, kEntryBytes> entry{};
    std::memcpy(entry.data(), row.name.data(), row.name.size());
    entry[row.name.size()] = static_cast<std::uint8_t>(row.type);
    put_u32(&entry[row.name.size() + 1], parameters.bits(id));
    stream.add(entry.data(), entry.size());
  }
  return stream.finish() ? StoreResult::kOk : StoreResult::kFailed;
}

}  // namespace rosflight::core
