// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <stdexcept>
#include <string>

#include "log/byte_buffer.hpp"
#include "log/sha256.hpp"

namespace rosflight::log {

/// A file could not be written, or a log was asked for something impossible. One line, path first.
class LogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that is complete or not there: written as NAME.part, renamed to NAME by commit(). Without
/// commit() (an exception, a crash) the part stays, under a name nobody takes for the result, and
/// an older NAME stays as it was. Buffered; fingerprints what it writes.
class OutputFile {
 public:
  /// @throws LogError if NAME.part cannot be created, or NAME is a folder.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// @throws LogError if the disk is full or broken; the file is then past saving.
  void write(Bytes bytes);

  /// Writes the rest, closes and renames. Call once, last. @throws LogError as write().
  void commit();

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< Bytes given to write() so far.
  /// Fingerprint of the whole file; of use after commit().
  std::string sha256() const { return sha256_.hex(); }

 private:
  void flush();
  void write_through(Bytes bytes);
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path path_;
  std::filesystem::path part_;
  int file_{-1};
  ByteBuffer buffer_;
  std::uint64_t size_{0};
  Sha256 sha256_;
};

/// Writes a whole file at once, by the same rules.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace rosflight::log
