// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/byte_buffer.hpp"
#include "log/crc32.hpp"
#include "log/output_file.hpp"

namespace rosflight::log {

enum class Compression : std::uint8_t { kNone, kZstd };

/// String to string, sorted, as MCAP maps are.
using TextMap = std::map<std::string, std::string, std::less<>>;

/// What became of a log.
struct LogSummary {
  std::filesystem::path path;
  std::string sha256;  ///< Of the whole file, 64 hexadecimal digits.
  std::uint64_t messages{};
  std::uint64_t bytes{};
};

/// Writes one MCAP file (mcap.dev/spec, version 0): chunks with message indexes, attachments,
/// metadata, and a summary with statistics, chunk, attachment and metadata indexes; every checksum
/// the format has.
///
///     magic Header { Chunk MessageIndex* | Attachment | Metadata }* DataEnd
///     Schema* Channel* Statistics ChunkIndex* AttachmentIndex* MetadataIndex* SummaryOffset*
///     Footer magic
///
/// The same calls give the same bytes: times are the caller's, nothing is asked of the machine.
/// (With Compression::kZstd: the same bytes as long as the zstd library stays the same; so it is
/// not the default.) The file appears under its name only in close(); see OutputFile. Any member
/// may throw LogError.
class McapWriter {
 public:
  struct Options {
    std::string profile{"ros2"};
    std::string library{"rosflight"};  ///< No version here: it would change every fingerprint.
    std::size_t chunk_bytes{std::size_t{1} << 20U};
    Compression compression{Compression::kNone};
  };

  using SchemaId = std::uint16_t;
  using ChannelId = std::uint16_t;

  McapWriter(std::filesystem::path path, Options options);

  SchemaId add_schema(std::string_view name, std::string_view encoding, std::string_view text);
  ChannelId add_channel(std::string_view topic, SchemaId schema, std::string_view message_encoding,
                        const TextMap& metadata = {});

  /// Well under 1 us. Times need not rise, readers sort; `channel` comes from add_channel().
  void write(ChannelId channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
             Bytes data);

  /// A file inside the file. Ends the current chunk.
  void attach(std::string_view name, std::string_view media_type, std::uint64_t log_time_ns,
              Bytes data);

  /// A named table. Ends the current chunk.
  void add_metadata(std::string_view name, const TextMap& entries);

  /// Writes the rest and gives the file its name. Nothing may be called afterwards.
  LogSummary close();

  const std::filesystem::path& path() const { return file_.path(); }

 private:
  struct Channel {
    std::uint32_t sequence{0};                                   ///< Messages so far.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< Of this chunk: time, offset.
    bool sorted{true};
  };
  struct SummaryGroup {
    std::uint8_t opcode{};
    std::uint64_t start{};
    std::uint64_t length{};
  };

  void emit(Bytes bytes);
  void emit_and_clear(ByteBuffer& record);
  void end_chunk();
  Bytes compress_chunk();
  void write_message_indexes(ByteBuffer& offsets);
  void write_summary();
  void write_group(std::uint8_t opcode, Bytes records, std::vector<SummaryGroup>& groups);
  ByteBuffer statistics() const;
  void put_statistics(ByteBuffer& out) const;

  OutputFile file_;
  Options options_;
  Crc32 crc_;           ///< Of the section being written: data, then summary.
  ByteBuffer scratch_;  ///< One record.
  ByteBuffer chunk_;
  ByteBuffer compressed_;
  std::uint64_t chunk_start_ns_{};
  std::uint64_t chunk_end_ns_{};
  bool chunk_has_messages_{false};

  std::vector<Channel> channels_;  ///< Channel id k + 1 is entry k.
  ByteBuffer schema_records_;      ///< Repeated in the summary.
  ByteBuffer channel_records_;
  ByteBuffer chunk_indexes_;
  ByteBuffer attachment_indexes_;
  ByteBuffer metadata_indexes_;
  SchemaId schemas_{0};
  std::uint32_t attachments_{0};
  std::uint32_t metadata_{0};
  std::uint32_t chunks_{0};
  std::uint64_t messages_{0};
  std::uint64_t first_ns_{};
  std::uint64_t last_ns_{};
};

}  // namespace rosflight::log
