// SPDX-License-Identifier: BSD-3-Clause
#include "log/output_file.hpp"

namespace rosflight::log {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;

}  // namespace

OutputFile::OutputFile(std::filesystem::path path)
    : file_(std::move(path)), buffer_(kBufferBytes) {}

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
  file_.write(bytes.data(), bytes.size());
}

void OutputFile::commit() {
  flush();
  file_.commit();
}

}  // namespace rosflight::log
