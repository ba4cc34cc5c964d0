// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/spi_model.hpp"

#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kEvents = 0xFF8U;     // flags that IFCR clears
constexpr std::uint32_t kDmaParts = 0xC000U;  // RXDMAEN and TXDMAEN may change while enabled

}  // namespace

SpiModel::SpiModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
                   const DmaRequests& dma, const SpiWiring& wiring)
    : Peripheral{core, std::move(name), "SPI", instance},
      clocks_{clocks},
      dma_{dma},
      wiring_{wiring} {}

void SpiModel::reset() {
  Peripheral::reset();
  word(spi::CFG1) = 0x0007'0007U;
  received_.clear();
  left_ = 0;
  end_unseen_ = false;
}

std::uint64_t SpiModel::clock_Hz() const {
  return clocks_.spi_Hz(instance()) >> (spi::CFG1_MBR.of(word(spi::CFG1)) + 1U);
}

std::uint32_t SpiModel::status() const {
  std::uint32_t value = word(spi::SR);
  if (!received_.empty()) value |= spi::SR_RXP.mask();
  if (enabled() && left_ > 0) value |= spi::SR_TXP.mask();
  return value;
}

std::uint32_t SpiModel::read(std::uint32_t offset, unsigned size) {
  if (offset == spi::SR) {
    end_unseen_ = false;
    return status();
  }
  if (offset != spi::RXDR) return word(offset);
  if (size != 1) complain("RXDR: not read by bytes");
  if (received_.empty()) {
    complain("RXDR: read while empty");
    return 0;
  }
  const std::uint8_t byte = received_.front();
  received_.pop_front();
  return byte;
}

void SpiModel::check_change(std::uint32_t offset, std::uint32_t value) {
  std::uint32_t changed = word(offset) ^ value;
  if (offset == spi::CFG1) changed &= ~kDmaParts;
  const bool protected_one = offset == spi::CFG1 || offset == spi::CFG2 || offset == spi::CR2;
  if (enabled() && protected_one && changed != 0)
    complain("set up while enabled, offset " + std::to_string(offset));
  const std::uint32_t raised = value & ~word(offset);
  if (offset == spi::CFG2 && spi::CFG2_MASTER.of(raised) != 0 && spi::CFG2_SSM.of(value) != 0 &&
      spi::CR1_SSI.of(word(spi::CR1)) == 0) {
    complain("MASTER set before SSI: mode fault");
  }
  if (offset != spi::CFG1) return;
  if (spi::CFG1_RXDMAEN.of(raised) != 0 && dma_.served(wiring_.receive_request)) {
    complain("RXDMAEN set after its stream was started");
  }
  if (spi::CFG1_TXDMAEN.of(raised) != 0 && !dma_.served(wiring_.transmit_request)) {
    complain("TXDMAEN set before its stream was started");
  }
}

void SpiModel::write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  check_change(offset, value);
  switch (offset) {
    case spi::CR1:
      return write_control(value);
    case spi::IFCR:
      word(spi::SR) &= ~value;
      break;
    case spi::TXDR: {
      if (size != 1) complain("TXDR: not written by bytes");
      if (left_ == 0) {
        complain("TXDR: written without a transfer");
        break;
      }
      received_.push_back(exchange ? exchange(static_cast<std::uint8_t>(value)) : 0xFFU);
      if (--left_ == 0) finish();
      break;
    }
    default:
      word(offset) = value;
  }
  drive_line();
}

void SpiModel::write_control(std::uint32_t value) {
  const bool was_enabled = enabled();
  const std::uint32_t configuration = word(spi::CFG2);
  const bool enable = spi::CR1_SPE.of(value) != 0;
  if (enable && !was_enabled) {
    const bool master = spi::CFG2_MASTER.of(configuration) != 0;
    if (!master) complain("slave mode is not modelled");
    if (spi::CFG2_SSM.of(configuration) != 0 && spi::CR1_SSI.of(value) == 0) {
      complain("MASTER without SSI: mode fault");
      word(spi::SR) |= spi::SR_MODF.mask();
      value &= ~spi::CR1_SPE.mask();
    }
    if (spi::CFG2_AFCNTR.of(configuration) == 0)
      complain("AFCNTR is 0: the pins float between transfers");
    if (spi::CFG1_DSIZE.of(word(spi::CFG1)) != 7)
      complain("frames other than 8 bits are not modelled");
  }
  if (!enable && was_enabled) {
    if (left_ > 0) complain("disabled in the middle of a transfer");
    if (end_unseen_) complain("disabled before EOT was read");
    end_unseen_ = false;
    received_.clear();
    left_ = 0;
    value &= ~spi::CR1_CSTART.mask();
    core().set_due(*this, kNever);
  }
  const bool starts =
      enable && spi::CR1_CSTART.of(value) != 0 && spi::CR1_CSTART.of(word(spi::CR1)) == 0;
  if (starts && !was_enabled) complain("CSTART before SPE");
  word(spi::CR1) = value;
  if (starts) start();
  drive_line();
}

void SpiModel::start() {
  ++transfers_;
  if ((word(spi::SR) & kEvents) != 0) complain("started with old flags");
  left_ = spi::CR2_TSIZE.of(word(spi::CR2));
  if (left_ == 0) complain("transfers without end are not modelled");
  if (clock_Hz() == 0) return complain("its kernel clock stands still");
  if (on_start) on_start(clock_Hz());
  if (spi::CFG1_TXDMAEN.of(word(spi::CFG1)) == 0) return;
  if (!dma_.served(wiring_.receive_request)) complain("no stream for received bytes");
  for (const std::uint32_t request : {wiring_.receive_request, wiring_.transmit_request}) {
    if (dma_.width(request) > 1) complain("its DMA does not access the data registers by bytes");
  }
  core().set_due(*this, core().now() + Ticks{8} * left_ * period_of(clock_Hz()));
}

/// The last byte of a transfer by DMA has been shifted.
void SpiModel::event(Ticks /*now*/) {
  const bool overrun = loses_byte_;
  for (; left_ > 0; --left_) {
    std::uint32_t out = 0xFF;
    dma_.move(wiring_.transmit_request, out);
    std::uint32_t in = exchange ? exchange(static_cast<std::uint8_t>(out)) : 0xFFU;
    const bool lost = std::exchange(loses_byte_, false);
    if (lost || !dma_.move(wiring_.receive_request, in)) word(spi::SR) |= spi::SR_OVR.mask();
  }
  finish();
  if (overrun) end_unseen_ = false;  // who waits for the last byte gives up without it
  drive_line();
}

void SpiModel::finish() {
  word(spi::SR) |= spi::SR_EOT.mask() | spi::SR_TXTF.mask();
  end_unseen_ = true;
  ended_ = core().now();
  word(spi::CR1) &= ~spi::CR1_CSTART.mask();
}

void SpiModel::drive_line() {
  core().set_line(wiring_.irq, (status() & word(spi::IER) & (kEvents | 7U)) != 0);
}

}  // namespace rosflight::boards::stm32h7::emulator
