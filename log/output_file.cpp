// SPDX-License-Identifier: BSD-3-Clause
#include "log/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace rosflight::log {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;

}  // namespace

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), part_(path_.string() + ".part"), buffer_(kBufferBytes) {
  std::error_code ignored;
  if (path_.filename().empty() || std::filesystem::is_directory(path_, ignored)) {
    throw LogError(path_.string() + ": cannot write: it is a folder, not a file");
  }
  constexpr int kMode = 0666;  // The user's umask takes away from this.
  file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (file_ < 0) fail("cannot create", errno);
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
}

void OutputFile::fail(const char* what, int error) const {
  throw LogError(part_.string() + ": " + what + ": " + std::generic_category().message(error));
}

void OutputFile::write(Bytes bytes) {
  size_ += bytes.size();
  if (buffer_.size() + bytes.size() > kBufferBytes) flush();
  if (bytes.size() >= kBufferBytes) {
    write_through(bytes);
  } else {
    buffer_.append(bytes);
  }
}

void OutputFile::flush() {
  write_through(buffer_.bytes());
  buffer_.clear();
}

void OutputFile::write_through(Bytes bytes) {
  sha256_.update(bytes);
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("cannot write", count < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void OutputFile::commit() {
  flush();
  const int file = file_;
  file_ = -1;
  if (::close(file) != 0) fail("cannot close", errno);
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) fail("cannot rename to its final name", error.value());
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(as_bytes(text));
  file.commit();
}

}  // namespace rosflight::log
