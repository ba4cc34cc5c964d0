// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <deque>
#include <functional>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Request numbers and interrupt of an SPI.
struct SpiWiring {
  std::uint32_t receive_request{};
  std::uint32_t transmit_request{};
  unsigned irq{};
};

/// SPI as master, frames of 8 bits, transfers of a set size. RM0433 ch. 50.
///
/// Complains of: CFG1, CFG2 or TSIZE written while enabled; MASTER without SSI (mode fault); a transfer
/// whose end nobody has looked at when the SPI is disabled; pins that float between transfers; the DMA parts switched on in the wrong order; a start with old flags;
/// data registers not accessed by bytes; a kernel clock that stands still; a clock faster than the
/// board's parts allow.
class SpiModel final : public Peripheral {
 public:
  SpiModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
           const DmaRequests& dma, const SpiWiring& wiring);

  void reset() override;
  void event(Ticks now) override;

  /// The byte that comes back from whatever is selected; set by the board.
  std::function<std::uint8_t(std::uint8_t)> exchange;
  /// Called at each start: pins and rate can be checked.
  std::function<void(std::uint64_t clock_Hz)> on_start;
  /// Injects a fault: the first byte of the next transfer by DMA is not fetched in time.
  void lose_byte() { loses_byte_ = true; }
  std::uint64_t transfers() const { return transfers_; }
  /// When the last byte of the last transfer had been shifted.
  Ticks ended() const { return ended_; }

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t value);
  void check_change(std::uint32_t offset, std::uint32_t value);
  void start();
  void finish();
  std::uint64_t clock_Hz() const;
  std::uint32_t status() const;
  bool enabled() const { return spi::CR1_SPE.of(word(spi::CR1)) != 0; }
  void drive_line();

  const ClockTree& clocks_;
  const DmaRequests& dma_;
  SpiWiring wiring_;
  std::deque<std::uint8_t> received_;
  std::uint32_t left_{0};
  bool end_unseen_{false};  ///< A transfer has ended and EOT has not been read yet.
  bool loses_byte_{false};
  std::uint64_t transfers_{0};
  Ticks ended_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
