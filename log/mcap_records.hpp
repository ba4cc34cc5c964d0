// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// Kinds of MCAP records (mcap.dev/spec).
enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

constexpr std::size_t kRecordHeader = 1 + 8;  ///< Opcode and length.

/// Appends one record to a buffer; the length is filled in at the end of the scope.
class Record {
 public:
  Record(ByteBuffer& out, Opcode opcode) : out_(out) {
    out.put(static_cast<std::uint8_t>(opcode));
    length_at_ = out.size();
    out.put(std::uint64_t{0});
  }
  ~Record() { out_.patch(length_at_, static_cast<std::uint64_t>(out_.size() - length_at_ - 8)); }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

 private:
  ByteBuffer& out_;
  std::size_t length_at_{};
};

/// Appends a map or list: its size in bytes, then what `fill` puts.
template <class Fill>
void put_sized(ByteBuffer& out, const Fill& fill) {
  const std::size_t size_at = out.size();
  out.put(std::uint32_t{0});
  fill();
  out.patch(size_at, static_cast<std::uint32_t>(out.size() - size_at - 4));
}

}  // namespace rosflight::log
