// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/framer.hpp"
#include "firmware/boards/parts/receiver_input.hpp"

namespace rosflight::boards::parts {

/// Frames of the Crossfire protocol:
///
///     0xC8 | length of what follows, 2..62 | type | payload | CRC-8 of type and payload
struct CrsfFormat {
  static constexpr std::size_t kMaxLength = 64;
  static Finding inspect(const std::uint8_t* data, std::size_t size);
  /// Polynomial 0xD5, start 0, not reflected (DVB-S2). Check value of "123456789": 0xBC.
  static std::uint8_t crc8(const std::uint8_t* data, std::size_t size);
};

/// TBS Crossfire and ExpressLRS receivers: 420 000 baud, 8N1, up to 1000 frames per second. Frames of
/// channels (type 0x16) and of link statistics (0x14) are used, others ignored. A channel is
///
///     (raw - 992) 5/8 us + 1500 us, as a fraction of 1000..2000 us
///
/// Receivers fall silent when the transmitter is gone; some go on with a link quality of 0, which counts
/// as failsafe. Stamp: the end of the frame less its length on the wire.
class CrsfInput final : public ReceiverInput {
 public:
  static constexpr UartFormat kFormat{420'000, false, 1, false};
  /// Statistics older than this do not describe the present state.
  static constexpr Time kStatisticsTimeout = hal::milliseconds(1000);
  static constexpr Time kGap{2'000};  ///< Silence within a frame ends it.

  void receive(const std::uint8_t* data, std::size_t size, Time last) override;
  void line_error(Time when) override;

  std::uint32_t good() const override { return framer_.frames(); }
  std::uint32_t bad() const override { return framer_.damaged(); }
  std::uint32_t strays() const override { return framer_.strays(); }
  std::uint8_t link_quality_percent(Time now) const override;

 private:
  void use(const std::uint8_t* frame, std::size_t size, Time stamp);

  Framer<CrsfFormat> framer_;
  Time last_{};
  Time statistics_at_{};
  bool have_statistics_{false};
  std::uint8_t quality_{kQualityUnknown};
};

}  // namespace rosflight::boards::parts
