// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/adc_model.hpp"

#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr std::uint32_t kOn = adc::CR_ADVREGEN(1), kEnabled = kOn | adc::CR_ADEN(1);
constexpr std::uint32_t kChannel = 14;

class Adc : public Models {
 protected:
  Adc() {
    start_clocks();
    write(clocks, rcc::PLL3DIVR, 479U | 59U << 9U | 19U << 16U | 14U << 24U);
    write(clocks, rcc::CR, clocks_on | rcc::CR_PLL3ON(1));
    write(clocks, rcc::D3CCIPR, rcc::D3CCIPR_ADCSEL(1));
    converter.reset();
    converter.pin_V = [](unsigned channel) { return channel == kChannel ? 1.64 : 0.0; };
    write(converter, adc::CCR, adc::CCR_PRESC(8));
  }
  void calibrate_and_enable() {
    write(converter, adc::CR, 0);
    write(converter, adc::CR, kOn);
    write(converter, adc::CR, kOn | adc::CR_ADCAL(1));
    core.run_for(2000 * kTicksPerMicrosecond);
    write(converter, adc::CR, kEnabled);
    core.run_for(10 * kTicksPerMicrosecond);
  }
  void enable() {
    calibrate_and_enable();
    EXPECT_EQ(adc::ISR_ADRDY.of(read(converter, adc::ISR)), 1U);
  }
  void choose(std::uint32_t channel) {
    write(converter, adc::PCSEL, 1U << channel);
    write(converter, adc::SMPR2, 7U << (channel - 10) * 3);
    write(converter, adc::SQR1, adc::SQR1_SQ1(channel));
  }
  AdcModel converter{core, "ADC1", ADC1, clocks};
};

TEST_F(Adc, ConvertsAPinInItsTime) {
  enable();
  choose(kChannel);
  write(converter, adc::CR, kEnabled | adc::CR_ADSTART(1));
  core.run_for(818 * kTicksPerMicrosecond);
  EXPECT_EQ(adc::ISR_EOC.of(read(converter, adc::ISR)), 0U) << "819 cycles of 1 MHz";
  core.run_for(2 * kTicksPerMicrosecond);
  EXPECT_EQ(adc::ISR_EOC.of(read(converter, adc::ISR)), 1U);
  EXPECT_EQ(read(converter, adc::DR), 32768U) << "half of the supply";
  EXPECT_EQ(adc::ISR_EOC.of(read(converter, adc::ISR)), 0U) << "reading the value clears it";
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(Adc, WrongOrdersAreComplainedOf) {
  write(converter, adc::CR, kOn);
  expect_complaint("in deep power-down");
  converter.reset();
  write(converter, adc::CR, 0);
  write(converter, adc::CR, kOn | adc::CR_ADCAL(1));
  expect_complaint("without its regulator");
  converter.reset();
  write(converter, adc::CR, 0);
  write(converter, adc::CR, kOn);
  write(converter, adc::CR, kEnabled);
  expect_complaint("before it is calibrated");
  converter.reset();
  write(converter, adc::CR, 0);
  write(converter, adc::CR, kOn);
  write(converter, adc::CR, kOn | adc::CR_ADSTART(1));
  expect_complaint("before it is ready");
  converter.reset();
  write(converter, adc::CCR, adc::CCR_PRESC(8));
  enable();
  write(converter, adc::SQR1, adc::SQR1_SQ1(kChannel));
  write(converter, adc::CR, kEnabled | adc::CR_ADSTART(1));
  expect_complaint("not preselected");
  write(converter, adc::PCSEL, 1);
  expect_complaint("set up while it converts");
  write(converter, adc::CR, kEnabled | adc::CR_ADSTART(1));
  expect_complaint("started while it converts");
}

TEST_F(Adc, ReadinessIsReadBeforeTheFirstStart) {
  calibrate_and_enable();
  choose(kChannel);
  write(converter, adc::CR, kEnabled | adc::CR_ADSTART(1));
  expect_complaint("before ADRDY was read");
}

TEST_F(Adc, AFastClockNeedsBoost) {
  write(converter, adc::CCR, 0);
  enable();
  choose(kChannel);
  write(converter, adc::CR, kEnabled | adc::CR_ADSTART(1));
  expect_complaint("too fast without BOOST");
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
