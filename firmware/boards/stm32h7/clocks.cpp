// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kFromHse = 2;
constexpr std::uint32_t kRange2To4MHz = 1;
constexpr std::uint32_t kReference_MHz = 2;
constexpr std::uint32_t kVoltageScale1 = 3;
constexpr std::uint32_t kWaitStates = 2;            // up to 210 MHz of AXI clock at scale 1
constexpr std::uint32_t kHalf = 8, kHalfOfBus = 4;  // HPRE, PPRE: divided by two
constexpr std::uint32_t kToPll1 = 3;
constexpr std::uint32_t kSpiFromPll2 = 1, kUsbFromPll3 = 2, kAdcFromPll3 = 1;

void await(const Instance& instance, std::uint32_t offset, const Field& field,
           std::uint32_t value) {
  while (field.of(reg(instance, offset)) != value) {
  }
}

void start_supply() {
  reg(PWR, pwr::CR3) = pwr::CR3_LDOEN(1);  // may be written once after power-on
  await(PWR, pwr::CSR1, pwr::CSR1_ACTVOSRDY, 1);
  reg(PWR, pwr::D3CR) = pwr::D3CR_VOS(kVoltageScale1);
  await(PWR, pwr::D3CR, pwr::D3CR_VOSRDY, 1);
}

void start_oscillators(const Oscillator& oscillator) {
  if (oscillator.external_clock) modify(reg(RCC, rcc::CR), rcc::CR_HSEBYP, 1);
  modify(reg(RCC, rcc::CR), rcc::CR_HSEON, 1);
  await(RCC, rcc::CR, rcc::CR_HSERDY, 1);
  modify(reg(RCC, rcc::CSR), rcc::CSR_LSION, 1);  // the watchdog's
  await(RCC, rcc::CSR, rcc::CSR_LSIRDY, 1);
}

/// Multiplier and the three output dividers; the layout is that of all three PLLs.
void set_up_pll(std::uint32_t offset, std::uint32_t n, std::uint32_t p, std::uint32_t q,
                std::uint32_t r) {
  reg(RCC, offset) = rcc::PLL1DIVR_N1(n - 1) | rcc::PLL1DIVR_P1(p - 1) | rcc::PLL1DIVR_Q1(q - 1) |
                     rcc::PLL1DIVR_R1(r - 1);
}

void start_plls(const Oscillator& oscillator) {
  const std::uint32_t m = oscillator.frequency_MHz / kReference_MHz;
  reg(RCC, rcc::PLLCKSELR) = rcc::PLLCKSELR_PLLSRC(kFromHse) | rcc::PLLCKSELR_DIVM1(m) |
                             rcc::PLLCKSELR_DIVM2(m) | rcc::PLLCKSELR_DIVM3(m);
  constexpr std::uint32_t kAllOutputs = 0x1FFu << 16u;  // DIVP1EN to DIVR3EN
  reg(RCC, rcc::PLLCFGR) = rcc::PLLCFGR_PLL1RGE(kRange2To4MHz) |
                           rcc::PLLCFGR_PLL2RGE(kRange2To4MHz) |
                           rcc::PLLCFGR_PLL3RGE(kRange2To4MHz) | kAllOutputs;
  set_up_pll(rcc::PLL1DIVR, 400, 2, 8, 2);     // 800 MHz: 400, 100, 400 MHz
  set_up_pll(rcc::PLL2DIVR, 256, 8, 8, 2);     // 512 MHz: 64, 64, 256 MHz
  set_up_pll(rcc::PLL3DIVR, 480, 60, 20, 15);  // 960 MHz: 16, 48, 64 MHz
  reg(RCC, rcc::CR) |= rcc::CR_PLL1ON(1) | rcc::CR_PLL2ON(1) | rcc::CR_PLL3ON(1);
  await(RCC, rcc::CR, rcc::CR_PLL1RDY, 1);
  await(RCC, rcc::CR, rcc::CR_PLL2RDY, 1);
  await(RCC, rcc::CR, rcc::CR_PLL3RDY, 1);
}

}  // namespace

void start_clocks(const Oscillator& oscillator) {
  start_supply();
  start_oscillators(oscillator);
  start_plls(oscillator);
  reg(RCC, rcc::D1CFGR) = rcc::D1CFGR_HPRE(kHalf) | rcc::D1CFGR_D1PPRE(kHalfOfBus);
  reg(RCC, rcc::D2CFGR) = rcc::D2CFGR_D2PPRE1(kHalfOfBus) | rcc::D2CFGR_D2PPRE2(kHalfOfBus);
  reg(RCC, rcc::D3CFGR) = rcc::D3CFGR_D3PPRE(kHalfOfBus);
  reg(FLASH, flash::ACR) = flash::ACR_LATENCY(kWaitStates) | flash::ACR_WRHIGHFREQ(kWaitStates);
  await(FLASH, flash::ACR, flash::ACR_LATENCY, kWaitStates);
  modify(reg(RCC, rcc::CFGR), rcc::CFGR_SW, kToPll1);
  await(RCC, rcc::CFGR, rcc::CFGR_SWS, kToPll1);
  reg(RCC, rcc::D2CCIP1R) =
      rcc::D2CCIP1R_SPI123SEL(kSpiFromPll2) | rcc::D2CCIP1R_SPI45SEL(kSpiFromPll2);
  reg(RCC, rcc::D2CCIP2R) = rcc::D2CCIP2R_USBSEL(kUsbFromPll3);
  reg(RCC, rcc::D3CCIPR) = rcc::D3CCIPR_ADCSEL(kAdcFromPll3);
}

void open_gate(const Instance& instance) {
  if (instance.gate == 0) return;
  volatile std::uint32_t& gates = reg(RCC, instance.gate);
  gates = gates | 1u << instance.gate_bit;
  const std::uint32_t back = gates;
  static_cast<void>(back);
}

}  // namespace rosflight::boards::stm32h7
