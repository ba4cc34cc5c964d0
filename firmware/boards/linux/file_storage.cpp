// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/file_storage.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "firmware/boards/linux/linux_error.hpp"

namespace rosflight::boards {
namespace {

LinuxError failure(const std::filesystem::path& file, const std::string& found,
                   const std::string& allowed) {
  return LinuxError{file.string() + ": found " + found + ", allowed " + allowed};
}

LinuxError system_failure(const std::filesystem::path& file) {
  return failure(file, "'" + std::string{std::strerror(errno)} + "'",
                 "a file to read and write as non-volatile memory");
}

bool write_all(int fd, const std::uint8_t* data, std::size_t count, std::size_t offset) {
  while (count > 0) {
    const ssize_t n = ::pwrite(fd, data, count, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    offset += static_cast<std::size_t>(n);
    count -= static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

FileStorage::FileStorage(const std::filesystem::path& file, std::size_t size) : size_{size} {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  file_ = base::FileDescriptor{::open(file.c_str(), kFlags)};
  if (!file_.valid() && errno == ENOENT) {
    constexpr mode_t kEveryoneReads = 0644;
    file_ = base::FileDescriptor{::open(file.c_str(), kFlags | O_CREAT | O_EXCL, kEveryoneReads)};
    created_ = file_.valid();
  }
  if (!file_.valid()) throw system_failure(file);
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0) throw system_failure(file);
  if (!S_ISREG(status.st_mode)) throw failure(file, "something else", "a plain file");
  const auto present = static_cast<std::size_t>(status.st_size);
  if (present > size_) {
    throw failure(file, std::to_string(present) + " bytes",
                  "at most " + std::to_string(size_) + " of non-volatile memory");
  }
  if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    throw failure(file, "it in use by another process", "one process per memory");
  }
  if (present < size_) {
    const std::vector<std::uint8_t> blank(size_ - present, 0xFF);
    if (!write_all(file_.get(), blank.data(), blank.size(), present) || !flush()) {
      const LinuxError error = system_failure(file);
      if (created_) ::unlink(file.c_str());
      throw error;
    }
  }
  if (created_) base::sync_folder_of(file);
}

bool FileStorage::read(std::size_t offset, std::uint8_t* data, std::size_t count) {
  if (!inside(offset, count)) return false;
  while (count > 0) {
    const ssize_t n = ::pread(file_.get(), data, count, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    offset += static_cast<std::size_t>(n);
    count -= static_cast<std::size_t>(n);
  }
  return true;
}

bool FileStorage::write(std::size_t offset, const std::uint8_t* data, std::size_t count) {
  return inside(offset, count) && write_all(file_.get(), data, count, offset);
}

bool FileStorage::flush() {
  return ::fdatasync(file_.get()) == 0;
}

}  // namespace rosflight::boards
