// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "log/byte_buffer.hpp"
#include "log/checksums.hpp"
#include "log/mcap_writer.hpp"

namespace rosflight::log {

/// Reads a log of McapWriter from its start to its end, for programs that replay it. It reads what
/// this project writes: chunks without or with zstd; other programs have the libraries of the format.
class McapReader {
 public:
  struct Message {
    std::string_view topic;
    std::uint64_t log_time_ns{};
    Bytes data;  ///< Valid during the call.
  };

  /// Reads the whole file. @throws LogError  unreadable, or no MCAP file.
  explicit McapReader(const std::filesystem::path& path);

  /// Calls `use` for every message, in the order of the file, and fills the rest of this object.
  /// @throws LogError  the file is damaged or ends too early.
  void read(const std::function<void(const Message&)>& use);

  // After read():
  const TextMap& flight() const { return flight_; }  ///< Metadata record "flight".
  /// Identity of the contents, as LogSummary::sha256.
  std::string sha256() const { return sha256_.hex(); }
  /// Time of the first attachment: the start of the flight.
  std::uint64_t start_ns() const { return start_ns_; }

 private:
  void read_records(Bytes records, const std::function<void(const Message&)>& use, bool in_chunk);
  std::vector<std::uint8_t> unpacked(Bytes chunk) const;
  [[noreturn]] void damaged() const;

  std::filesystem::path path_;
  std::string file_;
  std::vector<std::string> topics_;  ///< By channel id.
  TextMap flight_;
  Sha256 sha256_;
  std::uint64_t start_ns_{0};
};

}  // namespace rosflight::log
