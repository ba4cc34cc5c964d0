// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/receiver_input.hpp"

namespace rosflight::boards::parts {

/// Futaba S.Bus: 100 000 baud, even parity, two stop bits, inverted. A frame has 25 bytes,
///
///     0x0F | 16 channels x 11 bits | flags | 0x00, 0x04, 0x14, 0x24 or 0x34
///
/// every 7 to 14 ms with silence in between. It has no checksum, so three things must fit: a frame begins
/// after silence of kGap, has no damaged byte (parity) and no silence inside, and ends with one of
/// those bytes. After garbage the next frame that begins after silence is taken.
///
/// A channel is (raw - 172) / 1639. Flags: bit 2 frame lost, bit 3 failsafe; as in ROSflight 2.x all
/// eight bits follow as channels 17 to 24, 0 if the bit is set and 1 if not. Stamp: the beginning of the
/// frame, 3 ms before its end.
class SbusInput final : public ReceiverInput {
 public:
  static constexpr UartFormat kFormat{100'000, true, 2, true};
  static constexpr std::size_t kFrameBytes = 25;
  static constexpr Time kByte{120};
  static constexpr Time kGap{1'000};

  void receive(const std::uint8_t* data, std::size_t size, Time last) override;
  void line_error(Time when) override;

  std::uint32_t good() const override { return good_; }
  std::uint32_t bad() const override { return bad_; }
  std::uint32_t strays() const override { return strays_; }
  std::uint8_t link_quality_percent(Time /*now*/) const override { return kQualityUnknown; }

 private:
  enum class Stage : std::uint8_t { kSilence, kFrame, kGarbage };

  void take(std::uint8_t byte, Time end);
  void finish(Time end);

  std::array<std::uint8_t, kFrameBytes> buffer_{};
  std::size_t size_{0};
  Stage stage_{Stage::kSilence};
  bool started_{false};
  Time last_{};
  std::uint32_t good_{0};
  std::uint32_t bad_{0};
  std::uint32_t strays_{0};
};

}  // namespace rosflight::boards::parts
