// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/i2c_model.hpp"

#include <utility>

#include "firmware/boards/stm32h7/emulator/part_on_spi.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr unsigned kByteBits = 9;  // with the acknowledgement

}  // namespace

I2cModel::I2cModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
                   unsigned event_irq, unsigned error_irq)
    : Peripheral{core, std::move(name), "I2C", instance},
      clocks_{clocks},
      event_irq_{event_irq},
      error_irq_{error_irq} {}

void I2cModel::reset() {
  Peripheral::reset();
  word(i2c::ISR) = i2c::ISR_TXE.mask();
  selected_ =
      nullptr;  // the lines are released, no stop condition: a part waits for the next start
  phase_ = Phase::kIdle;
}

void I2cModel::advance() {
  for (parts::models::I2cPart* const part : parts_) part->advance(part_time(core().now()));
}

/// SCL from the timing register, without the time of its edges.
Ticks I2cModel::bit_time() const {
  const std::uint32_t timing = word(i2c::TIMINGR);
  const std::uint64_t counts = i2c::TIMINGR_SCLL.of(timing) + i2c::TIMINGR_SCLH.of(timing) + 2U;
  return period_of(clocks_.apb_Hz()) * counts * (i2c::TIMINGR_PRESC.of(timing) + 1U);
}

void I2cModel::enter(Phase phase, unsigned bits) {
  phase_ = phase;
  if (!held_) core().set_due(*this, core().now() + bits * bit_time());
}

std::uint32_t I2cModel::read(std::uint32_t offset, unsigned /*size*/) {
  if (offset == i2c::ISR) {
    const bool busy = phase_ != Phase::kIdle || held_;
    return word(offset) | (busy ? i2c::ISR_BUSY.mask() : 0);
  }
  if (offset != i2c::RXDR) return word(offset);
  if (i2c::ISR_RXNE.of(word(i2c::ISR)) == 0) complain("RXDR: read while empty");
  word(i2c::ISR) &= ~i2c::ISR_RXNE.mask();
  if (phase_ == Phase::kWaitRead) next_byte();
  drive_lines();
  return shifted_;
}

void I2cModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  constexpr std::uint32_t kModelled = 0xFFU;  // CR1: enable and interrupts
  switch (offset) {
    case i2c::CR1:
      if ((value & ~kModelled) != 0) complain("CR1: not modelled");
      word(offset) = value;
      if (!enabled()) {
        phase_ = Phase::kIdle;
        if (selected_ != nullptr) selected_->stop();
        selected_ = nullptr;
        word(i2c::ISR) = i2c::ISR_TXE.mask();
        word(i2c::CR2) &= ~i2c::CR2_START.mask();
        core().set_due(*this, kNever);
      } else if (on_enable) {
        on_enable();
      }
      break;
    case i2c::TIMINGR:
      if (enabled()) complain("TIMINGR: changed while enabled");
      word(offset) = value;
      break;
    case i2c::CR2: {
      constexpr std::uint32_t kMissing = i2c::CR2_ADD10.mask() | i2c::CR2_HEAD10R.mask() |
                                         i2c::CR2_RELOAD.mask() | i2c::CR2_PECBYTE.mask();
      if ((value & kMissing) != 0) complain("CR2: not modelled");
      word(offset) = value;
      if (i2c::CR2_START.of(value) != 0) begin();
      break;
    }
    case i2c::ICR:
      word(i2c::ISR) &= ~value;
      break;
    case i2c::TXDR:
      if (i2c::ISR_TXIS.of(word(i2c::ISR)) == 0) complain("TXDR: written without room");
      word(i2c::ISR) &= ~i2c::ISR_TXIS.mask();
      shifted_ = static_cast<std::uint8_t>(value);
      enter(Phase::kSend, kByteBits);
      break;
    default:
      word(offset) = value;
  }
  drive_lines();
}

void I2cModel::begin() {
  if (!enabled()) complain("started while disabled");
  if (phase_ != Phase::kIdle && phase_ != Phase::kHeld) complain("started while a transfer runs");
  if (phase_ == Phase::kIdle) ++transfers_;
  word(i2c::ISR) &= ~i2c::ISR_TC.mask();
  left_ = i2c::CR2_NBYTES.of(word(i2c::CR2));
  enter(Phase::kAddress, kByteBits + 1);
}

void I2cModel::end_of_address() {
  word(i2c::CR2) &= ~i2c::CR2_START.mask();
  const std::uint32_t address = i2c::CR2_SADD.of(word(i2c::CR2)) >> 1U;
  selected_ = nullptr;
  for (parts::models::I2cPart* const part : parts_) {
    if (part->address() == address && part->begin(reads())) selected_ = part;
  }
  if (selected_ != nullptr) return next_byte();
  raise(i2c::ISR_NACKF);
  enter(Phase::kStop, 1);
}

/// What follows an acknowledged byte.
void I2cModel::next_byte() {
  if (left_ == 0) return end_of_bytes();
  if (reads()) return enter(Phase::kReceive, kByteBits);
  phase_ = Phase::kWaitData;
  raise(i2c::ISR_TXIS);
}

void I2cModel::end_of_bytes() {
  if (i2c::CR2_AUTOEND.of(word(i2c::CR2)) != 0) return enter(Phase::kStop, 1);
  phase_ = Phase::kHeld;  // the clock stays low until the next start
  raise(i2c::ISR_TC);
}

void I2cModel::event(Ticks /*now*/) {
  advance();
  switch (phase_) {
    case Phase::kAddress:
      end_of_address();
      break;
    case Phase::kSend:
      --left_;
      if (selected_->write(shifted_)) {
        next_byte();
      } else {
        raise(i2c::ISR_NACKF);
        enter(Phase::kStop, 1);
      }
      break;
    case Phase::kReceive:
      --left_;
      shifted_ = selected_->read();
      raise(i2c::ISR_RXNE);
      phase_ = Phase::kWaitRead;
      break;
    case Phase::kStop:
      if (selected_ != nullptr) selected_->stop();
      selected_ = nullptr;
      phase_ = Phase::kIdle;
      raise(i2c::ISR_STOPF);
      break;
    default:
      break;
  }
  drive_lines();
}

void I2cModel::drive_lines() {
  const std::uint32_t s = word(i2c::ISR), control = word(i2c::CR1);
  const auto asks = [s, control](const Field& flag, const Field& enable) {
    return flag.of(s) != 0 && enable.of(control) != 0;
  };
  core().set_line(event_irq_,
                  asks(i2c::ISR_TXIS, i2c::CR1_TXIE) || asks(i2c::ISR_RXNE, i2c::CR1_RXIE) ||
                      asks(i2c::ISR_NACKF, i2c::CR1_NACKIE) ||
                      asks(i2c::ISR_STOPF, i2c::CR1_STOPIE) || asks(i2c::ISR_TC, i2c::CR1_TCIE));
  core().set_line(error_irq_, asks(i2c::ISR_BERR, i2c::CR1_ERRIE) ||
                                  asks(i2c::ISR_ARLO, i2c::CR1_ERRIE) ||
                                  asks(i2c::ISR_OVR, i2c::CR1_ERRIE));
}

}  // namespace rosflight::boards::stm32h7::emulator
