// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/spi_bus.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kEightBits = 7;
constexpr std::uint32_t kClearAll = 0xFF8u;
constexpr std::uint32_t kDeselect_us = 2;  // shortest time between two selections of a device

}  // namespace

std::uint32_t SpiBus::divider_for(std::uint32_t max_Hz) const {
  std::uint32_t exponent = 0;  // the clock is divided by 2 << exponent
  while (exponent < 7 && (kSpiClock_Hz >> (exponent + 1)) > max_Hz) ++exponent;
  return exponent;
}

void SpiBus::open(parts::SharedBus& bus) {
  bus_ = &bus;
  open_gate(pins_.spi);
  for (std::size_t k = 0; k < device_count_; ++k) make_output(devices_[k].select, true);
  for (const Pin& pin : {pins_.clock, pins_.in}) make_alternate(pin, pins_.function);
  make_alternate(pins_.out, pins_.out_function != 0 ? pins_.out_function : pins_.function);
  // SSI before MASTER: without it the SPI sees its own select low and leaves master mode. AFCNTR keeps
  // the clock high while the SPI is disabled.
  reg(pins_.spi, spi::CR1) = spi::CR1_SSI(1);
  reg(pins_.spi, spi::CFG2) =
      spi::CFG2_SSM(1) | spi::CFG2_AFCNTR(1) | spi::CFG2_CPOL(1) | spi::CFG2_CPHA(1);
  modify(reg(pins_.spi, spi::CFG2), spi::CFG2_MASTER, 1);
  using Direction = DmaStream::Direction;
  receive_.connect({pins_.receive_request, Direction::kToMemory, false, true});
  transmit_.connect({pins_.receive_request + 1, Direction::kToRegister});
  enable_interrupt(receive_.irq(), Priority::kBus);
}

std::uint32_t SpiBus::mask() {
  return mask_bus();
}
void SpiBus::unmask(std::uint32_t state) {
  unmask_bus(state);
}

void SpiBus::begin(std::uint8_t device, const parts::Transfer& transfer) {
  while (device == device_ && microseconds() - deselected_us_ <= kDeselect_us) {
  }
  transfer_ = &transfer;
  device_ = device;
  const std::size_t count = transfer.out_count + transfer.in_count;
  const auto rest = std::copy_n(transfer.out, transfer.out_count, buffers_.out.begin());
  std::fill_n(rest, transfer.in_count, std::uint8_t{0});
  const Instance& spi = pins_.spi;
  const std::uint32_t format = spi::CFG1_DSIZE(kEightBits) | spi::CFG1_CRCSIZE(kEightBits) |
                               spi::CFG1_MBR(divider_for(devices_[device].max_Hz));
  reg(spi, spi::CR2) = spi::CR2_TSIZE(static_cast<std::uint32_t>(count));
  set_level(devices_[device].select, false);
  reg(spi, spi::CFG1) = format | spi::CFG1_RXDMAEN(1);
  receive_.start(spi.base + spi::RXDR, buffers_.in.data(), count);
  transmit_.start(spi.base + spi::TXDR, buffers_.out.data(), count);
  reg(spi, spi::CFG1) = format | spi::CFG1_RXDMAEN(1) | spi::CFG1_TXDMAEN(1);
  reg(spi, spi::CR1) = spi::CR1_SSI(1) | spi::CR1_SPE(1);
  reg(spi, spi::CR1) = spi::CR1_SSI(1) | spi::CR1_SPE(1) | spi::CR1_CSTART(1);
}

/// The SPI is disabled, its flags and streams are cleared, the device is deselected.
void SpiBus::end(bool failed) {
  const Instance& spi = pins_.spi;
  if (!failed) {
    while (spi::SR_EOT.of(reg(spi, spi::SR)) == 0) {  // at once: the last byte has been moved
    }
  }
  reg(spi, spi::IFCR) = kClearAll;
  reg(spi, spi::CR1) = spi::CR1_SSI(1);
  reg(spi, spi::IFCR) = kClearAll;
  if (receive_.runs()) receive_.stop();
  if (transmit_.runs()) transmit_.stop();
  set_level(devices_[device_].select, true);
  deselected_us_ = microseconds();
}

void SpiBus::on_interrupt() {
  const bool failed = receive_.clear_flags();
  const parts::Transfer* const transfer = transfer_;
  if (transfer == nullptr) return;
  end(failed);
  transfer_ = nullptr;
  std::copy_n(buffers_.in.begin() + static_cast<std::ptrdiff_t>(transfer->out_count),
              transfer->in_count, transfer->in);
  bus_->complete(failed ? parts::TransferResult::kBusFault : parts::TransferResult::kDone);
}

void SpiBus::abort() {
  end(true);
  transfer_ = nullptr;
}

}  // namespace rosflight::boards::stm32h7
