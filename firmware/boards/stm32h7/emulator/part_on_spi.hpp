// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <utility>

#include "firmware/boards/parts/models/part.hpp"
#include "firmware/boards/stm32h7/emulator/pins.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Time of the guest as models of parts count it.
inline hal::Time part_time(Ticks ticks) {
  return hal::Time{static_cast<std::int64_t>(ticks / kTicksPerMicrosecond)};
}

/// A part soldered to an SPI: brings the model to the time of each transfer, and of each event if it
/// has a line to the chip. One without is brought up to date before the world changes, too.
class PartOnSpi final : public Timed {
 public:
  /// Both must outlive this.
  PartOnSpi(Core& core, parts::models::SpiPart& part, bool has_line)
      : core_{core}, part_{part}, has_line_{has_line} {}

  /// Level of the chip select pin.
  void select(bool low) {
    advance();
    part_.select(low);
    selected_ = low;
    exchanged_ = 0;
  }
  bool selected() const { return selected_; }
  /// Injects a fault: nobody drives the data line.
  void set_mute(bool mute) { mute_ = mute; }
  /// Injects a fault: one bit of the third byte of the next answer that is so long is inverted.
  void flip_bit() { flips_ = true; }
  std::uint8_t exchange(std::uint8_t out) {
    constexpr unsigned kFlippedByte = 2;
    constexpr std::uint8_t kFlippedBit = 0x40;
    std::uint8_t in = part_.exchange(out);
    schedule();
    if (exchanged_++ == kFlippedByte && std::exchange(flips_, false))
      in = static_cast<std::uint8_t>(in ^ kFlippedBit);
    if (mute_) return 0xFF;
    return in;
  }
  void event(Ticks /*now*/) override { advance(); }
  void advance() {
    part_.advance(part_time(core_.now()));
    schedule();
  }

 private:
  void schedule() {
    if (!has_line_) return;
    const hal::Time next = part_.next_event();
    const bool never = next == parts::models::kNever;
    core_.set_due(*this, never ? kNever : static_cast<Ticks>(next.count()) * kTicksPerMicrosecond);
  }

  Core& core_;
  parts::models::SpiPart& part_;
  bool has_line_;
  bool selected_{false};
  bool mute_{false};
  bool flips_{false};
  unsigned exchanged_{0};  ///< Bytes since the part was selected.
};

}  // namespace rosflight::boards::stm32h7::emulator
