// SPDX-License-Identifier: BSD-3-Clause
#include "log/mcap_writer.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "log/mcap_records.hpp"

namespace rosflight::log {
namespace {

/// A larger message at the end of a chunk makes its memory grow.
constexpr std::size_t kLargeMessage = 4096;

void put_map(ByteBuffer& out, const TextMap& map) {
  put_sized(out, [&] {
    for (const auto& [key, value] : map) {
      out.put_string(key);
      out.put_string(value);
    }
  });
}

}  // namespace

McapWriter::McapWriter(std::filesystem::path path, const Options& options)
    : path_(path),
      chunk_bytes_(options.chunk_bytes),
      file_(std::move(path), options),
      thread_([this](BlockThread::Block& block) {
        if (block.index.size() == 0) {
          file_.write_chunk(block.bytes.bytes());
        } else {
          file_.write_record(block.bytes.bytes(), block.index);
        }
      }) {}

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
  chunk_.bytes.append(schema_records_.bytes().subspan(start));
  return schemas_;
}

McapWriter::ChannelId McapWriter::add_channel(std::string_view topic, SchemaId schema,
                                              std::string_view message_encoding,
                                              const TextMap& metadata) {
  if (schema > schemas_) {
    throw LogError(path().string() + ": channel " + std::string(topic) +
                   " names an unknown schema");
  }
  if (sequences_.size() == std::numeric_limits<ChannelId>::max()) {
    throw LogError(path().string() + ": more than 65535 channels");
  }
  sequences_.push_back(0);
  const auto id = static_cast<ChannelId>(sequences_.size());
  const std::size_t start = channel_records_.size();
  {
    const Record record(channel_records_, kChannel);
    channel_records_.put(id);
    channel_records_.put(schema);
    channel_records_.put_string(topic);
    channel_records_.put_string(message_encoding);
    put_map(channel_records_, metadata);
  }
  chunk_.bytes.append(channel_records_.bytes().subspan(start));
  return id;
}

void McapWriter::write(ChannelId channel_id, std::uint64_t log_time_ns,
                       std::uint64_t publish_time_ns, Bytes data) {
  if (channel_id == 0 || channel_id > sequences_.size()) {
    throw LogError(path().string() + ": message on unknown channel " + std::to_string(channel_id));
  }
  ByteBuffer& chunk = chunk_.bytes;
  // Many messages a second: room for the whole record at once.
  constexpr std::size_t kFields = 2 + 4 + 8 + 8;
  std::uint8_t* to = chunk.extend(kRecordHeader + kFields + data.size());
  const auto store = [&to](const auto value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  };
  store(static_cast<std::uint8_t>(kMessage));
  store(static_cast<std::uint64_t>(kFields + data.size()));
  store(channel_id);
  store(sequences_[channel_id - 1U]++);
  store(log_time_ns);
  store(publish_time_ns);
  std::copy(data.begin(), data.end(), to);

  first_ns_ = messages_ == 0 ? log_time_ns : std::min(first_ns_, log_time_ns);
  last_ns_ = messages_ == 0 ? log_time_ns : std::max(last_ns_, log_time_ns);
  ++messages_;
  if (chunk.size() >= chunk_bytes_) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.bytes.size() == 0) return;
  thread_.put(chunk_);
  chunk_.bytes.reserve(chunk_bytes_ + kLargeMessage);
}

void McapWriter::put_record(ByteBuffer& record, ByteBuffer& index) {
  end_chunk();
  BlockThread::Block block;
  block.bytes = std::move(record);
  block.index = std::move(index);
  thread_.put(block);
}

void McapWriter::attach(std::string_view name, std::string_view media_type,
                        std::uint64_t log_time_ns, Bytes data) {
  ByteBuffer attachment;
  {
    const Record record(attachment, kAttachment);
    attachment.put(log_time_ns);
    attachment.put(log_time_ns);  // Time of creation.
    attachment.put_string(name);
    attachment.put_string(media_type);
    attachment.put(static_cast<std::uint64_t>(data.size()));
    attachment.append(data);
    attachment.put(crc32(attachment.bytes().subspan(kRecordHeader)));
  }
  ByteBuffer index;
  {
    const Record record(index, kAttachmentIndex);
    index.put(std::uint64_t{0});  // McapFile knows the offset.
    index.put(static_cast<std::uint64_t>(attachment.size()));
    index.put(log_time_ns);
    index.put(log_time_ns);
    index.put(static_cast<std::uint64_t>(data.size()));
    index.put_string(name);
    index.put_string(media_type);
  }
  put_record(attachment, index);
  ++attachments_;
}

void McapWriter::add_metadata(std::string_view name, const TextMap& entries) {
  ByteBuffer metadata;
  {
    const Record record(metadata, kMetadata);
    metadata.put_string(name);
    put_map(metadata, entries);
  }
  ByteBuffer index;
  {
    const Record record(index, kMetadataIndex);
    index.put(std::uint64_t{0});  // McapFile knows the offset.
    index.put(static_cast<std::uint64_t>(metadata.size()));
    index.put_string(name);
  }
  put_record(metadata, index);
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
  out.put(static_cast<std::uint32_t>(sequences_.size()));
  out.put(attachments_);
  out.put(metadata_);
  out.put(std::uint32_t{0});  // McapFile knows the number of chunks.
  out.put(first_ns_);
  out.put(last_ns_);
  put_sized(out, [&] {
    for (std::size_t k = 0; k < sequences_.size(); ++k) {
      if (sequences_[k] == 0) continue;
      out.put(static_cast<ChannelId>(k + 1));
      out.put(static_cast<std::uint64_t>(sequences_[k]));
    }
  });
}

LogSummary McapWriter::close() {
  end_chunk();
  thread_.finish();
  ByteBuffer all_statistics = statistics();
  file_.close(schema_records_.bytes(), channel_records_.bytes(), all_statistics);
  return {path(), file_.sha256(), messages_, file_.size()};
}

}  // namespace rosflight::log
