// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "firmware/boards/stm32h7/emulator/adc_model.hpp"
#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/debug_unit.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"
#include "firmware/boards/stm32h7/emulator/i2c_model.hpp"
#include "firmware/boards/stm32h7/emulator/pins.hpp"
#include "firmware/boards/stm32h7/emulator/processor.hpp"
#include "firmware/boards/stm32h7/emulator/spi_model.hpp"
#include "firmware/boards/stm32h7/emulator/timer_model.hpp"
#include "firmware/boards/stm32h7/emulator/uart_model.hpp"
#include "firmware/boards/stm32h7/emulator/usb_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// An STM32H743 or H753: processor, memories, peripherals, and how they are connected.
class Chip {
 public:
  static constexpr unsigned kPorts = 11;

  /// @param crystal_Hz  of the board, at HSE.
  explicit Chip(std::uint64_t crystal_Hz);
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  /// Power comes on: RAM and backup memory are lost.
  void power_on(std::uint32_t vector_table);

  /// Temperature of its junction.
  double temperature_degC{45.0};
  /// The processor executes ST's bootloader in ROM, of which nothing is modelled but that it waits.
  bool in_bootloader() const;

  PinPort& port(const PinName& pin) { return ports_[pin.port]; }

  Processor processor;
  FlashControl flash{processor};
  FlashSectorsWindow flash_sectors{processor, flash};
  PowerControl power{processor};
  ClockTree clocks;
  WatchdogModel watchdog{processor, clocks};
  SystemConfiguration configuration{processor};
  DebugUnit debug{processor};
  AxiMatrix axi{processor};
  ExternalInterrupts interrupts{processor, configuration};
  DmaMultiplexer multiplexer{processor};
  DmaModel dma1, dma2;
  DmaRequests requests{{&dma1, &dma2}};
  SpiModel spi1, spi2, spi3, spi4, spi5;
  UartModel usart1, usart2, usart3, uart4, usart6;
  I2cModel i2c1{processor, "I2C1", I2C1, clocks, irq::I2C1_EV, irq::I2C1_ER};
  UsbModel usb{processor, clocks, power};
  AdcModel adc1{processor, "ADC1", ADC1, clocks}, adc3{processor, "ADC3", ADC3, clocks};
  TimerModel tim1, tim2, tim3, tim4, tim5, tim6, tim7, tim8, tim12;

 private:
  SpiModel spi(const char* name, const Instance& instance, std::uint32_t receive, unsigned irq) {
    return {processor, name, instance, clocks, requests, {receive, receive + 1, irq}};
  }
  UartModel uart(const char* name, const Instance& instance, std::uint32_t receive, unsigned irq) {
    return {processor, name, instance, clocks, requests, {receive, receive + 1, irq}};
  }
  TimerModel timer(const char* name, const Instance& instance, unsigned irq, TimerModel::Kind kind,
                   std::uint32_t update_request = 0) {
    return {processor, name, instance, clocks, irq, kind, &requests, update_request};
  }
  void connect_dma();
  void check_what_stops();
  void write_factory_values();
  void write_bootloader();
  void check_backup_memory();
  void reset_peripherals(std::uint32_t offset, std::uint32_t bits);

  std::array<PinPort, kPorts> ports_;
  std::vector<Peripheral*> all_;
};

}  // namespace rosflight::boards::stm32h7::emulator
