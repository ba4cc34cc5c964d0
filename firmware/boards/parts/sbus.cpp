// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/sbus.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kHeader = 0x0F;
constexpr std::size_t kFlags = 23, kFooter = 24;
constexpr unsigned kFrameLost = 1u << 2, kFailsafe = 1u << 3;
constexpr std::size_t kProportional = 16, kTwoState = 8;

bool is_footer(std::uint8_t byte) {
  return byte == 0x00 || byte == 0x04 || (byte & 0xCFu) == 0x04;
}

}  // namespace

void SbusInput::receive(const std::uint8_t* data, std::size_t size, Time last) {
  for (std::size_t k = 0; k < size; ++k) {
    take(data[k], last - static_cast<std::int64_t>(size - 1 - k) * kByte);
  }
}

void SbusInput::take(std::uint8_t byte, Time end) {
  const bool after_silence = !started_ || end - last_ - kByte >= kGap;
  started_ = true;
  last_ = end;
  if (after_silence) {
    if (stage_ == Stage::kFrame) ++bad_;  // shorter than 25 bytes
    size_ = 0;
    stage_ = byte == kHeader ? Stage::kFrame : Stage::kGarbage;
  }
  if (stage_ != Stage::kFrame) {
    ++strays_;
    return;
  }
  buffer_[size_++] = byte;
  if (size_ == kFrameBytes) finish(end);
}

void SbusInput::finish(Time end) {
  stage_ = Stage::kGarbage;  // until silence
  if (!is_footer(buffer_[kFooter])) {
    ++bad_;
    return;
  }
  ++good_;
  const unsigned flags = buffer_[kFlags];
  hal::RcFrame frame;
  frame.stamp = end - hal::milliseconds(3);
  const auto raw = unpack_channels(&buffer_[1]);
  for (std::size_t k = 0; k < kProportional; ++k) {
    frame.channels[k] = (static_cast<float>(raw[k]) - 172.0f) / 1639.0f;
  }
  for (std::size_t k = 0; k < kTwoState; ++k) {
    frame.channels[kProportional + k] = (flags >> k & 1u) != 0 ? 0.0f : 1.0f;
  }
  frame.channel_count = kProportional + kTwoState;
  frame.frame_lost = (flags & kFrameLost) != 0;
  frame.failsafe = (flags & kFailsafe) != 0;
  deliver(frame);
}

/// The byte may have been the first of a frame or one in it.
void SbusInput::line_error(Time when) {
  if (stage_ == Stage::kFrame) ++bad_;
  stage_ = Stage::kGarbage;
  started_ = true;
  last_ = when;
}

}  // namespace rosflight::boards::parts
