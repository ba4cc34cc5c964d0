// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "base/atomic_file.hpp"
#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// A log could not be written, or was asked for something impossible. One line, path first.
using LogError = base::FileError;

/// A base::AtomicFile with a buffer.
class OutputFile {
 public:
  /// @throws LogError if NAME.part cannot be created, or NAME is a folder.
  explicit OutputFile(std::filesystem::path path);

  /// @throws LogError if the disk is full or broken; the file is then past saving.
  void write(Bytes bytes);

  /// Writes the rest, closes and renames. Call once, last. @throws LogError as write().
  void commit();

  const std::filesystem::path& path() const { return file_.path(); }
  std::uint64_t size() const { return size_; }  ///< Bytes given to write() so far.

 private:
  void flush();
  void write_through(Bytes bytes);

  base::AtomicFile file_;
  ByteBuffer buffer_;
  std::uint64_t size_{0};
};

}  // namespace rosflight::log
