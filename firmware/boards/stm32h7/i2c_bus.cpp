// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/i2c_bus.hpp"

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

/// 100 kHz of 100 MHz: prescaler 2, 237 counts high, 256 low (RM0433: timing settings).
constexpr std::uint32_t kTiming100kHz = 0x10C0'ECFFu;
constexpr std::uint32_t kHalfClock_us = 5;
constexpr int kClocksToFree = 9;

}  // namespace

void I2cBus::open(parts::SharedBus& bus) {
  bus_ = &bus;
  open_gate(pins_.i2c);
  for (const Pin& pin : {pins_.clock, pins_.data}) {
    make_output(pin, true, Drive::kOpenDrain);  // high before it is given away
    make_alternate(pin, pins_.function, Pull::kUp);
  }
  start_peripheral();
  enable_interrupt(pins_.event_irq, Priority::kBus);
  enable_interrupt(pins_.error_irq, Priority::kBus);
}

void I2cBus::start_peripheral() {
  reg(pins_.i2c, i2c::CR1) = 0;
  const std::uint32_t back = reg(pins_.i2c, i2c::CR1);
  static_cast<void>(back);  // it takes three bus clocks to be off
  reg(pins_.i2c, i2c::TIMINGR) = kTiming100kHz;
  reg(pins_.i2c, i2c::CR1) = i2c::CR1_TXIE(1) | i2c::CR1_RXIE(1) | i2c::CR1_NACKIE(1) |
                             i2c::CR1_STOPIE(1) | i2c::CR1_TCIE(1) | i2c::CR1_ERRIE(1) |
                             i2c::CR1_PE(1);
}

std::uint32_t I2cBus::mask() {
  return mask_bus();
}
void I2cBus::unmask(std::uint32_t state) {
  unmask_bus(state);
}

void I2cBus::begin(std::uint8_t device, const parts::Transfer& transfer) {
  transfer_ = &transfer;
  device_ = device;
  refused_ = false;
  const bool writes = transfer.out_count > 0;
  address(!writes, writes ? transfer.out_count : transfer.in_count,
          !writes || transfer.in_count == 0);
}

/// Start condition, address and direction; the stop condition follows by itself if asked for.
void I2cBus::address(bool read, std::size_t count, bool stop_at_end) {
  moved_ = 0;
  reg(pins_.i2c, i2c::CR2) = i2c::CR2_SADD(static_cast<std::uint32_t>(device_) << 1u) |
                             i2c::CR2_RD_WRN(read) |
                             i2c::CR2_NBYTES(static_cast<std::uint32_t>(count)) |
                             i2c::CR2_AUTOEND(stop_at_end) | i2c::CR2_START(1);
}

void I2cBus::on_interrupt() {
  const Instance& i2c = pins_.i2c;
  const std::uint32_t status = reg(i2c, i2c::ISR);
  constexpr std::uint32_t kErrors =
      i2c::ISR_BERR.mask() | i2c::ISR_ARLO.mask() | i2c::ISR_OVR.mask();
  if ((status & kErrors) != 0) {
    reg(i2c, i2c::ICR) = i2c::ICR_BERRCF(1) | i2c::ICR_ARLOCF(1) | i2c::ICR_OVRCF(1);
    start_peripheral();
    return finish(parts::TransferResult::kBusFault);
  }
  if (i2c::ISR_NACKF.of(status) != 0) {
    reg(i2c, i2c::ICR) = i2c::ICR_NACKCF(1);
    refused_ = true;  // the stop condition follows by itself
  }
  if (transfer_ != nullptr && i2c::ISR_TXIS.of(status) != 0 && moved_ < transfer_->out_count) {
    reg(i2c, i2c::TXDR) = transfer_->out[moved_++];
  }
  if (i2c::ISR_RXNE.of(status) != 0) {
    const auto byte = static_cast<std::uint8_t>(reg(i2c, i2c::RXDR));
    if (transfer_ != nullptr && moved_ < transfer_->in_count) transfer_->in[moved_++] = byte;
  }
  if (transfer_ != nullptr && i2c::ISR_TC.of(status) != 0) address(true, transfer_->in_count, true);
  if (i2c::ISR_STOPF.of(status) != 0) {
    reg(i2c, i2c::ICR) = i2c::ICR_STOPCF(1);
    finish(refused_ ? parts::TransferResult::kNoAnswer : parts::TransferResult::kDone);
  }
  const std::uint32_t back = reg(i2c, i2c::ISR);
  static_cast<void>(back);  // the writes have arrived: the interrupt does not come again
}

void I2cBus::finish(parts::TransferResult result) {
  if (transfer_ == nullptr) return;
  transfer_ = nullptr;
  bus_->complete(result);
}

void I2cBus::abort() {
  transfer_ = nullptr;
  reg(pins_.i2c, i2c::CR1) = 0;
  free_lines();
  start_peripheral();
}

/// A part in the middle of a byte lets go of the data line after so many clocks; then a stop.
void I2cBus::free_lines() {
  make_output(pins_.data, true, Drive::kOpenDrain);
  make_output(pins_.clock, true, Drive::kOpenDrain);
  const auto clock = [this](bool high) {
    set_level(pins_.clock, high);
    wait_us(kHalfClock_us);
  };
  for (int k = 0; k < kClocksToFree && !level(pins_.data); ++k) {
    clock(false);
    clock(true);
  }
  clock(false);
  set_level(pins_.data, false);
  clock(true);
  set_level(pins_.data, true);
  wait_us(kHalfClock_us);
  make_alternate(pins_.clock, pins_.function, Pull::kUp);
  make_alternate(pins_.data, pins_.function, Pull::kUp);
}

}  // namespace rosflight::boards::stm32h7
