// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/adc_model.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::boards::stm32h7::emulator {

void AdcModel::reset() {
  Peripheral::reset();
  word(adc::CR) = adc::CR_DEEPPWD.mask();
  word(adc::CFGR) = adc::CFGR_JQDIS.mask();
  calibrated_ = seen_ready_ = false;
}

/// Revision V halves what the prescaler gives.
std::uint64_t AdcModel::clock_Hz() const {
  constexpr std::uint64_t kDividers[] = {1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256};
  constexpr std::size_t kCount = std::size(kDividers);
  const std::size_t field = adc::CCR_PRESC.of(word(adc::CCR));
  return clocks_.adc_Hz() / kDividers[std::min(field, kCount - 1)] / 2;
}

std::uint32_t AdcModel::read(std::uint32_t offset, unsigned /*size*/) {
  if (offset == adc::DR) word(adc::ISR) &= ~adc::ISR_EOC.mask();
  if (offset == adc::ISR && adc::ISR_ADRDY.of(word(offset)) != 0) seen_ready_ = true;
  return word(offset);
}

void AdcModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (offset == adc::ISR) {
    word(offset) &= ~value;  // written 1 clears
  } else if (offset == adc::CR) {
    write_control(value);
  } else {
    if (has(adc::CR_ADSTART)) complain("set up while it converts");
    if (offset == adc::CCR && has(adc::CR_ADEN)) complain("CCR: written while enabled");
    if (offset == adc::SQR1 && adc::SQR1_L.of(value) != 0) complain("sequences are not modelled");
    if (offset == adc::CFGR && (value & ~adc::CFGR_JQDIS.mask()) != 0)
      complain("CFGR: not modelled");
    word(offset) = value;
  }
}

void AdcModel::write_control(std::uint32_t value) {
  const auto sets = [this, value](const Field& bit) { return bit.of(value) != 0 && !has(bit); };
  const bool regulated = has(adc::CR_ADVREGEN) && !has(adc::CR_DEEPPWD);
  if (sets(adc::CR_ADVREGEN) && has(adc::CR_DEEPPWD))
    complain("regulator switched on in deep power-down");
  if (sets(adc::CR_ADCAL)) {
    if (!regulated) complain("calibrated without its regulator");
    if (clock_Hz() == 0) complain("its clock stands still");
    core().set_due(*this, core().now() + kCalibration);
  }
  if (sets(adc::CR_ADEN)) {
    if (has(adc::CR_ADCAL) || !calibrated_) complain("enabled before it is calibrated");
    core().set_due(*this, core().now() + kTicksPerMicrosecond);
  }
  const bool starts = sets(adc::CR_ADSTART);
  if (adc::CR_ADSTART.of(value) != 0 && has(adc::CR_ADSTART)) complain("started while it converts");
  // What starts something stays until it has ended.
  const std::uint32_t lasting = adc::CR_ADEN.mask() | adc::CR_ADSTART.mask() | adc::CR_ADCAL.mask();
  word(adc::CR) = value | (word(adc::CR) & lasting);
  if (starts) start();
}

void AdcModel::start() {
  constexpr std::uint64_t kSlow_Hz = 6'250'000;
  if (adc::ISR_ADRDY.of(word(adc::ISR)) == 0) return complain("started before it is ready");
  if (!seen_ready_) complain("started before ADRDY was read");
  const std::uint32_t channel = adc::SQR1_SQ1.of(word(adc::SQR1));
  if ((word(adc::PCSEL) >> channel & 1U) == 0)
    complain("channel " + std::to_string(channel) + " is not preselected");
  const std::uint64_t clock = clock_Hz();
  if (clock > kSlow_Hz && adc::CR_BOOST.of(word(adc::CR)) == 0)
    complain("clock too fast without BOOST");
  if (clock == 0) return complain("its clock stands still");
  constexpr double kCycles[] = {1.5, 2.5, 8.5, 16.5, 32.5, 64.5, 387.5, 810.5};
  const std::uint32_t times = word(channel < 10 ? adc::SMPR1 : adc::SMPR2);
  constexpr double kConversion = 8.5;
  const double cycles = kCycles[times >> (channel % 10 * 3) & 7U] + kConversion;
  core().set_due(*this, core().now() + static_cast<Ticks>(cycles * kTicksPerSecond /
                                                          static_cast<double>(clock)));
}

void AdcModel::event(Ticks /*now*/) {
  if (has(adc::CR_ADCAL)) {
    word(adc::CR) &= ~adc::CR_ADCAL.mask();
    calibrated_ = true;
  } else if (has(adc::CR_ADSTART)) {
    const unsigned channel = adc::SQR1_SQ1.of(word(adc::SQR1));
    const double code = 65535.0 * (pin_V ? pin_V(channel) : 0.0) / kSupply_V;
    word(adc::DR) = static_cast<std::uint32_t>(std::lround(std::clamp(code, 0.0, 65535.0)));
    word(adc::ISR) |= adc::ISR_EOC.mask();
    word(adc::CR) &= ~adc::CR_ADSTART.mask();
  } else {
    word(adc::ISR) |= adc::ISR_ADRDY.mask();
  }
}

}  // namespace rosflight::boards::stm32h7::emulator
