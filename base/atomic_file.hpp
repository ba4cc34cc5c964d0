// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "base/file_descriptor.hpp"

namespace rosflight::base {

/// A file could not be written: one line, the path first.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a committed file survives.
enum class Durability {
  kProcess,  ///< The end of this process, at no cost.
  kPowerCut  ///< Also a power cut: file and folder are on the disk when commit() returns.
};

/// A file that is complete or not there: written as NAME.part, renamed to NAME by commit(). Without
/// commit() (an exception, a crash) the part stays, under a name that nobody takes for the result,
/// and an older NAME stays as it was. Not buffered.
class AtomicFile {
 public:
  /// @throws FileError  NAME.part cannot be created, or NAME is a folder.
  explicit AtomicFile(std::filesystem::path path);

  /// @throws FileError  the disk is full or broken.
  void write(const void* data, std::size_t size);
  /// Closes and renames. Call once, last. @throws FileError as write().
  void commit(Durability durability = Durability::kProcess);

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& part() const { return part_; }

 private:
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path path_;
  std::filesystem::path part_;
  FileDescriptor file_;
};

/// Writes a whole file by the same rules; after a failure no part stays.
/// @throws FileError  as AtomicFile.
void write_file(const std::filesystem::path& path, std::string_view text,
                Durability durability = Durability::kProcess);

/// A new or renamed file survives a power cut only when its folder is on the disk as well.
void sync_folder_of(const std::filesystem::path& file);

}  // namespace rosflight::base
