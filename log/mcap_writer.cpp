// SPDX-License-Identifier: BSD-3-Clause
#include "log/mcap_writer.hpp"

#include <zstd.h>

#include <array>
#include <limits>

namespace rosflight::log {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

constexpr std::size_t kRecordHeader = 1 + 8;
constexpr int kZstdLevel = 1;  // Higher levels cost several times more and save a few per cent.

/// Appends one record to a buffer; the length is filled in at the end of the scope.
class Record {
 public:
  Record(ByteBuffer& out, Opcode opcode) : out_(out) {
    out.put(static_cast<std::uint8_t>(opcode));
    length_at_ = out.size();
    out.put(std::uint64_t{0});
  }
  ~Record() { out_.patch(length_at_, static_cast<std::uint64_t>(out_.size() - length_at_ - 8)); }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

 private:
  ByteBuffer& out_;
  std::size_t length_at_{};
};

/// Appends a map or list: its size in bytes, then what `fill` puts.
template <class Fill>
void put_sized(ByteBuffer& out, const Fill& fill) {
  const std::size_t size_at = out.size();
  out.put(std::uint32_t{0});
  fill();
  out.patch(size_at, static_cast<std::uint32_t>(out.size() - size_at - 4));
}

void put_map(ByteBuffer& out, const TextMap& map) {
  put_sized(out, [&] {
    for (const auto& [key, value] : map) {
      out.put_string(key);
      out.put_string(value);
    }
  });
}

}  // namespace

McapWriter::McapWriter(std::filesystem::path path, Options options)
    : file_(std::move(path)),
      options_(std::move(options)),
      chunk_(options_.chunk_bytes + options_.chunk_bytes / 8) {
  emit(kMagic);
  {
    const Record record(scratch_, kHeader);
    scratch_.put_string(options_.profile);
    scratch_.put_string(options_.library);
  }
  emit_and_clear(scratch_);
}

void McapWriter::emit(Bytes bytes) {
  crc_.update(bytes);
  file_.write(bytes);
}

void McapWriter::emit_and_clear(ByteBuffer& record) {
  emit(record.bytes());
  record.clear();
}

McapWriter::SchemaId McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                            std::string_view text) {
  if (schemas_ == std::numeric_limits<SchemaId>::max()) {
    throw LogError(path().string() + ": more than 65535 schemas");
  }
  ++schemas_;
  const std::size_t start = schema_records_.size();
  {
    const Record record(schema_records_, kSchema);
    schema_records_.put(schemas_);
    schema_records_.put_string(name);
    schema_records_.put_string(encoding);
    schema_records_.put_string(text);
  }
  chunk_.append(schema_records_.bytes().subspan(start));
  return schemas_;
}

McapWriter::ChannelId McapWriter::add_channel(std::string_view topic, SchemaId schema,
                                              std::string_view message_encoding,
                                              const TextMap& metadata) {
  if (schema > schemas_) {
    throw LogError(path().string() + ": channel " + std::string(topic) +
                   " names an unknown schema");
  }
  if (channels_.size() == std::numeric_limits<ChannelId>::max()) {
    throw LogError(path().string() + ": more than 65535 channels");
  }
  channels_.emplace_back();
  const auto id = static_cast<ChannelId>(channels_.size());
  const std::size_t start = channel_records_.size();
  {
    const Record record(channel_records_, kChannel);
    channel_records_.put(id);
    channel_records_.put(schema);
    channel_records_.put_string(topic);
    channel_records_.put_string(message_encoding);
    put_map(channel_records_, metadata);
  }
  chunk_.append(channel_records_.bytes().subspan(start));
  return id;
}

void McapWriter::write(ChannelId channel_id, std::uint64_t log_time_ns,
                       std::uint64_t publish_time_ns, Bytes data) {
  if (channel_id == 0 || channel_id > channels_.size()) {
    throw LogError(path().string() + ": message on unknown channel " + std::to_string(channel_id));
  }
  Channel& channel = channels_[channel_id - 1U];
  channel.sorted =
      channel.sorted && (channel.index.empty() || channel.index.back().first <= log_time_ns);
  channel.index.emplace_back(log_time_ns, chunk_.size());

  chunk_.put(static_cast<std::uint8_t>(kMessage));
  chunk_.put(static_cast<std::uint64_t>(2 + 4 + 8 + 8 + data.size()));
  chunk_.put(channel_id);
  chunk_.put(channel.sequence++);
  chunk_.put(log_time_ns);
  chunk_.put(publish_time_ns);
  chunk_.append(data);

  chunk_start_ns_ = chunk_has_messages_ ? std::min(chunk_start_ns_, log_time_ns) : log_time_ns;
  chunk_end_ns_ = chunk_has_messages_ ? std::max(chunk_end_ns_, log_time_ns) : log_time_ns;
  chunk_has_messages_ = true;
  first_ns_ = messages_ == 0 ? log_time_ns : std::min(first_ns_, log_time_ns);
  last_ns_ = messages_ == 0 ? log_time_ns : std::max(last_ns_, log_time_ns);
  ++messages_;
  if (chunk_.size() >= options_.chunk_bytes) end_chunk();
}

Bytes McapWriter::compress_chunk() {
  if (options_.compression == Compression::kNone) return chunk_.bytes();
  compressed_.clear();
  const std::size_t bound = ZSTD_compressBound(chunk_.size());
  std::uint8_t* const out = compressed_.extend(bound);
  const std::size_t size =
      ZSTD_compress(out, bound, chunk_.bytes().data(), chunk_.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0U) {
    throw LogError(path().string() + ": cannot compress: " + ZSTD_getErrorName(size));
  }
  return compressed_.bytes().first(size);
}

void McapWriter::end_chunk() {
  if (chunk_.size() == 0) return;
  const std::uint64_t start_ns = chunk_has_messages_ ? chunk_start_ns_ : 0;
  const std::uint64_t end_ns = chunk_has_messages_ ? chunk_end_ns_ : 0;
  const std::string_view compression = options_.compression == Compression::kZstd ? "zstd" : "";
  const Bytes records = compress_chunk();

  const std::uint64_t chunk_offset = file_.size();
  scratch_.put(static_cast<std::uint8_t>(kChunk));
  scratch_.put(
      static_cast<std::uint64_t>(8 + 8 + 8 + 4 + 4 + compression.size() + 8 + records.size()));
  scratch_.put(start_ns);
  scratch_.put(end_ns);
  scratch_.put(static_cast<std::uint64_t>(chunk_.size()));
  scratch_.put(crc32(chunk_.bytes()));
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
  chunk_indexes_.put(static_cast<std::uint64_t>(chunk_.size()));

  ++chunks_;
  chunk_.clear();
  chunk_has_messages_ = false;
}

void McapWriter::write_message_indexes(ByteBuffer& offsets) {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    auto& index = channels_[k].index;
    if (index.empty()) continue;
    if (!channels_[k].sorted) std::sort(index.begin(), index.end());
    const auto id = static_cast<ChannelId>(k + 1);
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
    channels_[k].sorted = true;
  }
}

void McapWriter::attach(std::string_view name, std::string_view media_type,
                        std::uint64_t log_time_ns, Bytes data) {
  end_chunk();
  const std::uint64_t offset = file_.size();
  {
    const Record record(scratch_, kAttachment);
    scratch_.put(log_time_ns);
    scratch_.put(log_time_ns);  // Time of creation.
    scratch_.put_string(name);
    scratch_.put_string(media_type);
    scratch_.put(static_cast<std::uint64_t>(data.size()));
    scratch_.append(data);
    scratch_.put(crc32(scratch_.bytes().subspan(kRecordHeader)));
  }
  {
    const Record record(attachment_indexes_, kAttachmentIndex);
    attachment_indexes_.put(offset);
    attachment_indexes_.put(static_cast<std::uint64_t>(scratch_.size()));
    attachment_indexes_.put(log_time_ns);
    attachment_indexes_.put(log_time_ns);
    attachment_indexes_.put(static_cast<std::uint64_t>(data.size()));
    attachment_indexes_.put_string(name);
    attachment_indexes_.put_string(media_type);
  }
  emit_and_clear(scratch_);
  ++attachments_;
}

void McapWriter::add_metadata(std::string_view name, const TextMap& entries) {
  end_chunk();
  const std::uint64_t offset = file_.size();
  {
    const Record record(scratch_, kMetadata);
    scratch_.put_string(name);
    put_map(scratch_, entries);
  }
  {
    const Record record(metadata_indexes_, kMetadataIndex);
    metadata_indexes_.put(offset);
    metadata_indexes_.put(static_cast<std::uint64_t>(scratch_.size()));
    metadata_indexes_.put_string(name);
  }
  emit_and_clear(scratch_);
  ++metadata_;
}

ByteBuffer McapWriter::statistics() const {
  ByteBuffer out;
  {
    const Record record(out, kStatistics);
    put_statistics(out);
  }
  return out;
}

void McapWriter::put_statistics(ByteBuffer& out) const {
  out.put(messages_);
  out.put(schemas_);
  out.put(static_cast<std::uint32_t>(channels_.size()));
  out.put(attachments_);
  out.put(metadata_);
  out.put(chunks_);
  out.put(first_ns_);
  out.put(last_ns_);
  put_sized(out, [&] {
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (channels_[k].sequence == 0) continue;
      out.put(static_cast<ChannelId>(k + 1));
      out.put(static_cast<std::uint64_t>(channels_[k].sequence));
    }
  });
}

void McapWriter::write_group(std::uint8_t opcode, Bytes records,
                             std::vector<SummaryGroup>& groups) {
  if (records.empty()) return;
  groups.push_back({opcode, file_.size(), records.size()});
  emit(records);
}

void McapWriter::write_summary() {
  crc_.reset();
  const std::uint64_t summary_start = file_.size();
  std::vector<SummaryGroup> groups;
  write_group(kSchema, schema_records_.bytes(), groups);
  write_group(kChannel, channel_records_.bytes(), groups);
  write_group(kStatistics, statistics().bytes(), groups);
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
  scratch_.put(crc_.value());  // Covers the summary and the footer up to here.
  emit_and_clear(scratch_);
}

LogSummary McapWriter::close() {
  end_chunk();
  scratch_.put(static_cast<std::uint8_t>(kDataEnd));
  scratch_.put(std::uint64_t{4});
  scratch_.put(crc_.value());
  emit_and_clear(scratch_);
  write_summary();
  emit(kMagic);
  file_.commit();
  return {path(), file_.sha256(), messages_, file_.size()};
}

}  // namespace rosflight::log
