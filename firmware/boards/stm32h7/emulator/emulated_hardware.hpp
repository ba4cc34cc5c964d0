// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/emulator/chip.hpp"
#include "firmware/boards/stm32h7/host/exchange.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A chip with what a board has soldered to it, and the world around it.
class EmulatedHardware {
 public:
  virtual ~EmulatedHardware() = default;
  virtual Chip& chip() = 0;
  /// Power comes on or goes: parts lose their registers.
  virtual void power_on() = 0;
  /// What the world shows the parts from now on; bytes and frames begin to arrive.
  virtual void expose(const ToChip& world) = 0;
  /// The fault that `world` orders.
  virtual void inject(const ToChip& world) = 0;
  /// Pulses on the pins, LEDs, link bytes since the last call, figures.
  virtual void report(FromChip& out) = 0;
  /// How far the firmware's stamp of its newest IMU sample is from the time of the world that this sample
  /// shows; 0 before the first. Call it after each run of the chip, of half a period of the control loop at most.
  virtual double stamp_error_us(std::int64_t stamp_us) = 0;
  /// What the parts complained of.
  virtual std::vector<std::string> complaints() const = 0;
};

}  // namespace rosflight::boards::stm32h7::emulator
