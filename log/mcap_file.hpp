// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "log/byte_buffer.hpp"
#include "log/checksums.hpp"
#include "log/output_file.hpp"

struct ZSTD_CCtx_s;

namespace rosflight::log {

enum class Compression : std::uint8_t {
  kNone,
  kZstd,     ///< Level 6.
  kZstdFast  ///< A fifth of its processor time for 5 % more bytes.
};

/// The file of McapWriter: chunks with message indexes, attachments, metadata, and a summary with
/// statistics, chunk, attachment and metadata indexes; checksums of chunks (zstd's own),
/// attachments and the summary.
///
///     magic Header { Chunk MessageIndex* | Attachment | Metadata }* DataEnd
///     Schema* Channel* Statistics ChunkIndex* AttachmentIndex* MetadataIndex* SummaryOffset*
///     Footer magic
///
/// Also computes the identity of the contents: SHA-256 over every Schema, Channel, Message,
/// Attachment and Metadata record, whole (opcode, length, contents) and uncompressed, in the order
/// of the file. Chunks, their compression, indexes, checksums and the summary do not enter.
///
/// Any member may throw LogError.
class McapFile {
 public:
  struct Options {
    std::string profile{"ros2"};
    std::string library{"rosflight"};
    std::size_t chunk_bytes{std::size_t{512} << 10U};
    Compression compression{Compression::kZstd};
  };

  McapFile(std::filesystem::path path, const Options& options);

  /// Schema, Channel and Message records that end up in one chunk.
  void write_chunk(Bytes records);

  /// An Attachment or Metadata record.
  /// @param index  Its index record for the summary, whose offset is still to be filled in.
  void write_record(Bytes record, ByteBuffer& index);

  /// @param schemas, channels  All of these records again, for the summary.
  /// @param statistics         The record, whose number of chunks is still to be filled in.
  void close(Bytes schemas, Bytes channels, ByteBuffer& statistics);

  /// Hash of the file; call it after close().
  std::string sha256() const { return sha256_.hex(); }
  std::uint64_t size() const { return file_.size(); }

 private:
  using IndexEntry = std::pair<std::uint64_t, std::uint64_t>;  ///< Time, offset in the chunk.
  struct SummaryGroup {
    std::uint8_t opcode{};
    std::uint64_t start{};
    std::uint64_t length{};
  };
  struct FreeZstd {
    void operator()(ZSTD_CCtx_s* context) const;
  };

  void emit(Bytes bytes);
  void emit_and_clear(ByteBuffer& record);
  Bytes compressed(Bytes records);
  /// Fills indexes_. @returns first and last time of the messages, 0 without one.
  std::pair<std::uint64_t, std::uint64_t> index_messages(Bytes records);
  void write_message_indexes(ByteBuffer& offsets);
  void write_summary(Bytes schemas, Bytes channels, Bytes statistics);
  void write_group(std::uint8_t opcode, Bytes records, std::vector<SummaryGroup>& groups);

  Compression compression_;
  OutputFile file_;
  bool in_summary_{false};
  std::uint32_t crc_{0};  ///< CRC of the summary so far.
  Sha256 sha256_;
  std::unique_ptr<ZSTD_CCtx_s, FreeZstd> zstd_;
  ByteBuffer scratch_;  ///< One record.
  ByteBuffer compressed_;
  std::vector<std::vector<IndexEntry>> indexes_;  ///< This chunk, by channel id.
  ByteBuffer chunk_indexes_;
  ByteBuffer attachment_indexes_;
  ByteBuffer metadata_indexes_;
  std::uint32_t chunks_{0};
};

}  // namespace rosflight::log
