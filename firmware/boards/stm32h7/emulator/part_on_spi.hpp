// SPDX-License-Identifier: BSD-3-Clause
#pragma once
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
  }
  bool selected() const { return selected_; }
  /// Injects a fault: nobody drives the data line.
  void set_mute(bool mute) { mute_ = mute; }
  std::uint8_t exchange(std::uint8_t out) {
    const std::uint8_t in = part_.exchange(out);
    schedule();
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
};

}  // namespace rosflight::boards::stm32h7::emulator
