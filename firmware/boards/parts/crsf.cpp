// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/crsf.hpp"

#include <algorithm>

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kToFlightController = 0xC8;
constexpr std::uint8_t kChannels = 0x16, kLinkStatistics = 0x14;
constexpr std::size_t kChannelsBytes = 22, kStatisticsBytes = 10;
constexpr std::size_t kUplinkQuality = 2;
constexpr std::size_t kAround = 4;  // address, length, type, CRC
constexpr std::uint32_t kBitsPerByte = 10;
constexpr std::uint32_t kMicrosecondsPerSecond = 1'000'000;

}  // namespace

std::uint8_t CrsfFormat::crc8(const std::uint8_t* data, std::size_t size) {
  unsigned crc = 0;
  for (std::size_t k = 0; k < size; ++k) {
    crc ^= data[k];
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1 ^ ((crc & 0x80u) != 0 ? 0xD5u : 0u)) & 0xFFu;
  }
  return static_cast<std::uint8_t>(crc);
}

Finding CrsfFormat::inspect(const std::uint8_t* data, std::size_t size) {
  if (data[0] != kToFlightController) return {Finding::kStray};
  if (size < 2) return {Finding::kMore};
  const std::size_t length = data[1];
  if (length < 2 || length > kMaxLength - 2) return {Finding::kStray};
  if (size < length + 2) return {Finding::kMore};
  const bool right = crc8(data + 2, length - 1) == data[length + 1];
  return {right ? Finding::kFrame : Finding::kDamaged, length + 2};
}

void CrsfInput::receive(const std::uint8_t* data, std::size_t size, Time last) {
  if (size == 0) return;
  const auto on_the_wire = [](std::size_t bytes) {
    // 32 bits hold those of 400 bytes, more than any receiver is given at once.
    return Time{static_cast<std::uint32_t>(bytes) * kBitsPerByte * kMicrosecondsPerSecond /
                kFormat.baud};
  };
  if (last - on_the_wire(size) - last_ >= kGap) framer_.interrupt();
  last_ = last;
  for (std::size_t k = 0; k < size; ++k) {
    const Time end = last - on_the_wire(size - 1 - k);
    framer_.take(data[k], [this, end, &on_the_wire](const std::uint8_t* frame, std::size_t bytes) {
      use(frame, bytes, end - on_the_wire(bytes));
    });
  }
}

void CrsfInput::line_error(Time when) {
  framer_.interrupt();
  last_ = when;
}

void CrsfInput::use(const std::uint8_t* frame, std::size_t size, Time stamp) {
  const std::uint8_t type = frame[2];
  const std::uint8_t* const payload = frame + 3;
  if (type == kLinkStatistics && size == kStatisticsBytes + kAround) {
    quality_ = std::min<std::uint8_t>(payload[kUplinkQuality], 100);
    statistics_at_ = stamp;
    have_statistics_ = true;
  } else if (type == kChannels && size == kChannelsBytes + kAround) {
    hal::RcFrame rc;
    rc.stamp = stamp;
    const auto raw = unpack_channels(payload);
    for (std::size_t k = 0; k < raw.size(); ++k) {
      rc.channels[k] = ((static_cast<float>(raw[k]) - 992.0f) * 0.625f + 500.0f) / 1000.0f;
    }
    rc.channel_count = static_cast<std::uint8_t>(raw.size());
    rc.failsafe = link_quality_percent(stamp) == 0;
    deliver(rc);
  }
}

std::uint8_t CrsfInput::link_quality_percent(Time now) const {
  const bool current = have_statistics_ && now - statistics_at_ < kStatisticsTimeout;
  return current ? quality_ : kQualityUnknown;
}

}  // namespace rosflight::boards::parts
