// SPDX-License-Identifier: BSD-3-Clause
// Each rule of the chip: a driver that keeps it is not complained of, one that breaks it is.
#include <gtest/gtest.h>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"
#include "firmware/boards/stm32h7/emulator/i2c_model.hpp"
#include "firmware/boards/stm32h7/emulator/pins.hpp"
#include "firmware/boards/stm32h7/emulator/spi_model.hpp"
#include "firmware/boards/stm32h7/emulator/test/fake_core.hpp"
#include "firmware/boards/stm32h7/emulator/timer_model.hpp"
#include "firmware/boards/stm32h7/emulator/uart_model.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

using ::testing::Test;

constexpr std::uint64_t kCrystal_Hz = 24'000'000;

/// Clocks, DMA and one of each peripheral.
class Models : public Test {
 protected:
  Models() {
    for (Peripheral* each :
         std::initializer_list<Peripheral*>{&flash, &power, &clocks, &multiplexer, &dma1, &dma2,
                                            &spi, &uart, &timer, &wide, &watchdog}) {
      each->reset();
    }
  }
  static void write(Peripheral& p, std::uint32_t offset, std::uint32_t value, unsigned size = 4) {
    p.bus_write(offset, value, size);
  }
  static std::uint32_t read(Peripheral& p, std::uint32_t offset, unsigned size = 4) {
    return p.bus_read(offset, size);
  }
  void expect_complaint(const std::string& part) {
    const std::string said = core.only_complaint();
    EXPECT_NE(said.find(part), std::string::npos) << "said: " << said;
  }
  /// As the firmware does it: see clocks.cpp of the chip layer.
  void start_clocks() {
    write(power, pwr::CR3, pwr::CR3_LDOEN(1));
    write(power, pwr::D3CR, pwr::D3CR_VOS(3));
    write(clocks, rcc::CR, rcc::CR_HSION(1) | rcc::CR_HSEON(1));
    write(clocks, rcc::PLLCKSELR, 2U | 12U << 4U | 12U << 12U | 12U << 20U);
    write(clocks, rcc::PLLCFGR,
          rcc::PLLCFGR_PLL1RGE(1) | rcc::PLLCFGR_PLL2RGE(1) | rcc::PLLCFGR_PLL3RGE(1) |
              0x1FFU << 16U);
    write(clocks, rcc::PLL1DIVR, 399U | 1U << 9U | 7U << 16U | 1U << 24U);
    write(clocks, rcc::PLL2DIVR, 239U | 29U << 9U | 29U << 16U | 1U << 24U);
    write(clocks, rcc::CR, clocks_on);
    write(clocks, rcc::D1CFGR, rcc::D1CFGR_HPRE(8) | rcc::D1CFGR_D1PPRE(4));
    write(clocks, rcc::D2CFGR, rcc::D2CFGR_D2PPRE1(4) | rcc::D2CFGR_D2PPRE2(4));
    write(flash, flash::ACR, 2U | 2U << 4U);
    write(clocks, rcc::CFGR, 3);
    write(clocks, rcc::D2CCIP1R, rcc::D2CCIP1R_SPI45SEL(1));
  }

  static constexpr std::uint32_t clocks_on =
      rcc::CR_HSION(1) | rcc::CR_HSEON(1) | rcc::CR_PLL1ON(1) | rcc::CR_PLL2ON(1);
  static constexpr std::uint32_t kUartRx = request::USART2_RX, kUartTx = request::USART2_TX;
  FakeCore core;
  FlashControl flash{core};
  PowerControl power{core};
  ClockTree clocks{core, kCrystal_Hz, flash, power};
  DmaMultiplexer multiplexer{core};
  DmaModel dma1{core, "DMA1", DMA1, multiplexer, 0, {11, 12, 13, 14, 15, 16, 17, 47}};
  DmaModel dma2{core, "DMA2", DMA2, multiplexer, 8, {56, 57, 58, 59, 60, 68, 69, 70}};
  DmaRequests requests{{&dma1, &dma2}};
  SpiModel spi{core,   "SPI5",   SPI5,
               clocks, requests, {request::SPI5_RX, request::SPI5_TX, irq::SPI5}};
  UartModel uart{core, "USART2", USART2, clocks, requests, {kUartRx, kUartTx, irq::USART2}};
  TimerModel timer{core, "TIM1", TIM1, clocks, irq::TIM1_UP, TimerModel::Kind::kAdvanced};
  TimerModel wide{core, "TIM5", TIM5, clocks, irq::TIM5, TimerModel::Kind::kWide};
  WatchdogModel watchdog{core, clocks};
};

// ---- registers

TEST_F(Models, UnknownRegistersAndReservedBitsAreComplainedOf) {
  write(watchdog, 0x14, 0);
  expect_complaint("no register");
  static_cast<void>(read(clocks, 0x200));
  expect_complaint("no register");
  write(uart, usart::BRR, 0x1'0000);
  expect_complaint("reserved bits 0x10000 at offset 0xc");
}

TEST_F(Models, ABusErrorIsInjectedOnce) {
  spi.fail_next_write();
  write(spi, spi::CR1, spi::CR1_SSI(1));
  write(spi, spi::CR1, spi::CR1_SSI(1));
  EXPECT_EQ(core.bus_errors, 1);
  EXPECT_EQ(read(spi, spi::CR1), spi::CR1_SSI(1));
}

// ---- clocks

TEST_F(Models, ClocksOfTheBoardComeOutAsInTheReferenceManual) {
  start_clocks();
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
  EXPECT_EQ(clocks.core_Hz(), 400'000'000U);
  EXPECT_EQ(clocks.apb_Hz(), 100'000'000U);
  EXPECT_EQ(clocks.timer_period(), 4U) << "5 ns at 200 MHz";
  EXPECT_EQ(clocks.spi_Hz(SPI5), 16'000'000U);
}

TEST_F(Models, PllIsSetUpOnlyWhileItStandsAndInItsRange) {
  start_clocks();
  write(clocks, rcc::PLL1DIVR, 300U | 1U << 9U);
  expect_complaint("PLL1 is set up while it runs");
  clocks.reset();
  core.complaints.clear();
  write(clocks, rcc::PLLCKSELR, 2U | 3U << 4U);  // 8 MHz, in the range field of 1 to 2 MHz
  write(clocks, rcc::PLL1DIVR, 99U | 1U << 9U);
  write(clocks, rcc::CR, rcc::CR_HSEON(1) | rcc::CR_PLL1ON(1));
  expect_complaint("outside of its range field");
}

TEST_F(Models, FastClockNeedsWaitStatesAndVoltage) {
  start_clocks();
  write(flash, flash::ACR, 0);
  write(clocks, rcc::CFGR, 0);
  write(clocks, rcc::CFGR, 3);
  expect_complaint("wait states");
  write(flash, flash::ACR, 2);
  write(power, pwr::D3CR, pwr::D3CR_VOS(1));
  write(clocks, rcc::CFGR, 3);
  expect_complaint("voltage scale 1");
}

TEST_F(Models, SupplyIsChosenOnce) {
  write(power, pwr::CR3, pwr::CR3_LDOEN(1));
  write(power, pwr::CR3, pwr::CR3_BYPASS(1));
  expect_complaint("only once");
}

TEST_F(Models, GateIsReadBackBeforeTheFirstAccess) {
  EXPECT_FALSE(clocks.gate_open(SPI5));
  write(clocks, rcc::APB2ENR, rcc::APB2ENR_SPI5EN(1));
  static_cast<void>(read(clocks, rcc::APB2ENR));
  EXPECT_TRUE(clocks.gate_open(SPI5));
  EXPECT_TRUE(core.complaints.empty());
  write(clocks, rcc::APB2ENR, rcc::APB2ENR_SPI5EN(1) | rcc::APB2ENR_TIM1EN(1));
  EXPECT_TRUE(clocks.gate_open(TIM1));
  expect_complaint("not read back");
}

// ---- watchdog

TEST_F(Models, WatchdogResetsAfterItsTimeUnlessItIsFed) {
  write(watchdog, iwdg::KR, 0xCCCC);
  write(watchdog, iwdg::KR, 0x5555);
  write(watchdog, iwdg::PR, 3);  // divided by 32: 1 ms
  write(watchdog, iwdg::RLR, 99);
  write(watchdog, iwdg::KR, 0xAAAA);
  core.run_for(99'000 * kTicksPerMicrosecond);
  write(watchdog, iwdg::KR, 0xAAAA);
  core.run_for(99'000 * kTicksPerMicrosecond);
  EXPECT_EQ(core.resets, 0);
  core.run_for(2'000 * kTicksPerMicrosecond);
  EXPECT_EQ(core.resets, 1);
  EXPECT_TRUE(core.complaints.empty());
  write(watchdog, iwdg::PR, 0);
  expect_complaint("without the key");
}

// ---- DMA

class DmaRules : public Models {
 protected:
  void set_up(std::uint32_t memory, std::uint32_t request = request::SPI5_RX) {
    write(multiplexer, 0, request);
    write(dma1, kStream + dma_stream::NDTR, 4);
    write(dma1, kStream + dma_stream::PAR, SPI5.base + spi::RXDR);
    write(dma1, kStream + dma_stream::M0AR, memory);
  }
  void start(std::uint32_t more = 0) {
    write(dma1, kStream,
          dma_stream::CR_MINC(1) | dma_stream::CR_TCIE(1) | more | dma_stream::CR_EN(1));
  }
  static constexpr std::uint32_t kStream = 0x10;
};

TEST_F(DmaRules, MovesItsElementsThenStopsAndAsksForTheInterrupt) {
  set_up(FakeCore::kMemory);
  start();
  for (std::uint32_t k = 0; k < 4; ++k) {
    std::uint32_t element = 10 + k;
    EXPECT_TRUE(requests.move(request::SPI5_RX, element));
  }
  EXPECT_EQ(core.bytes[3], 13);
  EXPECT_FALSE(requests.served(request::SPI5_RX));
  EXPECT_EQ(core.lines.count(irq::DMA1_STREAM0), 1U);
  write(dma1, dma::LIFCR, 0x3D);
  EXPECT_EQ(core.lines.count(irq::DMA1_STREAM0), 0U);
  EXPECT_TRUE(core.complaints.empty());
}

TEST_F(DmaRules, OldFlagsAreClearedBeforeAStart) {
  set_up(FakeCore::kMemory);
  start();
  std::uint32_t element = 0;
  for (int k = 0; k < 4; ++k) requests.move(request::SPI5_RX, element);
  set_up(FakeCore::kMemory);
  start();
  expect_complaint("old flags");
}

TEST_F(DmaRules, NothingIsSetUpWhileItRuns) {
  multiplexer.stream_runs = [this](std::size_t channel) {
    return channel < 8 && dma1.runs(channel);
  };
  set_up(FakeCore::kMemory);
  start();
  write(dma1, kStream + dma_stream::NDTR, 2);
  expect_complaint("set up while it runs");
  write(dma1, kStream + dma_stream::M0AR, 0);
  expect_complaint("set up while it runs");
  start(dma_stream::CR_CIRC(1));
  expect_complaint("set up while it runs");
  write(multiplexer, 0, request::SPI2_RX);
  expect_complaint("changed while its stream runs");
}

TEST_F(DmaRules, TightlyCoupledMemoryIsNotReached) {
  set_up(0x2000'0000U);
  start();
  expect_complaint("cannot reach");
  EXPECT_FALSE(dma1.runs(0)) << "it stops with a transfer error";
}

TEST_F(DmaRules, CachedMemoryIsComplainedOf) {
  set_up(FakeCore::kCachedMemory);
  start();
  expect_complaint("data cache");
}

TEST_F(DmaRules, MemoryNeedsItsClock) {
  dma1.memory_is_clocked = [](std::uint32_t) { return false; };
  set_up(FakeCore::kMemory);
  start();
  expect_complaint("clock gate of its memory");
}

TEST_F(DmaRules, UartRequestsNeedTrbuff) {
  set_up(FakeCore::kMemory, kUartRx);
  start();
  expect_complaint("TRBUFF");
  write(dma1, kStream, dma_stream::CR_MINC(1) | dma_stream::CR_TCIE(1));
  write(dma1, dma::LIFCR, 0x3D);
  set_up(FakeCore::kMemory, kUartRx);
  start(dma_stream::CR_TRBUFF(1));
  EXPECT_TRUE(core.complaints.empty());
}

// ---- SPI

class SpiRules : public Models {
 protected:
  SpiRules() {
    start_clocks();
    spi.exchange = [](std::uint8_t out) { return static_cast<std::uint8_t>(out + 1); };
    write(spi, spi::CR1, spi::CR1_SSI(1));
    write(spi, spi::CFG2, kConfiguration);
  }
  void streams(bool receive, bool transmit) {
    write(multiplexer, 0, request::SPI5_RX);
    write(multiplexer, 4, request::SPI5_TX);
    const auto start = [this](std::uint32_t at, std::uint32_t memory, std::uint32_t direction) {
      write(dma1, dma::LIFCR, 0x3DU | 0x3DU << 6U);
      write(dma1, at + dma_stream::NDTR, 2);
      write(dma1, at + dma_stream::M0AR, memory);
      write(dma1, at,
            dma_stream::CR_MINC(1) | dma_stream::CR_DIR(direction) | dma_stream::CR_EN(1));
    };
    if (receive) start(0x10, FakeCore::kMemory + 32, 0);
    if (transmit) start(0x28, FakeCore::kMemory, 1);
  }
  void enable_and_start() {
    write(spi, spi::CR1, spi::CR1_SSI(1) | spi::CR1_SPE(1));
    write(spi, spi::CR1, spi::CR1_SSI(1) | spi::CR1_SPE(1) | spi::CR1_CSTART(1));
  }
  static constexpr std::uint32_t kConfiguration =
      spi::CFG2_SSM(1) | spi::CFG2_MASTER(1) | spi::CFG2_AFCNTR(1);
  static constexpr std::uint32_t kFormat = spi::CFG1_DSIZE(7) | spi::CFG1_CRCSIZE(7);
};

TEST_F(SpiRules, TransferInTheOrderOfTheManual) {
  core.bytes[0] = 5;
  core.bytes[1] = 6;
  write(spi, spi::CR2, 2);
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1));
  streams(true, true);
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1) | spi::CFG1_TXDMAEN(1));
  enable_and_start();
  core.run_for(period_of(8'000'000) * 16 - 1);
  EXPECT_EQ(spi::SR_EOT.of(read(spi, spi::SR)), 0U) << "16 bits at 8 MHz take 2 us";
  core.run_for(1);
  EXPECT_EQ(spi::SR_EOT.of(read(spi, spi::SR)), 1U);
  EXPECT_EQ(core.bytes[32], 6);
  EXPECT_EQ(core.bytes[33], 7);
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(SpiRules, NothingIsSetUpWhileEnabled) {
  write(spi, spi::CFG1, kFormat);
  write(spi, spi::CR1, spi::CR1_SSI(1) | spi::CR1_SPE(1));
  write(spi, spi::CFG2, kConfiguration | spi::CFG2_CPOL(1));
  expect_complaint("set up while enabled");
  write(spi, spi::CR2, 3);
  expect_complaint("set up while enabled");
  write(spi, spi::CFG1, kFormat | spi::CFG1_MBR(2));
  expect_complaint("set up while enabled");
}

TEST_F(SpiRules, MasterNeedsSsiAndPinsThatAreHeld) {
  write(spi, spi::CR1, spi::CR1_SPE(1));
  expect_complaint("mode fault");
  write(spi, spi::CFG2, spi::CFG2_SSM(1) | spi::CFG2_MASTER(1));
  write(spi, spi::IFCR, spi::IFCR_MODFC(1));
  write(spi, spi::CFG1, kFormat);
  write(spi, spi::CR1, spi::CR1_SSI(1) | spi::CR1_SPE(1));
  expect_complaint("AFCNTR");
}

TEST_F(SpiRules, DmaPartsInTheWrongOrder) {
  streams(true, false);
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1));
  expect_complaint("RXDMAEN set after");
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1) | spi::CFG1_TXDMAEN(1));
  expect_complaint("TXDMAEN set before");
}

TEST_F(SpiRules, OldFlagsAndWideAccesses) {
  write(spi, spi::CFG1, kFormat);
  write(spi, spi::CR2, 1);
  enable_and_start();
  write(spi, spi::TXDR, 1, 4);
  expect_complaint("not written by bytes");
  write(spi, spi::CR1, spi::CR1_SSI(1));
  enable_and_start();
  expect_complaint("old flags");
}

// ---- UART

class UartRules : public Models {
 protected:
  UartRules() {
    start_clocks();
    write(uart, usart::BRR, 100'000'000U / 921'600U);
  }
  void enable(std::uint32_t more = 0) {
    write(uart, usart::CR1, usart::CR1_UE(1) | usart::CR1_RE(1) | usart::CR1_TE(1) | more);
  }
  parts::UartFormat far(std::uint32_t baud) const {
    parts::UartFormat format;
    format.baud = baud;
    return format;
  }
};

TEST_F(UartRules, ByteTakesItsTimeAndIdleFollows) {
  enable(usart::CR1_IDLEIE(1));
  const std::uint8_t byte = 0x55;
  uart.feed(&byte, 1, far(921'600));
  core.run_for(10 * kTicksPerMicrosecond);
  EXPECT_EQ(usart::ISR_RXNE_RXFNE.of(read(uart, usart::ISR)), 0U) << "10 bits take 10.85 us";
  core.run_for(kTicksPerMicrosecond);
  EXPECT_EQ(read(uart, usart::RDR), 0x55U);
  EXPECT_EQ(core.lines.count(irq::USART2), 0U);
  core.run_for(13 * kTicksPerMicrosecond);
  EXPECT_EQ(core.lines.count(irq::USART2), 1U)
      << "idle for one character, and the start bit of none";
  EXPECT_TRUE(core.complaints.empty());
}

TEST_F(UartRules, AnotherRateIsAFramingError) {
  enable();
  const std::uint8_t byte = 0x55;
  uart.feed(&byte, 1, far(460'800));
  core.run_for(30 * kTicksPerMicrosecond);
  EXPECT_EQ(usart::ISR_FE.of(read(uart, usart::ISR)), 1U);
  EXPECT_NE(read(uart, usart::RDR), 0x55U);
  EXPECT_EQ(uart.line_errors(), 1U);
}

TEST_F(UartRules, LostByteIsAnOverrun) {
  enable();
  const std::uint8_t bytes[2] = {1, 2};
  uart.feed(bytes, 2, far(921'600));
  core.run_for(30 * kTicksPerMicrosecond);
  EXPECT_EQ(uart.overruns(), 1U);
  EXPECT_EQ(read(uart, usart::RDR), 1U);
}

TEST_F(UartRules, NothingIsSetUpWhileEnabled) {
  enable();
  write(uart, usart::BRR, 200);
  expect_complaint("set up while enabled");
  write(uart, usart::CR2, usart::CR2_RXINV(1));
  expect_complaint("set up while enabled");
  enable(usart::CR1_PCE(1));
  expect_complaint("set up while enabled");
  write(uart, usart::CR3, usart::CR3_DMAR(1));
  EXPECT_TRUE(core.complaints.empty()) << "requests may be switched at any time";
}

TEST_F(UartRules, SendsAndSaysWhenTheLastBitIsOut) {
  std::vector<std::uint8_t> sent;
  uart.on_byte = [&sent](std::uint8_t byte, std::uint32_t) { sent.push_back(byte); };
  enable();
  write(uart, usart::TDR, 7);
  EXPECT_EQ(usart::ISR_TC.of(read(uart, usart::ISR)), 0U);
  core.run_for(11 * kTicksPerMicrosecond);
  EXPECT_EQ(sent, std::vector<std::uint8_t>{7});
  EXPECT_EQ(usart::ISR_TC.of(read(uart, usart::ISR)), 1U);
}

// ---- I2C

/// Echoes what was written to it.
class Echo final : public parts::models::I2cPart {
 public:
  std::uint8_t address() const override { return 0x0C; }
  bool begin(bool /*read*/) override { return true; }
  bool write(std::uint8_t byte) override { return written.push_back(byte), true; }
  std::uint8_t read() override { return written.empty() ? 0xFF : written.front(); }
  void stop() override { ++stops; }
  void advance(hal::Time /*now*/) override {}
  hal::Time next_event() const override { return parts::models::kNever; }
  void set_power(bool /*on*/) override {}
  std::vector<std::uint8_t> written;
  int stops{0};
};

class I2cRules : public Models {
 protected:
  I2cRules() {
    start_clocks();
    i2c.reset();
    i2c.connect(echo);
    write(i2c, i2c::TIMINGR, 0x10C0'ECFF);  // 100 kHz
    write(i2c, i2c::CR1, i2c::CR1_PE(1));
  }
  void address(std::uint32_t part, bool read, std::uint32_t count, bool stop) {
    write(i2c, i2c::CR2,
          i2c::CR2_SADD(part << 1U) | i2c::CR2_RD_WRN(read) | i2c::CR2_NBYTES(count) |
              i2c::CR2_AUTOEND(stop) | i2c::CR2_START(1));
  }
  bool has(const Field& flag) { return flag.of(read(i2c, i2c::ISR)) != 0; }
  static constexpr Ticks kByte = 90 * kTicksPerMicrosecond;
  Echo echo;
  I2cModel i2c{core, "I2C1", I2C1, clocks, irq::I2C1_EV, irq::I2C1_ER};
};

TEST_F(I2cRules, WritesThenReadsAfterARepeatedStart) {
  address(0x0C, false, 1, false);
  core.run_for(kByte);
  EXPECT_FALSE(has(i2c::ISR_TXIS)) << "start and nine bits take 98.6 us";
  core.run_for(kByte);
  ASSERT_TRUE(has(i2c::ISR_TXIS));
  write(i2c, i2c::TXDR, 0x31);
  core.run_for(kByte);
  ASSERT_TRUE(has(i2c::ISR_TC));
  address(0x0C, true, 1, true);
  core.run_for(3 * kByte);
  ASSERT_TRUE(has(i2c::ISR_RXNE));
  EXPECT_EQ(read(i2c, i2c::RXDR), 0x31U);
  core.run_for(kByte);
  EXPECT_TRUE(has(i2c::ISR_STOPF));
  EXPECT_EQ(echo.stops, 1);
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(I2cRules, NobodyAtTheAddressIsANackAndAStop) {
  address(0x55, false, 1, true);
  core.run_for(2 * kByte);
  EXPECT_TRUE(has(i2c::ISR_NACKF));
  EXPECT_TRUE(has(i2c::ISR_STOPF));
}

TEST_F(I2cRules, AHeldDataLineStopsEverything) {
  i2c.hold_data_low(true);
  address(0x0C, false, 1, true);
  core.run_for(100 * kByte);
  EXPECT_FALSE(has(i2c::ISR_STOPF));
  EXPECT_TRUE(has(i2c::ISR_BUSY));
}

TEST_F(I2cRules, WrongOrderIsComplainedOf) {
  write(i2c, i2c::TIMINGR, 0);
  expect_complaint("changed while enabled");
  write(i2c, i2c::TXDR, 1);
  expect_complaint("without room");
  write(i2c, i2c::CR1, 0);
  write(i2c, i2c::TIMINGR, 0x10C0'ECFF);
  write(i2c, i2c::CR1, i2c::CR1_PE(1));
  static_cast<void>(read(i2c, i2c::RXDR));
  expect_complaint("read while empty");
  address(0x0C, false, 1, true);
  address(0x0C, false, 1, true);
  expect_complaint("started while a transfer runs");
}

// ---- timers

TEST_F(Models, PrescalerTakesEffectAtAnUpdate) {
  start_clocks();
  write(wide, tim::PSC, 199);
  write(wide, tim::CR1, tim::CR1_CEN(1));
  core.run_for(10 * kTicksPerMicrosecond);
  EXPECT_EQ(read(wide, tim::CNT), 2000U) << "no update yet: it counts at 200 MHz";
  write(wide, tim::EGR, tim::EGR_UG(1));
  core.run_for(10 * kTicksPerMicrosecond);
  EXPECT_EQ(read(wide, tim::CNT), 10U);
}

TEST_F(Models, PulseChangesWithThePeriodAndNeedsTheMainOutput) {
  start_clocks();
  write(timer, tim::PSC, 199);
  write(timer, tim::ARR, 2499);
  write(timer, tim::CCMR1, tim::CCMR1_OC1M(6) | tim::CCMR1_OC1PE(1));
  write(timer, tim::CCER, tim::CCER_CC1E(1));
  write(timer, tim::CCR1, 1500);
  write(timer, tim::EGR, tim::EGR_UG(1));
  write(timer, tim::CR1, tim::CR1_CEN(1));
  EXPECT_EQ(timer.pulse(0), 0U) << "TIM1 without MOE drives no pin";
  write(timer, tim::BDTR, tim::BDTR_MOE(1));
  EXPECT_EQ(timer.pulse(0), 1500 * kTicksPerMicrosecond);
  write(timer, tim::CCR1, 1200);
  EXPECT_EQ(timer.pulse(0), 1500 * kTicksPerMicrosecond) << "the pulse under way is not cut";
  core.run_for(2500 * kTicksPerMicrosecond);
  EXPECT_EQ(timer.pulse(0), 1200 * kTicksPerMicrosecond);
  EXPECT_TRUE(core.complaints.empty());
}

// ---- pins

TEST(Pins, EdgeReachesTheInterruptOfItsPortAlone) {
  FakeCore core;
  SystemConfiguration configuration{core};
  ExternalInterrupts interrupts{core, configuration};
  PinPort f{core, 5, GPIOF, interrupts}, a{core, 0, GPIOA, interrupts};
  for (Peripheral* each : std::initializer_list<Peripheral*>{&configuration, &interrupts, &f, &a})
    each->reset();
  configuration.bus_write(syscfg::EXTICR1, 5U << 12U, 4);  // line 3: port F
  interrupts.bus_write(exti::RTSR1, 1U << 3U, 4);
  interrupts.bus_write(exti::CPUIMR1, 1U << 3U, 4);
  a.drive(3, true);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 0U);
  f.drive(3, true);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 1U);
  interrupts.bus_write(exti::CPUPR1, 1U << 3U, 4);
  f.drive(3, false);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 0U) << "a falling edge was not asked for";
  interrupts.stick(3);
  interrupts.bus_write(exti::CPUPR1, 1U << 3U, 4);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 1U) << "injected: it stays";
}

TEST(Pins, WrongFunctionIsComplainedOf) {
  FakeCore core;
  SystemConfiguration configuration{core};
  ExternalInterrupts interrupts{core, configuration};
  PinPort d{core, 3, GPIOD, interrupts};
  d.reset();
  d.bus_write(gpio::AFR0, 7U << 20U, 4);
  d.expect_alternate(5, 7);
  EXPECT_NE(core.only_complaint().find("GPIOD: pin 5"), std::string::npos)
      << "not in alternate mode yet";
  d.bus_write(gpio::MODER, 2U << 10U, 4);
  d.expect_alternate(5, 7);
  EXPECT_TRUE(core.complaints.empty());
  d.expect_alternate(5, 8);
  EXPECT_EQ(core.complaints.size(), 1U);
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
