// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/fram.hpp"

#include <algorithm>

#include "firmware/boards/parts/text.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kWriteEnable = 0x06, kWriteBytes = 0x02, kReadBytes = 0x03,
                       kReadIdentity = 0x9F;
constexpr std::uint8_t kContinuation = 0x7F, kMaker = 0xC2, kFamily = 0x22;
constexpr std::size_t kContinuations = 6;

}  // namespace

bool Fram::identify() {
  out_[0] = kReadIdentity;
  const bool answered = exchange(1, kIdentityBytes);
  const auto end = in_.begin() + kContinuations;
  present_ = answered && std::all_of(in_.begin(), end, [](auto b) { return b == kContinuation; }) &&
             in_[6] == kMaker && in_[7] == kFamily;
  Text text{message_.data(), message_.size()};
  text.add("FRAM: ");
  if (present_) {
    text.add("ok");
  } else if (answered) {
    text.add("identity ")
        .hex(in_[6])
        .add(" ")
        .hex(in_[7])
        .add(", expected ")
        .hex(kMaker)
        .add(" ")
        .hex(kFamily);
  } else {
    text.add("bus fault");
  }
  return present_;
}

bool Fram::in_range(std::size_t offset, std::size_t count) const {
  return present_ && offset <= kBytes && count <= kBytes - offset;
}

std::size_t Fram::address(std::uint8_t command, std::size_t offset) {
  out_[0] = command;
  out_[1] = static_cast<std::uint8_t>(offset >> 8);
  out_[2] = static_cast<std::uint8_t>(offset & 0xFFu);
  return 3;
}

bool Fram::read(std::size_t offset, std::uint8_t* data, std::size_t count) {
  if (!in_range(offset, count)) return false;
  for (std::size_t at = 0; at < count; at += kChunk) {
    if (!read_chunk(offset + at, data + at, std::min(kChunk, count - at))) return false;
  }
  return true;
}

bool Fram::read_chunk(std::size_t offset, std::uint8_t* data, std::size_t count) {
  if (offset != ahead_offset_ || count > ahead_count_) {
    const std::size_t n = std::min(kChunk, kBytes - offset);
    if (!exchange(address(kReadBytes, offset), n)) return false;
    ahead_offset_ = offset;
    ahead_index_ = 0;
    ahead_count_ = n;
  }
  std::copy_n(in_.begin() + static_cast<std::ptrdiff_t>(ahead_index_), count, data);
  ahead_offset_ += count;
  ahead_index_ += count;
  ahead_count_ -= count;
  return true;
}

/// The part forgets the permission to write at the end of each write.
bool Fram::write(std::size_t offset, const std::uint8_t* data, std::size_t count) {
  if (!in_range(offset, count)) return false;
  for (std::size_t at = 0; at < count; at += kChunk) {
    const std::size_t n = std::min(kChunk, count - at);
    out_[0] = kWriteEnable;
    if (!exchange(1, 0)) return false;
    const std::size_t head = address(kWriteBytes, offset + at);
    std::copy_n(data + at, n, out_.begin() + static_cast<std::ptrdiff_t>(head));
    if (!exchange(head + n, 0)) return false;
  }
  return true;
}

/// A transfer that did not end in time may still be queued, so nothing is started before it has ended.
bool Fram::exchange(std::size_t out, std::size_t in) {
  if (wait_.load() == Wait::kPending) return false;
  ahead_count_ = 0;
  transfer_ = {out_.data(), out, in_.data(), in, this};
  wait_.store(Wait::kPending);
  const Time begun = clock_.now();
  if (!port_.start(transfer_)) {
    wait_.store(Wait::kNone);
    return false;
  }
  while (wait_.load() == Wait::kPending) {
    if (clock_.now() - begun >= kLimit) return false;
  }
  return wait_.load() == Wait::kDone;
}

void Fram::transfer_done(Transfer& /*transfer*/, TransferResult result, Time /*end*/) {
  wait_.store(result == TransferResult::kDone ? Wait::kDone : Wait::kFailed);
}

}  // namespace rosflight::boards::parts
