// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// Sixteen channels of eleven bits, packed with the lowest bit first, as S.Bus and CRSF send them.
inline std::array<std::uint16_t, 16> unpack_channels(const std::uint8_t* data) {
  std::array<std::uint16_t, 16> channels{};
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (std::uint16_t& channel : channels) {
    while (count < 11) {
      bits |= static_cast<std::uint32_t>(*data++) << count;
      count += 8;
    }
    channel = static_cast<std::uint16_t>(bits & 0x7FFu);
    bits >>= 11;
    count -= 11;
  }
  return channels;
}

/// What the decoders of pilots' receivers share: frames for the main loop, and what went wrong.
class ReceiverInput : public ByteReceiver, public hal::Source<hal::RcFrame> {
 public:
  static constexpr std::uint8_t kQualityUnknown = 255;

  /// Main loop. Frames come in order; none is produced while the line is silent.
  bool poll(hal::RcFrame& frame) override { return frames_.take(frame); }
  /// Bus context or main loop, as all below. Frames decoded, frames damaged and dropped, bytes outside
  /// frames.
  virtual std::uint32_t good() const = 0;
  virtual std::uint32_t bad() const = 0;
  virtual std::uint32_t strays() const = 0;
  /// Share of the transmitter's packets that the receiver got, 0..100 %; kQualityUnknown if the
  /// protocol does not say.
  virtual std::uint8_t link_quality_percent(Time now) const = 0;
  /// The same as the signal strength of MAVLink's RC_CHANNELS: 0..254, 255 if unknown.
  std::uint8_t rssi(Time now) const {
    const std::uint8_t quality = link_quality_percent(now);
    return quality == kQualityUnknown ? kQualityUnknown
                                      : static_cast<std::uint8_t>(quality * 254 / 100);
  }

 protected:
  ~ReceiverInput() = default;
  void deliver(const hal::RcFrame& frame) { static_cast<void>(frames_.put(frame)); }

 private:
  Handover<hal::RcFrame> frames_;
};

}  // namespace rosflight::boards::parts
