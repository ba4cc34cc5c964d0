// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <unistd.h>

#include <utility>

namespace rosflight::base {

/// Owns an open file of the operating system.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_{fd} {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_{other.release()} {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor() { close(); }

  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  /// Gives the file to the caller, who closes it.
  int release() { return std::exchange(fd_, -1); }
  /// @returns false if the operating system reports an error, such as a late write error; the file
  /// is closed all the same.
  bool close() { return fd_ < 0 || ::close(release()) == 0; }

 private:
  int fd_{-1};
};

}  // namespace rosflight::base
