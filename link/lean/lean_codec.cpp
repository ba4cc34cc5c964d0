// SPDX-License-Identifier: BSD-3-Clause
#include "link/lean/lean_codec.hpp"

#include <algorithm>
#include <cstring>

#include "link/lean/wire_table.hpp"

namespace rosflight::link {
namespace {

using namespace lean;  // NOLINT(google-build-using-namespace): its only user

/// Code and id, which determine the length of a frame.
constexpr std::uint8_t kPrefixBytes = 2;

}  // namespace

LeanCodec::LeanCodec(std::uint32_t schema) : next_{schema == 0 ? kSchema : schema, 0} {
  mismatch_.ours = next_.schema;
}

bool LeanCodec::encode(const Message& message, Frame& frame) {
  const std::size_t id = message.index();
  if (!is_known(id)) {
    frame.size = 0;
    return false;
  }
  ++counters_.frames_sent;
  const Sender sender = next_;
  ++next_.sequence;
  kRows[id].encode(message, sender, frame);
  return true;
}

Codec::Decoded LeanCodec::decode(const std::uint8_t* data, std::size_t size) {
  std::size_t at = 0;
  while (at < size) {
    if (wanted_ == 0) {
      const void* const start =
          data[at] == kStart ? data + at : std::memchr(data + at, kStart, size - at);
      if (start == nullptr) break;
      at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(start) - data) + 1;
      begin_frame();
    } else if (held_size_ < kPrefixBytes) {
      take_prefix(data[at++]);
    } else {
      const std::size_t run = std::min<std::size_t>(size - at, wanted_ - held_size_);
      if (const void* const start = std::memchr(data + at, kStart, run)) {
        at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(start) - data) + 1;
        ++counters_.frames_dropped;
        begin_frame();
        continue;
      }
      std::memcpy(held_.data() + held_size_, data + at, run);
      held_size_ = static_cast<std::uint8_t>(held_size_ + run);
      at += run;
      if (held_size_ < wanted_) break;
      wanted_ = 0;
      if (accept()) return {at, true};
      ++counters_.frames_dropped;
    }
  }
  return {size, false};
}

void LeanCodec::begin_frame() {
  held_size_ = 0;
  wanted_ = kPrefixBytes;
}

/// Code, then id: behind that it is known how long the frame is.
void LeanCodec::take_prefix(std::uint8_t byte) {
  if (byte == kStart) {
    ++counters_.frames_dropped;
    begin_frame();
    return;
  }
  held_[held_size_++] = byte;
  if (held_size_ < kPrefixBytes) return;
  if (is_known(byte)) {
    wanted_ = static_cast<std::uint8_t>(kRows[byte].length + kOverheadBytes - kCodeAt);
  } else {
    wanted_ = 0;
    ++counters_.frames_dropped;
  }
}

/// Takes the whole frame in held_. @returns whether it is a message.
bool LeanCodec::accept() {
  const std::size_t id = held_[kIdAt - kCodeAt];
  const std::size_t crc_at = held_size_ - kChecksumBytes;
  const unsigned seed = id == kGreetingId ? 0u : seed_of(next_.schema);
  std::uint8_t* const frame = held_.data();
  if (!unstuff(frame, held_size_)) return false;
  std::uint16_t crc = 0;
  std::memcpy(&crc, frame + crc_at, kChecksumBytes);
  constexpr std::size_t kFrom = kIdAt - kCodeAt;
  // Read again: a chain that goes through the id makes it FF, which is none.
  if (frame[kFrom] != id || (checksum(frame + kFrom, crc_at - kFrom) ^ seed) != crc) {
    return false;
  }
  const std::uint8_t* const payload = frame + kPayloadAt - kCodeAt;
  if (id == kGreetingId) {
    if (!accept_greeting(payload)) return false;
  } else {
    if (refused_) return false;
    kRows[id].unpack(payload, message_);
  }
  sequence_.count(frame[kSequenceAt - kCodeAt], counters_);
  ++counters_.frames_received;
  return true;
}

bool LeanCodec::accept_greeting(const std::uint8_t* payload) {
  Greeting greeting;
  unpack(payload, greeting);
  mismatch_.theirs = greeting.schema;
  refused_ = mismatch_.theirs != mismatch_.ours;
  if (!refused_) message_.emplace<Heartbeat>().type = greeting.type;
  return !refused_;
}

}  // namespace rosflight::link
