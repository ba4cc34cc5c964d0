// SPDX-License-Identifier: BSD-3-Clause
#include "log/mcap_reader.hpp"

#include <zstd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "log/mcap_records.hpp"

namespace rosflight::log {
namespace {

constexpr std::string_view kMagicText{"\x89MCAP0\r\n", 8};

/// Fields of a record, one after another.
class Fields {
 public:
  explicit Fields(Bytes bytes) : bytes_{bytes} {}

  template <class T>
  T number() {
    T value{};
    const Bytes from = take(sizeof value);
    if (from.size() == sizeof value) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  std::string text() {
    const Bytes from = take(number<std::uint32_t>());
    return {from.begin(), from.end()};
  }
  Bytes take(std::uint64_t size) {
    if (size > bytes_.size()) {
      complete_ = false;
      bytes_ = {};
      return {};
    }
    const Bytes out = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(out.size());
    return out;
  }
  Bytes rest() const { return bytes_; }
  bool complete() const { return complete_; }

 private:
  Bytes bytes_;
  bool complete_{true};
};

}  // namespace

McapReader::McapReader(const std::filesystem::path& path) : path_{path} {
  std::ifstream stream(path, std::ios::binary);
  file_.assign(std::istreambuf_iterator<char>(stream), {});
  if (!stream) {
    throw LogError(path.string() + ": cannot read: " + std::generic_category().message(errno));
  }
  if (!std::string_view(file_).starts_with(kMagicText)) {
    throw LogError(path.string() + ": not an MCAP file");
  }
}

void McapReader::damaged() const {
  throw LogError(path_.string() + ": the log is damaged or not complete");
}

std::vector<std::uint8_t> McapReader::unpacked(Bytes chunk) const {
  Fields fields(chunk);
  fields.take(8 + 8);  // First and last time.
  const auto size = fields.number<std::uint64_t>();
  fields.take(4);  // Checksum: zstd has its own.
  const std::string compression = fields.text();
  const Bytes records = fields.take(fields.number<std::uint64_t>());
  constexpr std::uint64_t kMaxSize = std::uint64_t{1} << 30U;
  if (!fields.complete() || size > kMaxSize) damaged();
  if (compression.empty()) return {records.begin(), records.end()};
  std::vector<std::uint8_t> out(static_cast<std::size_t>(size));
  if (compression != "zstd" ||
      ZSTD_decompress(out.data(), out.size(), records.data(), records.size()) != out.size()) {
    damaged();
  }
  return out;
}

void McapReader::read(const std::function<void(const Message&)>& use) {
  read_records(as_bytes(file_).subspan(kMagicText.size()), use, false);
}

void McapReader::read_records(Bytes records, const std::function<void(const Message&)>& use,
                              bool in_chunk) {
  Fields all(records);
  while (!all.rest().empty()) {
    const Bytes from_here = all.rest();
    const auto opcode = all.number<std::uint8_t>();
    Fields fields(all.take(all.number<std::uint64_t>()));
    if (!all.complete()) damaged();
    if (opcode == kDataEnd) return;
    if (opcode == kAttachment || opcode == kMetadata)
      sha256_.update(from_here.first(from_here.size() - all.rest().size()));
    if (opcode == kChunk && !in_chunk) {
      const std::vector<std::uint8_t> inner = unpacked(fields.rest());
      sha256_.update(inner);
      read_records(inner, use, true);
    } else if (opcode == kChannel) {
      const auto id = fields.number<std::uint16_t>();
      fields.take(2);
      if (id >= topics_.size()) topics_.resize(id + 1U);
      topics_[id] = fields.text();
    } else if (opcode == kMessage) {
      const auto id = fields.number<std::uint16_t>();
      fields.take(4);
      const auto time_ns = fields.number<std::uint64_t>();
      fields.take(8);
      if (!fields.complete() || id >= topics_.size()) damaged();
      use({topics_[id], time_ns, fields.rest()});
    } else if (opcode == kAttachment && start_ns_ == 0) {
      start_ns_ = fields.number<std::uint64_t>();
    } else if (opcode == kMetadata && fields.text() == "flight") {
      Fields map(fields.take(fields.number<std::uint32_t>()));
      while (map.complete() && !map.rest().empty()) {
        const std::string key = map.text();
        flight_[key] = map.text();
      }
    }
    if (!fields.complete()) damaged();
  }
  if (!in_chunk) damaged();  // No DataEnd.
}

}  // namespace rosflight::log
