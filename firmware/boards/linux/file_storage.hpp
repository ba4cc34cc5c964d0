// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

#include "base/file_descriptor.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// Non-volatile memory in a file: byte k of the memory is byte k of the file, written in place in
/// ascending order; flush() returns when the disk has it. Bytes that were never written read 0xFF.
///
/// A file that is too short (a copy that was cut off) is filled up with blank bytes; what the
/// missing part meant is the reader's to judge. Locked while open, so that two boards never share
/// a memory.
class FileStorage final : public hal::Storage {
 public:
  static constexpr std::size_t kSize = 16384;

  /// Opens the file, or creates it blank.
  /// @throws LinuxError  no such folder, no permission, no plain file, longer than `size`, disk
  /// full, or in use by another board.
  explicit FileStorage(const std::filesystem::path& file, std::size_t size = kSize);

  std::size_t size() const override { return size_; }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override;
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override;
  bool flush() override;

  /// The file was not there before.
  bool created() const { return created_; }

 private:
  bool inside(std::size_t offset, std::size_t count) const {
    return offset <= size_ && count <= size_ - offset;
  }

  base::FileDescriptor file_;
  std::size_t size_;
  bool created_{false};
};

}  // namespace rosflight::boards
