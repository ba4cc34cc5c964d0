// SPDX-License-Identifier: BSD-3-Clause
#include "link/detect/detecting_codec.hpp"

#include <algorithm>
#include <cstring>

namespace rosflight::link {

static_assert(2 * lean::kMaxLeanFrameBytes <= kMaxFrameBytes,
              "a greeting and a message in one piece");

const Codec& DetectingCodec::active() const {
  if (protocol_ == Protocol::kLean) return lean_;
  return mavlink_;
}

Codec& DetectingCodec::active() {
  if (protocol_ == Protocol::kLean) return lean_;
  return mavlink_;
}

bool DetectingCodec::encode(const Message& message, Frame& frame) {
  if (!greet_ || message.index() == 0) return active().encode(message, frame);
  greet_ = false;
  Frame greeting;
  lean_.encode(Heartbeat{}, greeting);
  lean_.encode(message, frame);
  std::memmove(frame.bytes.data() + greeting.size, frame.bytes.data(), frame.size);
  std::memcpy(frame.bytes.data(), greeting.bytes.data(), greeting.size);
  frame.size += greeting.size;
  return true;
}

void DetectingCodec::set_system_id(std::uint8_t id) {
  mavlink_.set_system_id(id);
  lean_.set_system_id(id);
}

Codec::Decoded DetectingCodec::decode(const std::uint8_t* data, std::size_t size) {
  std::size_t used = 0;
  while (used < size) {
    if (protocol_ == Protocol::kUnknown) {
      const Decoded result = detect(data + used, size - used);
      return {used + result.consumed, result.complete};
    }
    const std::size_t run = std::min(size - used, kMaxBytesWithoutMessage - silent_bytes_);
    const Decoded result = active().decode(data + used, run);
    used += result.consumed;
    if (result.complete) {
      silent_bytes_ = 0;
      return {used, true};
    }
    silent_bytes_ += result.consumed;
    if (silent_bytes_ == kMaxBytesWithoutMessage) {
      protocol_ = Protocol::kUnknown;
      greet_ = false;
      silent_bytes_ = 0;
    }
  }
  return {used, false};
}

/// Byte by byte, so that the first message wins wherever the bytes are cut. A codec may complete a
/// message that it held without eating the byte: that one comes again.
Codec::Decoded DetectingCodec::detect(const std::uint8_t* data, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) {
    const Decoded mavlink = mavlink_.decode(data + k, 1);
    if (mavlink.complete) {
      protocol_ = Protocol::kMavlink;
      return {k + mavlink.consumed, true};
    }
    const Decoded lean = lean_.decode(data + k, 1);
    if (lean.complete) {
      protocol_ = Protocol::kLean;
      greet_ = true;
      return {k + lean.consumed, true};
    }
  }
  return {size, false};
}

}  // namespace rosflight::link
