// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/chip.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

using Kind = Processor::Kind;

constexpr std::uint32_t kBootloader = 0x1FF0'9800U;  // AN2606

/// RM0433 table of the memory map.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): the order of the reference manual
constexpr struct {
  std::uint32_t base;
  std::size_t size;
  Kind kind;
} kMemories[] = {
    {0x0000'0000U, 0x1'0000, Kind::kCode},    // ITCM
    {0x0800'0000U, 0x1C'0000, Kind::kFlash},  // both banks, but for the sectors of parameters
    {0x1FF0'9000U, 0x1000, Kind::kFlash},     // the bootloader in ROM
    {0x1FF1'E000U, 0x1000, Kind::kFlash},     // what the factory measured
    {0x2000'0000U, 0x2'0000, Kind::kRam},     // DTCM
    {0x2400'0000U, 0x8'0000, Kind::kRam},     // AXI SRAM
    {0x3000'0000U, 0x4'8000, Kind::kRam},     // SRAM1, 2 and 3
    {0x3800'0000U, 0x1'0000, Kind::kRam},     // SRAM4
    {0x3880'0000U, 0x1000, Kind::kRam},       // backup SRAM
};

constexpr Instance kPortInstances[Chip::kPorts] = {GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, GPIOF,
                                                   GPIOG, GPIOH, GPIOI, GPIOJ, GPIOK};

/// RCC has the reset register of each bus at this distance before its gates.
constexpr std::uint32_t kFromResetToGate = rcc::AHB1ENR - rcc::AHB1RSTR;

template <std::size_t... kIndex>
std::array<PinPort, Chip::kPorts> make_ports(Core& core, ExternalInterrupts& interrupts,
                                             std::index_sequence<kIndex...> /*ports*/) {
  return {PinPort{core, kIndex, kPortInstances[kIndex], interrupts}...};
}

}  // namespace

Chip::Chip(std::uint64_t crystal_Hz)
    : clocks{processor, crystal_Hz, flash, power},
      dma1{processor,
           "DMA1",
           DMA1,
           multiplexer,
           0,
           {irq::DMA1_STREAM0, irq::DMA1_STREAM1, irq::DMA1_STREAM2, irq::DMA1_STREAM3,
            irq::DMA1_STREAM4, irq::DMA1_STREAM5, irq::DMA1_STREAM6, irq::DMA1_STREAM7}},
      dma2{processor,
           "DMA2",
           DMA2,
           multiplexer,
           DmaModel::kStreams,
           {irq::DMA2_STREAM0, irq::DMA2_STREAM1, irq::DMA2_STREAM2, irq::DMA2_STREAM3,
            irq::DMA2_STREAM4, irq::DMA2_STREAM5, irq::DMA2_STREAM6, irq::DMA2_STREAM7}},
      spi1{spi("SPI1", SPI1, request::SPI1_RX, irq::SPI1)},
      spi2{spi("SPI2", SPI2, request::SPI2_RX, irq::SPI2)},
      spi3{spi("SPI3", SPI3, request::SPI3_RX, irq::SPI3)},
      spi4{spi("SPI4", SPI4, request::SPI4_RX, irq::SPI4)},
      spi5{spi("SPI5", SPI5, request::SPI5_RX, irq::SPI5)},
      usart1{uart("USART1", USART1, request::USART1_RX, irq::USART1)},
      usart2{uart("USART2", USART2, request::USART2_RX, irq::USART2)},
      usart3{uart("USART3", USART3, request::USART3_RX, irq::USART3)},
      uart4{uart("UART4", UART4, request::UART4_RX, irq::UART4)},
      usart6{uart("USART6", USART6, request::USART6_RX, irq::USART6)},
      tim1{timer("TIM1", TIM1, irq::TIM1_UP, TimerModel::Kind::kAdvanced, request::TIM1_UP)},
      tim2{timer("TIM2", TIM2, irq::TIM2, TimerModel::Kind::kWide)},
      tim3{timer("TIM3", TIM3, irq::TIM3, TimerModel::Kind::kPlain, request::TIM3_UP)},
      tim4{timer("TIM4", TIM4, irq::TIM4, TimerModel::Kind::kPlain, request::TIM4_UP)},
      tim5{timer("TIM5", TIM5, irq::TIM5, TimerModel::Kind::kWide)},
      tim6{timer("TIM6", TIM6, irq::TIM6_DAC, TimerModel::Kind::kPlain)},
      tim7{timer("TIM7", TIM7, irq::TIM7, TimerModel::Kind::kPlain)},
      tim8{timer("TIM8", TIM8, irq::TIM8_UP_TIM13, TimerModel::Kind::kAdvanced, request::TIM8_UP)},
      tim12{timer("TIM12", TIM12, irq::TIM8_BRK_TIM12, TimerModel::Kind::kPlain)},
      ports_{make_ports(processor, interrupts, std::make_index_sequence<kPorts>{})} {
  all_ = {&clocks, &flash,  &power, &watchdog, &configuration, &interrupts, &multiplexer,
          &dma1,   &dma2,   &spi1,  &spi2,     &spi4,          &spi5,       &usart1,
          &usart2, &usart3, &uart4, &usart6,   &tim1,          &tim2,       &tim3,
          &tim4,   &tim5,   &tim6,  &tim7,     &tim8,          &tim12};
  for (Peripheral* each : {static_cast<Peripheral*>(&spi3), static_cast<Peripheral*>(&i2c1),
                           static_cast<Peripheral*>(&debug), static_cast<Peripheral*>(&axi),
                           static_cast<Peripheral*>(&flash_sectors), static_cast<Peripheral*>(&usb),
                           static_cast<Peripheral*>(&adc1), static_cast<Peripheral*>(&adc3)})
    all_.push_back(each);
  for (PinPort& port : ports_) all_.push_back(&port);
  for (const auto& memory : kMemories) processor.add_memory(memory.base, memory.size, memory.kind);
  for (Peripheral* each : all_) processor.add(*each);
  processor.finish();
  processor.set_gate([this](const Instance& instance) { return clocks.gate_open(instance); });
  clocks.on_core_clock = [this](std::uint64_t core_Hz) { processor.set_frequency(core_Hz); };
  clocks.on_peripheral_reset = [this](std::uint32_t offset, std::uint32_t bits) {
    reset_peripherals(offset, bits);
  };
  processor.on_reset = [this](bool by_software) {
    if (by_software) clocks.set_reset_cause(rcc::RSR_SFTRSTF);
    check_backup_memory();
  };
  watchdog.on_bite = [this] { check_backup_memory(); };
  connect_dma();
  check_what_stops();
  write_factory_values();
  write_bootloader();
}

/// A vector table, and two instructions: wait for an interrupt, again.
void Chip::write_bootloader() {
  constexpr std::uint32_t kStack = 0x2000'1000U, kEntry = kBootloader + 8;
  constexpr std::uint32_t kWaitForEver = 0xE7FD'BF30U;
  const std::array<std::uint32_t, 3> words{kStack, kEntry | 1U, kWaitForEver};
  std::memcpy(processor.memory(kBootloader, sizeof words), words.data(), sizeof words);
}

bool Chip::in_bootloader() const {
  const std::uint32_t at = processor.stands_at() & ~1U;
  return at >= kBootloader && at < kBootloader + 0x800U;
}

/// Reference and temperature sensor of the converters; what ADC3 finds of them is their share of the supply. The
/// sensor's voltages are typical ones of the data sheet.
void Chip::write_factory_values() {
  constexpr double kReference_V = 1.212, kCalibratedAt_V = 3.3;
  constexpr double kAt30_V = 0.62, kSlope_V_K = 2e-3;
  constexpr unsigned kTemperatureChannel = 18, kReferenceChannel = 19;
  const auto sensor_V = [=](double degC) { return kAt30_V + kSlope_V_K * (degC - 30.0); };
  const auto write = [this](std::uint32_t address, double volts) {
    const auto code = static_cast<std::uint16_t>(65535.0 * volts / kCalibratedAt_V);
    std::memcpy(processor.memory(address, sizeof code), &code, sizeof code);
  };
  write(0x1FF1'E860U, kReference_V);
  write(0x1FF1'E820U, sensor_V(30.0));
  write(0x1FF1'E840U, sensor_V(110.0));
  adc3.pin_V = [this, sensor_V](unsigned channel) {
    const std::uint32_t control = std::as_const(adc3).word(adc::CCR);
    if (channel == kReferenceChannel && adc::CCR_VREFEN.of(control) != 0) return kReference_V;
    const bool senses = channel == kTemperatureChannel && adc::CCR_TSEN.of(control) != 0;
    return senses ? sensor_V(temperature_degC) : 0.0;
  };
}

/// By the time that something counts, a debugger's halt must be able to stop it, and the errata of the silicon must have
/// been heeded.
void Chip::check_what_stops() {
  const auto check = [this](const Peripheral& started) {
    if (!debug.stops(started.instance()))
      processor.complain(started.name() + ": counts on while a debugger has halted the processor");
  };
  for (TimerModel* timer : {&tim1, &tim2, &tim3, &tim4, &tim5, &tim6, &tim7, &tim8, &tim12})
    timer->on_start = [check, timer] { check(*timer); };
  watchdog.on_start = [this, check] {
    check(watchdog);
    if (debug.revision() == DebugUnit::Revision::kY && !axi.reads_one_at_a_time())
      processor.complain("revision Y: the AXI SRAM may be read wrongly");
  };
}

void Chip::connect_dma() {
  multiplexer.stream_runs = [this](std::size_t channel) {
    return channel < DmaModel::kStreams ? dma1.runs(channel)
                                        : dma2.runs(channel - DmaModel::kStreams);
  };
  for (DmaModel* each : {&dma1, &dma2}) {
    each->memory_is_clocked = [this](std::uint32_t address) {
      constexpr std::uint32_t kSram2 = 0x3002'0000U, kSram3 = 0x3004'0000U;
      if (address < 0x3000'0000U || address >= 0x3004'8000U) return true;
      const Field& gate = address < kSram2   ? rcc::AHB2ENR_SRAM1EN
                          : address < kSram3 ? rcc::AHB2ENR_SRAM2EN
                                             : rcc::AHB2ENR_SRAM3EN;
      return clocks.gate_open({address, rcc::AHB2ENR, static_cast<std::uint8_t>(gate.lsb)});
    };
    each->on_start = [this](std::uint32_t request) {
      for (UartModel* uart : {&usart1, &usart2, &usart3, &uart4, &usart6})
        uart->stream_started(request);
      for (TimerModel* timer : {&tim1, &tim3, &tim4, &tim8}) timer->stream_started(request);
    };
  }
}

void Chip::reset_peripherals(std::uint32_t offset, std::uint32_t bits) {
  for (Peripheral* each : all_) {
    const Instance& instance = each->instance();
    if (instance.gate == offset + kFromResetToGate && (bits >> instance.gate_bit & 1U) != 0) {
      each->reset();
    }
  }
}

/// What lies in a dirty cache line, or was written without permission, is lost with the reset.
void Chip::check_backup_memory() {
  constexpr std::uint32_t kBackup = 0x3880'0000U;
  if (processor.cacheable(kBackup))
    processor.complain("backup memory lies in cached memory at a reset");
  constexpr std::uint32_t kRecord = 0x2400'0000U;
  const std::uint8_t* const record = processor.memory(kRecord, 8);
  const bool in_use = std::any_of(record, record + 8, [](std::uint8_t byte) { return byte != 0; });
  if (in_use && processor.cacheable(kRecord))
    processor.complain("the flight record lies in cached memory at a reset");
}

void Chip::power_on(std::uint32_t vector_table) {
  for (const auto& memory : kMemories) {
    if (memory.kind == Kind::kRam)
      std::memset(processor.memory(memory.base, memory.size), 0, memory.size);
  }
  clocks.set_power_on();
  processor.power_on(vector_table);
}

}  // namespace rosflight::boards::stm32h7::emulator
