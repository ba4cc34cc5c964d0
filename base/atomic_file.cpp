// SPDX-License-Identifier: BSD-3-Clause
#include "base/atomic_file.hpp"

#include <fcntl.h>

#include <cerrno>
#include <system_error>

namespace rosflight::base {

void sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.parent_path();
  const FileDescriptor folder{
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (folder.valid()) static_cast<void>(::fsync(folder.get()));
}

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_{std::move(path)}, part_{path_.string() + ".part"} {
  std::error_code ignored;
  if (path_.filename().empty() || std::filesystem::is_directory(path_, ignored)) {
    throw FileError{path_.string() + ": cannot write: it is a folder, not a file"};
  }
  constexpr int kMode = 0666;  // the user's umask takes away from this
  file_ = FileDescriptor{::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode)};
  if (!file_.valid()) fail("cannot create", errno);
}

void AtomicFile::fail(const char* what, int error) const {
  throw FileError{part_.string() + ": " + what + ": " + std::generic_category().message(error)};
}

void AtomicFile::write(const void* data, std::size_t size) {
  const auto* next = static_cast<const std::byte*>(data);
  while (size > 0) {
    const ssize_t count = ::write(file_.get(), next, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("cannot write", count < 0 ? errno : ENOSPC);
    next += count;
    size -= static_cast<std::size_t>(count);
  }
}

void AtomicFile::commit(Durability durability) {
  const bool durable = durability == Durability::kPowerCut;
  if (durable && ::fsync(file_.get()) != 0) fail("cannot write", errno);
  if (!file_.close()) fail("cannot close", errno);
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) fail("cannot rename to its final name", error.value());
  if (durable) sync_folder_of(path_);
}

void write_file(const std::filesystem::path& path, std::string_view text, Durability durability) {
  AtomicFile file{path};
  try {
    file.write(text.data(), text.size());
    file.commit(durability);
  } catch (const FileError&) {
    std::error_code ignored;
    std::filesystem::remove(file.part(), ignored);
    throw;
  }
}

}  // namespace rosflight::base
