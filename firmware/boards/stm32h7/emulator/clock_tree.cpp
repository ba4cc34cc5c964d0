// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint64_t kHsi_Hz = 64'000'000, kLsi_Hz = 32'000;
constexpr std::uint64_t kVcoMin_Hz = 192'000'000, kVcoMax_Hz = 960'000'000;  // wide, revision V
constexpr std::uint32_t kSwitchToPll1 = 3;
constexpr std::uint32_t kFromHse = 2;
/// Instances that the generated table knows without a gate: always clocked.
constexpr std::uint16_t kNoGate = 0;

struct PllFields {
  Field on, ready, divider_m, range, wide;
  std::uint32_t dividers;
};
constexpr PllFields kPlls[] = {
    {rcc::CR_PLL1ON, rcc::CR_PLL1RDY, rcc::PLLCKSELR_DIVM1, rcc::PLLCFGR_PLL1RGE,
     rcc::PLLCFGR_PLL1VCOSEL, rcc::PLL1DIVR},
    {rcc::CR_PLL2ON, rcc::CR_PLL2RDY, rcc::PLLCKSELR_DIVM2, rcc::PLLCFGR_PLL2RGE,
     rcc::PLLCFGR_PLL2VCOSEL, rcc::PLL2DIVR},
    {rcc::CR_PLL3ON, rcc::CR_PLL3RDY, rcc::PLLCKSELR_DIVM3, rcc::PLLCFGR_PLL3RGE,
     rcc::PLLCFGR_PLL3VCOSEL, rcc::PLL3DIVR},
};
// The three divider registers have one layout.
constexpr Field kN = rcc::PLL1DIVR_N1, kP = rcc::PLL1DIVR_P1, kQ = rcc::PLL1DIVR_Q1,
                kR = rcc::PLL1DIVR_R1;

/// HPRE and the PPRE fields: below 8 (4) undivided, then powers of two.
std::uint64_t ahb_divider(std::uint32_t field) {
  constexpr std::uint64_t kDividers[] = {2, 4, 8, 16, 64, 128, 256, 512};
  return field < 8 ? 1 : kDividers[field - 8];
}
std::uint64_t apb_divider(std::uint32_t field) {
  return field < 4 ? 1 : std::uint64_t{2} << (field - 4);
}

}  // namespace

// ---- power

void PowerControl::reset() {
  Peripheral::reset();
  word(pwr::CR3) = 6U;
  supplied_ = seen_ready_ = false;
}

std::uint32_t PowerControl::read(std::uint32_t offset, unsigned /*size*/) {
  std::uint32_t value = word(offset);
  if (offset == pwr::CSR1 && supplied_) {
    value |= pwr::CSR1_ACTVOSRDY.mask();
    seen_ready_ = true;
  }
  if (offset == pwr::D3CR && supplied_) value |= pwr::D3CR_VOSRDY.mask();
  if (offset == pwr::CR3 && pwr::CR3_USB33DEN.of(value) != 0) value |= pwr::CR3_USB33RDY.mask();
  return value;
}

void PowerControl::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  constexpr std::uint32_t kSupply = 7U;
  if (offset == pwr::CR3) {
    if (supplied_ && (value & kSupply) != (word(offset) & kSupply)) {
      complain("CR3: the supply may be chosen only once after power-on");
    }
    supplied_ = true;
  }
  if (offset == pwr::D3CR && !supplied_)
    complain("D3CR: voltage scale before the supply is chosen");
  if (offset == pwr::D3CR && supplied_ && !seen_ready_)
    complain("D3CR: voltage scale before ACTVOSRDY was read");
  word(offset) = value;
}

// ---- clocks

ClockTree::ClockTree(Core& core, std::uint64_t crystal_Hz, const FlashControl& flash,
                     const PowerControl& power)
    : Peripheral{core, "RCC", "RCC", RCC}, crystal_Hz_{crystal_Hz}, flash_{flash}, power_{power} {}

void ClockTree::reset() {
  Peripheral::reset();
  word(rcc::CR) = rcc::CR_HSION.mask();
  word(rcc::PLLCKSELR) = 0x0202'0200U;
  word(rcc::PLLCFGR) = 0x01FF'0000U;
  for (const PllFields& pll : kPlls) word(pll.dividers) = 0x0101'0280U;
  word(rcc::RSR) = reset_flags_;
  unread_.fill(0);
  look_at_dividers();
}

void ClockTree::set_power_on() {
  reset_flags_ = rcc::RSR_PORRSTF.mask() | rcc::RSR_PINRSTF.mask() | rcc::RSR_BORRSTF.mask();
}

bool ClockTree::gate_open(const Instance& instance) {
  if (instance.gate == kNoGate) return true;
  const std::uint32_t bit = 1U << instance.gate_bit;
  std::uint32_t& unread = unread_[instance.gate / 4];
  if ((unread & bit) != 0) {
    unread &= ~bit;
    complain("clock gate opened but not read back before the first access");
  }
  return (word(instance.gate) & bit) != 0;
}

std::uint32_t ClockTree::read(std::uint32_t offset, unsigned /*size*/) {
  std::uint32_t value = word(offset);
  if (offset == rcc::CR) {
    const auto follow = [&value](const Field& on, const Field& ready) {
      if (on.of(value) != 0) value |= ready.mask();
    };
    follow(rcc::CR_HSION, rcc::CR_HSIRDY);
    follow(rcc::CR_HSEON, rcc::CR_HSERDY);
    follow(rcc::CR_HSI48ON, rcc::CR_HSI48RDY);
    for (const PllFields& pll : kPlls) follow(pll.on, pll.ready);
  }
  if (offset == rcc::CFGR) value |= rcc::CFGR_SWS(rcc::CFGR_SW.of(value));
  if (offset == rcc::CSR && rcc::CSR_LSION.of(value) != 0) value |= rcc::CSR_LSIRDY.mask();
  if (offset / 4 < unread_.size()) unread_[offset / 4] = 0;
  return value;
}

void ClockTree::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  const std::uint32_t before = word(offset);
  if (offset == rcc::RSR) {
    if (rcc::RSR_RMVF.of(value) != 0) word(offset) = reset_flags_ = 0;
    return;
  }
  const bool sources = offset == rcc::PLLCKSELR || offset == rcc::PLLCFGR;
  for (unsigned pll = 1; pll <= 3; ++pll) {
    if (runs(pll) && value != before && (sources || offset == kPlls[pll - 1].dividers)) {
      complain("PLL" + std::to_string(pll) + " is set up while it runs");
    }
  }
  word(offset) = value;
  if (offset == rcc::CR) {
    for (unsigned pll = 1; pll <= 3; ++pll) {
      const Field& on = kPlls[pll - 1].on;
      if (on.of(value) != 0 && on.of(before) == 0) check_pll(pll);
    }
  }
  look_at_dividers();
  if (offset == rcc::CFGR) check_switch();
  const bool gate = offset >= rcc::AHB1ENR && offset <= rcc::APB4ENR;
  if (gate) unread_[offset / 4] |= value & ~before;
  const bool resets = offset >= rcc::AHB1RSTR && offset <= rcc::APB4RSTR;
  if (resets && on_peripheral_reset) on_peripheral_reset(offset, value & ~before);
}

bool ClockTree::runs(unsigned pll) const {
  return kPlls[pll - 1].on.of(word(rcc::CR)) != 0;
}

std::uint64_t ClockTree::reference_Hz(unsigned pll) const {
  const std::uint32_t sources = word(rcc::PLLCKSELR);
  const std::uint64_t source =
      rcc::PLLCKSELR_PLLSRC.of(sources) == kFromHse ? crystal_Hz_ : kHsi_Hz;
  const std::uint32_t m = kPlls[pll - 1].divider_m.of(sources);
  return m == 0 ? 0 : source / m;
}

std::uint64_t ClockTree::vco_Hz(unsigned pll) const {
  return reference_Hz(pll) * (kN.of(word(kPlls[pll - 1].dividers)) + 1);
}

void ClockTree::check_pll(unsigned pll) const {
  const PllFields& fields = kPlls[pll - 1];
  const std::string name = "PLL" + std::to_string(pll);
  const std::uint32_t configuration = word(rcc::PLLCFGR);
  // Range n of the reference: (1 << n) to (2 << n) MHz.
  const std::uint64_t low = std::uint64_t{1'000'000} << fields.range.of(configuration);
  const std::uint64_t reference = reference_Hz(pll);
  if (reference < low || reference > 2 * low)
    complain(name + ": reference clock outside of its range field");
  const std::uint64_t vco = vco_Hz(pll);
  if (fields.wide.of(configuration) != 0 || vco < kVcoMin_Hz || vco > kVcoMax_Hz) {
    complain(name + ": oscillator outside of 192 to 960 MHz");
  }
  if (rcc::PLLCKSELR_PLLSRC.of(word(rcc::PLLCKSELR)) == kFromHse &&
      rcc::CR_HSEON.of(word(rcc::CR)) == 0) {
    complain(name + ": its source HSE does not run");
  }
}

/// RM0433 table of wait states: 2 suffice up to 210 MHz of AXI clock at scale 1.
void ClockTree::check_switch() const {
  constexpr std::uint64_t kMaxAxi_Hz = 210'000'000, kMaxCore_Hz = 400'000'000;
  constexpr std::uint32_t kWaitStates = 2;
  if (rcc::CFGR_SW.of(word(rcc::CFGR)) != kSwitchToPll1) return;
  if (!runs(1)) complain("CFGR: switched to PLL1, which does not run");
  const std::uint64_t axi = core_Hz() / ahb_divider(rcc::D1CFGR_HPRE.of(word(rcc::D1CFGR)));
  if (core_Hz() > kMaxCore_Hz || axi > kMaxAxi_Hz)
    complain("CFGR: clock faster than the chip allows");
  if (!power_.scale_1()) complain("CFGR: 400 MHz needs voltage scale 1");
  if (flash_.wait_states() < kWaitStates) complain("CFGR: too few wait states of the flash");
}

std::uint64_t ClockTree::pll_Hz(unsigned pll, char output) const {
  if (!runs(pll)) return 0;
  const std::uint32_t dividers = word(kPlls[pll - 1].dividers);
  const Field& field = output == 'P' ? kP : output == 'Q' ? kQ : kR;
  return vco_Hz(pll) / (field.of(dividers) + 1);
}

/// TIMPRE 0: a timer counts twice the APB clock if that is divided.
void ClockTree::look_at_dividers() {
  const std::uint64_t source =
      rcc::CFGR_SW.of(word(rcc::CFGR)) == kSwitchToPll1 && runs(1) ? pll_Hz(1, 'P') : kHsi_Hz;
  const std::uint32_t d1 = word(rcc::D1CFGR), d2 = word(rcc::D2CFGR);
  core_Hz_ = source / ahb_divider(rcc::D1CFGR_D1CPRE.of(d1));
  const std::uint64_t ahb_Hz = core_Hz_ / ahb_divider(rcc::D1CFGR_HPRE.of(d1));
  apb_Hz_ = ahb_Hz / apb_divider(rcc::D2CFGR_D2PPRE1.of(d2));
  timer_period_ = period_of(rcc::D2CFGR_D2PPRE1.of(d2) >= 4 ? 2 * apb_Hz_ : apb_Hz_);
  if (on_core_clock) on_core_clock(core_Hz_);
}

std::uint64_t ClockTree::usb_Hz() const {
  constexpr std::uint32_t kFromPll3 = 2;
  return rcc::D2CCIP2R_USBSEL.of(word(rcc::D2CCIP2R)) == kFromPll3 ? pll_Hz(3, 'Q') : 0;
}

std::uint64_t ClockTree::adc_Hz() const {
  constexpr std::uint32_t kFromPll3 = 1;
  return rcc::D3CCIPR_ADCSEL.of(word(rcc::D3CCIPR)) == kFromPll3 ? pll_Hz(3, 'R') : 0;
}

std::uint64_t ClockTree::spi_Hz(const Instance& spi) const {
  const std::uint32_t sources = word(rcc::D2CCIP1R);
  constexpr std::uint32_t kFromPll2 = 1;
  if (spi == SPI4 || spi == SPI5) {
    return rcc::D2CCIP1R_SPI45SEL.of(sources) == kFromPll2 ? pll_Hz(2, 'Q') : apb_Hz();
  }
  return rcc::D2CCIP1R_SPI123SEL.of(sources) == kFromPll2 ? pll_Hz(2, 'P') : pll_Hz(1, 'Q');
}

// ---- watchdog

void WatchdogModel::reset() {
  Peripheral::reset();
  word(iwdg::RLR) = 0xFFFU;
  running_ = unlocked_ = false;
}

void WatchdogModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  constexpr std::uint32_t kStart = 0xCCCC, kUnlock = 0x5555, kFeed = 0xAAAA;
  if (offset != iwdg::KR) {
    if (!unlocked_) complain("PR, RLR: written without the key 0x5555");
    word(offset) = value;
    return;
  }
  unlocked_ = value == kUnlock;
  if (value == kStart) {
    running_ = true;
    if (on_start) on_start();
  }
  if (!running_ || (value != kStart && value != kFeed)) return;
  const Ticks count = Ticks{4U << word(iwdg::PR)} * (word(iwdg::RLR) + 1);
  core().set_due(*this, core().now() + count * period_of(kLsi_Hz));
}

void WatchdogModel::event(Ticks /*now*/) {
  clocks_.set_reset_cause(rcc::RSR_IWDG1RSTF);
  if (on_bite) on_bite();
  core().request_reset();
}

}  // namespace rosflight::boards::stm32h7::emulator
