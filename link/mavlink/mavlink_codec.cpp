// SPDX-License-Identifier: BSD-3-Clause
#include "link/mavlink/mavlink_codec.hpp"

#include <algorithm>
#include <cstring>

#include "link/mavlink/checksum.hpp"
#include "link/mavlink/wire_table.hpp"

namespace rosflight::link {

const mavlink::Table& mavlink::all_messages() {
  return kTable<false>;
}
const mavlink::Table& mavlink::fcu_messages() {
  return kTable<true>;
}

namespace {

using mavlink::kHeaderBytes;
using mavlink::kOverheadBytes;
using mavlink::kStartByte;

constexpr std::size_t frame_bytes(const std::uint8_t* frame) {
  return frame[1] + kOverheadBytes;
}

const std::uint8_t* find_start(const std::uint8_t* data, const std::uint8_t* end) {
  if (data != end && *data == kStartByte) return data;
  const auto size = static_cast<std::size_t>(end - data);
  return static_cast<const std::uint8_t*>(std::memchr(data, kStartByte, size));
}

/// Whether the complete frame at `frame`, whose id has row `row`, carries the right checksum.
bool intact(const std::uint8_t* frame, const mavlink::Row& row) {
  const std::size_t payload = frame[1];
  const std::uint16_t crc = mavlink::checksum(frame + 1, payload + kHeaderBytes - 1, row.crc_extra);
  return crc == mavlink::load<std::uint16_t>(frame + kHeaderBytes + payload);
}

}  // namespace

bool MavlinkCodec::encode(const Message& message, Frame& frame) {
  const std::size_t index = message.index();
  frame.size = 0;
  if (index >= messages_->rows.size()) return false;
  const mavlink::Row& row = messages_->rows[index];
  if (row.pack == nullptr) return false;  // std::monostate too
  ++counters_.frames_sent;
  mavlink::Sender sender = next_;
  ++next_.sequence;
  sender.message_id = row.id;
  if (row.id == MAVLINK_MSG_ID_PARAM_VALUE &&
      sender.component_id == MAV_COMP_ID_ROSFLIGHT_FIRMWARE) {
    sender.component_id = MAV_COMP_ID_ALL;
  }
  std::uint8_t* const bytes = frame.bytes.data();
  bytes[0] = kStartByte;
  bytes[1] = row.length;
  std::memcpy(bytes + 2, &sender, sizeof sender);
  row.pack(message, bytes + kHeaderBytes);
  const std::size_t covered = kHeaderBytes - 1 + row.length;
  const std::uint16_t crc = mavlink::checksum(bytes + 1, covered, row.crc_extra);
  std::memcpy(bytes + 1 + covered, &crc, sizeof crc);
  frame.size = kOverheadBytes + row.length;
  return true;
}

Codec::Decoded MavlinkCodec::decode(const std::uint8_t* data, std::size_t size) {
  Decoded result{};
  if (size == 0 || (held_size_ > 0 && decode_held(data, size, result))) return result;
  const std::uint8_t* const end = data + size;
  while (const std::uint8_t* const start = find_start(data, end)) {
    const auto left = static_cast<std::size_t>(end - start);
    if (left < kHeaderBytes) {
      hold(start, left);
      break;
    }
    const mavlink::Row* const row = mavlink::find_row(*messages_, start[5]);
    if (row != nullptr && left < frame_bytes(start)) {
      hold(start, left);
      break;
    }
    if (row != nullptr && intact(start, *row)) {
      accept(start, *row);
      return {size - left + frame_bytes(start), true};
    }
    ++counters_.frames_dropped;
    data = start + 1;
  }
  return {size, false};
}

/// Goes on with the bytes kept from earlier calls; false once none of them is left and nothing was
/// found. Bytes of this call are only lent to held_: they are given back if the frame turns out
/// wrong, so what stays behind a frame in held_ always came from earlier calls.
bool MavlinkCodec::decode_held(const std::uint8_t* data, std::size_t size, Decoded& result) {
  std::uint8_t* const frame = held_.data();
  while (held_size_ > 0) {
    const std::size_t kept = held_size_;
    std::size_t lent = 0;
    const auto fill_up_to = [&](std::size_t wanted) {
      if (kept + lent >= wanted) return true;
      const std::size_t run = std::min(wanted - kept - lent, size - lent);
      std::memcpy(frame + kept + lent, data + lent, run);
      lent += run;
      return kept + lent == wanted;
    };
    bool right = false;
    bool whole = fill_up_to(kHeaderBytes);
    if (whole) {
      const mavlink::Row* const row = mavlink::find_row(*messages_, frame[5]);
      whole = row == nullptr || fill_up_to(frame_bytes(frame));
      right = whole && row != nullptr && intact(frame, *row);
      if (right) accept(frame, *row);
    }
    if (!whole) {
      held_size_ = static_cast<std::uint16_t>(kept + lent);
      result = {size, false};
      return true;
    }
    if (!right) ++counters_.frames_dropped;
    const std::size_t used = right ? std::min(frame_bytes(frame), kept) : 1;
    held_size_ = 0;
    if (const std::uint8_t* const next = find_start(frame + used, frame + kept)) {
      hold(next, static_cast<std::size_t>(frame + kept - next));
    }
    if (right) {
      result = {lent, true};
      return true;
    }
  }
  return false;
}

void MavlinkCodec::hold(const std::uint8_t* data, std::size_t size) {
  std::memmove(held_.data(), data, size);
  held_size_ = static_cast<std::uint16_t>(size);
}

void MavlinkCodec::accept(const std::uint8_t* frame, const mavlink::Row& row) {
  const std::size_t payload = frame[1];
  if (row.unpack == nullptr) {
    message_ = std::monostate{};
  } else if (payload >= row.length) {
    row.unpack(frame + kHeaderBytes, message_);
  } else {
    std::array<std::uint8_t, mavlink::kMaxPayload> extended{};
    std::memcpy(extended.data(), frame + kHeaderBytes, payload);
    row.unpack(extended.data(), message_);
  }
  sequence_.count(frame[2], counters_);
  ++counters_.frames_received;
}

}  // namespace rosflight::link
