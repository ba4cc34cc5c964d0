// SPDX-License-Identifier: BSD-3-Clause
// The rules of DMA, SPI, UART and I2C, as models_test.cpp has those of the others.
#include <gtest/gtest.h>

#include "firmware/boards/stm32h7/emulator/i2c_model.hpp"
#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

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

TEST_F(DmaRules, AStoppedStreamRunsUntilEnWasRead) {
  set_up(FakeCore::kMemory);
  start();
  write(dma1, kStream, dma_stream::CR_MINC(1) | dma_stream::CR_TCIE(1));
  EXPECT_FALSE(requests.served(request::SPI5_RX));
  write(dma1, kStream + dma_stream::NDTR, 2);
  expect_complaint("set up while it runs");
  EXPECT_EQ(dma_stream::CR_EN.of(read(dma1, kStream)), 1U);
  EXPECT_EQ(dma_stream::CR_EN.of(read(dma1, kStream)), 0U);
  write(dma1, kStream + dma_stream::NDTR, 2);
  EXPECT_TRUE(core.complaints.empty());
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
  EXPECT_EQ(dma_stream::CR_EN.of(read(dma1, kStream)), 1U);
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
  void streams(bool receive, bool transmit, std::uint32_t more = 0) {
    write(multiplexer, 0, request::SPI5_RX);
    write(multiplexer, 4, request::SPI5_TX);
    const auto start = [this, more](std::uint32_t at, std::uint32_t memory,
                                    std::uint32_t direction) {
      write(dma1, dma::LIFCR, 0x3DU | 0x3DU << 6U);
      write(dma1, at + dma_stream::NDTR, 2);
      write(dma1, at + dma_stream::M0AR, memory);
      write(dma1, at,
            dma_stream::CR_MINC(1) | dma_stream::CR_DIR(direction) | more | dma_stream::CR_EN(1));
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

TEST_F(SpiRules, SsiIsSetBeforeMaster) {
  spi.reset();
  write(spi, spi::CFG2, kConfiguration);
  expect_complaint("MASTER set before SSI");
}

TEST_F(SpiRules, DmaPartsInTheWrongOrder) {
  streams(true, false);
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1));
  expect_complaint("RXDMAEN set after");
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1) | spi::CFG1_TXDMAEN(1));
  expect_complaint("TXDMAEN set before");
}

TEST_F(SpiRules, DmaMovesBytes) {
  write(spi, spi::CR2, 2);
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1));
  streams(true, true, dma_stream::CR_PSIZE(1) | dma_stream::CR_MSIZE(1));
  write(spi, spi::CFG1, kFormat | spi::CFG1_RXDMAEN(1) | spi::CFG1_TXDMAEN(1));
  enable_and_start();
  ASSERT_EQ(core.complaints.size(), 2U) << "both directions";
  EXPECT_NE(core.complaints[0].find("by bytes"), std::string::npos);
}

TEST_F(SpiRules, OldFlagsAndWideAccesses) {
  write(spi, spi::CFG1, kFormat);
  write(spi, spi::CR2, 1);
  enable_and_start();
  write(spi, spi::TXDR, 1, 4);
  expect_complaint("not written by bytes");
  write(spi, spi::CR1, spi::CR1_SSI(1));
  expect_complaint("disabled before EOT was read");
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

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
