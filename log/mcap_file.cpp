// SPDX-License-Identifier: BSD-3-Clause
#include "log/mcap_file.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "log/mcap_records.hpp"

namespace rosflight::log {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kIndexOffset_at = kRecordHeader;  // In an attachment or metadata index.
constexpr std::size_t kChunkCount_at = kRecordHeader + 8 + 2 + 4 + 4 + 4;  // In the statistics.

template <class T>
T value_at(Bytes bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

void McapFile::FreeZstd::operator()(ZSTD_CCtx_s* context) const {
  ZSTD_freeCCtx(context);
}

McapFile::McapFile(std::filesystem::path path, const Options& options)
    : compression_(options.compression), file_(std::move(path)), zstd_(ZSTD_createCCtx()) {
  const bool fast = compression_ == Compression::kZstdFast;
  ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_compressionLevel, fast ? 1 : 6);
  if (fast) {
    // What repeats in a log are whole fields of messages; shorter matches cost more than they save.
    ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_minMatch, 7);
    ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_hashLog, 12);
    ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_targetLength, 1);
  }
  ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_checksumFlag, 1);
  emit(kMagic);
  {
    const Record record(scratch_, kHeader);
    scratch_.put_string(options.profile);
    scratch_.put_string(options.library);
  }
  emit_and_clear(scratch_);
}

void McapFile::emit(Bytes bytes) {
  if (in_summary_) crc_ = crc32(bytes, crc_);
  file_.write(bytes);
}

void McapFile::emit_and_clear(ByteBuffer& record) {
  emit(record.bytes());
  record.clear();
}

Bytes McapFile::compressed(Bytes records) {
  if (compression_ == Compression::kNone) return records;
  compressed_.clear();
  const std::size_t bound = ZSTD_compressBound(records.size());
  const std::size_t size =
      ZSTD_compress2(zstd_.get(), compressed_.extend(bound), bound, records.data(), records.size());
  if (ZSTD_isError(size) != 0U) {
    throw LogError(file_.path().string() + ": cannot compress: " + ZSTD_getErrorName(size));
  }
  return compressed_.bytes().first(size);
}

std::pair<std::uint64_t, std::uint64_t> McapFile::index_messages(Bytes records) {
  std::uint64_t first_ns = 0;
  std::uint64_t last_ns = 0;
  bool found = false;
  for (std::size_t at = 0; at < records.size();) {
    if (records[at] == kMessage) {
      const std::size_t channel = value_at<std::uint16_t>(records, at + kRecordHeader);
      const auto time_ns = value_at<std::uint64_t>(records, at + kRecordHeader + 2 + 4);
      if (channel >= indexes_.size()) indexes_.resize(channel + 1);
      indexes_[channel].emplace_back(time_ns, at);
      first_ns = found ? std::min(first_ns, time_ns) : time_ns;
      last_ns = found ? std::max(last_ns, time_ns) : time_ns;
      found = true;
    }
    at += kRecordHeader + static_cast<std::size_t>(value_at<std::uint64_t>(records, at + 1));
  }
  return {first_ns, last_ns};
}

void McapFile::write_chunk(Bytes plain) {
  sha256_.update(plain);
  const auto [start_ns, end_ns] = index_messages(plain);
  const std::string_view compression = compression_ == Compression::kNone ? "" : "zstd";
  const Bytes records = compressed(plain);

  const std::uint64_t chunk_offset = file_.size();
  scratch_.put(static_cast<std::uint8_t>(kChunk));
  scratch_.put(
      static_cast<std::uint64_t>(8 + 8 + 8 + 4 + 4 + compression.size() + 8 + records.size()));
  scratch_.put(start_ns);
  scratch_.put(end_ns);
  scratch_.put(static_cast<std::uint64_t>(plain.size()));
  // 0: none. A zstd frame carries a checksum of its own (XXH64), which libzstd verifies, at a tenth of the cost.
  scratch_.put(compression_ == Compression::kNone ? crc32(plain) : 0U);
  scratch_.put_string(compression);
  scratch_.put(static_cast<std::uint64_t>(records.size()));
  const std::uint64_t chunk_length = scratch_.size() + records.size();
  emit_and_clear(scratch_);
  emit(records);

  const std::uint64_t indexes_offset = file_.size();
  const Record record(chunk_indexes_, kChunkIndex);
  chunk_indexes_.put(start_ns);
  chunk_indexes_.put(end_ns);
  chunk_indexes_.put(chunk_offset);
  chunk_indexes_.put(chunk_length);
  put_sized(chunk_indexes_, [&] { write_message_indexes(chunk_indexes_); });
  chunk_indexes_.put(file_.size() - indexes_offset);
  chunk_indexes_.put_string(compression);
  chunk_indexes_.put(static_cast<std::uint64_t>(records.size()));
  chunk_indexes_.put(static_cast<std::uint64_t>(plain.size()));
  ++chunks_;
}

void McapFile::write_message_indexes(ByteBuffer& offsets) {
  for (std::size_t channel = 0; channel < indexes_.size(); ++channel) {
    auto& index = indexes_[channel];
    if (index.empty()) continue;
    if (!std::is_sorted(index.begin(), index.end())) std::sort(index.begin(), index.end());
    const auto id = static_cast<std::uint16_t>(channel);
    offsets.put(id);
    offsets.put(file_.size());
    {
      const Record record(scratch_, kMessageIndex);
      scratch_.put(id);
      scratch_.put(static_cast<std::uint32_t>(16 * index.size()));
      for (const auto& [time_ns, offset] : index) {
        scratch_.put(time_ns);
        scratch_.put(offset);
      }
    }
    emit_and_clear(scratch_);
    index.clear();
  }
}

void McapFile::write_record(Bytes record, ByteBuffer& index) {
  sha256_.update(record);
  index.patch(kIndexOffset_at, file_.size());
  emit(record);
  (record.front() == kAttachment ? attachment_indexes_ : metadata_indexes_).append(index.bytes());
}

void McapFile::write_group(std::uint8_t opcode, Bytes records, std::vector<SummaryGroup>& groups) {
  if (records.empty()) return;
  groups.push_back({opcode, file_.size(), records.size()});
  emit(records);
}

void McapFile::write_summary(Bytes schemas, Bytes channels, Bytes statistics) {
  in_summary_ = true;
  const std::uint64_t summary_start = file_.size();
  std::vector<SummaryGroup> groups;
  write_group(kSchema, schemas, groups);
  write_group(kChannel, channels, groups);
  write_group(kStatistics, statistics, groups);
  write_group(kChunkIndex, chunk_indexes_.bytes(), groups);
  write_group(kAttachmentIndex, attachment_indexes_.bytes(), groups);
  write_group(kMetadataIndex, metadata_indexes_.bytes(), groups);

  const std::uint64_t offsets_start = file_.size();
  for (const SummaryGroup& group : groups) {
    {
      const Record record(scratch_, kSummaryOffset);
      scratch_.put(group.opcode);
      scratch_.put(group.start);
      scratch_.put(group.length);
    }
    emit_and_clear(scratch_);
  }
  scratch_.put(static_cast<std::uint8_t>(kFooter));
  scratch_.put(std::uint64_t{8 + 8 + 4});
  scratch_.put(summary_start);
  scratch_.put(offsets_start);
  emit_and_clear(scratch_);
  scratch_.put(crc_);  // Covers the summary and the footer up to here.
  emit_and_clear(scratch_);
}

void McapFile::close(Bytes schemas, Bytes channels, ByteBuffer& statistics) {
  scratch_.put(static_cast<std::uint8_t>(kDataEnd));
  scratch_.put(std::uint64_t{4});
  scratch_.put(std::uint32_t{0});  // No checksum: chunks and attachments have their own.
  emit_and_clear(scratch_);
  statistics.patch(kChunkCount_at, chunks_);
  write_summary(schemas, channels, statistics.bytes());
  emit(kMagic);
  file_.commit();
}

}  // namespace rosflight::log
