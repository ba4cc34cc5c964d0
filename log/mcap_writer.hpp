// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "log/block_thread.hpp"
#include "log/byte_buffer.hpp"
#include "log/mcap_file.hpp"

namespace rosflight::log {

/// String to string, sorted, as MCAP maps are.
using TextMap = std::map<std::string, std::string, std::less<>>;

/// What became of a log.
struct LogSummary {
  std::filesystem::path path;
  std::string sha256;  ///< Identity of the contents (McapFile), 64 hexadecimal digits.
  std::uint64_t messages{};
  std::uint64_t bytes{};  ///< Size of the file.
};

/// Writes a log as one MCAP file (mcap.dev/spec, version 0).
///
/// The caller's thread only appends messages to a chunk; hash, compression and the file are the work
/// of a second thread (BlockThread, McapFile). The same calls give the same LogSummary::sha256 with
/// any compression, chunk size and library version: times are the caller's, nothing is asked of the
/// machine. The file appears under its name only in close(). Any member may throw LogError; an error
/// of the disk is thrown by one of the calls after it, at the latest by close().
class McapWriter {
 public:
  using Options = McapFile::Options;
  using SchemaId = std::uint16_t;
  using ChannelId = std::uint16_t;

  McapWriter(std::filesystem::path path, const Options& options);

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

  const std::filesystem::path& path() const { return path_; }

 private:
  void end_chunk();
  /// Gives a whole record, with what the summary says about it, to the thread.
  void put_record(ByteBuffer& record, ByteBuffer& index);
  ByteBuffer statistics() const;
  void put_statistics(ByteBuffer& out) const;

  std::filesystem::path path_;
  std::size_t chunk_bytes_;
  McapFile file_;  ///< Belongs to the thread until close().
  BlockThread::Block chunk_;
  ByteBuffer schema_records_;  ///< Repeated in the summary.
  ByteBuffer channel_records_;
  std::vector<std::uint32_t> sequences_;  ///< Messages so far; channel id k + 1 is entry k.
  SchemaId schemas_{0};
  std::uint32_t attachments_{0};
  std::uint32_t metadata_{0};
  std::uint64_t messages_{0};
  std::uint64_t first_ns_{};
  std::uint64_t last_ns_{};
  BlockThread thread_;  ///< Last: uses file_.
};

}  // namespace rosflight::log
