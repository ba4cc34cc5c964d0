// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <utility>

#include "firmware/boards/parts/adis16500.hpp"
#include "firmware/boards/parts/dlhr.hpp"
#include "firmware/boards/parts/dps310.hpp"
#include "firmware/boards/parts/flash_storage.hpp"
#include "firmware/boards/parts/iis2mdc.hpp"
#include "firmware/boards/parts/mcp4017.hpp"
#include "firmware/boards/stm32h7/flash_sectors.hpp"
#include "firmware/boards/varmint/varmint_pins.hpp"

namespace rosflight::boards::varmint {

class Varmint final : public stm32h7::FlightBoard {
 public:
  /// What the DMA touches; an object of section .dma.
  struct Memory : FlightBoard::Memory {
    stm32h7::SpiBuffers imu;
    std::array<stm32h7::SpiBuffers, std::size(kSensorBuses)> sensors;
  };

  /// Clocks and memory system run already.
  Varmint(Memory& memory, parts::Start how);

  /// Sets the MPU's regions, from number `first` on, before the caches are on.
  static void map_memory(unsigned first) { stm32h7::FlashSectors::map_memory(first); }
  /// Opens buses and inputs, starts the tick and the interrupts.
  void open();
  hal::Board roles() { return FlightBoard::roles(storage_, imu_, mag_, baro_, pitot_); }
  /// Main loop, once per pass: the storage copies and erases; not while armed.
  void maintain(bool armed) {
    if (!armed) storage_.maintain();
  }
  static constexpr bool kHasBuzzer = false;

  /// Data ready of the IMU and end of conversion of the pitot sensor.
  void on_edges();
  void on_imu_sample() { imu_.data_ready(edge_time()); }
  void on_pitot_ready() { pitot_.conversion_done(clock_.now()); }
  void on_imu_bus() { imu_hardware_.on_interrupt(), wake_when_idle(imu_bus_); }
  /// @param index  in kSensorBuses.
  void on_sensor_bus(std::size_t index);
  void on_i2c() { i2c_hardware_.on_interrupt(), wake_when_idle(i2c_bus_); }
  void on_tick();

 private:
  struct SensorBus {
    SensorBus(const stm32h7::SpiBus::Pins& pins, stm32h7::SpiBuffers& memory,
              const hal::Clock& clock)
        : hardware{pins, kBaroBusDevices, std::size(kBaroBusDevices), memory},
          bus{hardware, clock} {}
    stm32h7::SpiBus hardware;
    parts::SharedBus bus;
  };
  using SensorBuses = std::array<SensorBus, std::size(kSensorBuses)>;
  template <std::size_t... kIndex>
  static SensorBuses make_buses(Memory& memory, const hal::Clock& clock,
                                std::index_sequence<kIndex...> /*buses*/) {
    // NOLINTNEXTLINE(clang-analyzer-core.StackAddressEscape): made in place, no temporary object
    return {SensorBus{kSensorBuses[kIndex], memory.sensors[kIndex], clock}...};
  }

  stm32h7::SpiBus imu_hardware_;
  parts::SharedBus imu_bus_;
  parts::SharedPort imu_port_{imu_bus_, 0, true};
  stm32h7::DrivenPin imu_reset_{kImuReset};
  parts::Adis16500 imu_;
  SensorBuses sensor_buses_;
  parts::SharedPort baro_port_{sensor_buses_[kBaroBus].bus, kBaro};
  parts::Dps310 baro_{baro_port_, true};
  parts::SharedPort mag_port_{sensor_buses_[kMagBus].bus, kMag};
  parts::Iis2mdc mag_;
  stm32h7::I2cBus i2c_hardware_{kI2c};
  parts::SharedBus i2c_bus_;
  parts::SharedPort pitot_port_{i2c_bus_, parts::Dlhr::kAddress};
  parts::Dlhr pitot_{pitot_port_};
  parts::SharedPort supply_port_{i2c_bus_, parts::Mcp4017::kAddress};
  parts::Mcp4017 servo_supply_{supply_port_, kServoSupply_V};
  stm32h7::FlashSectors flash_;
  parts::FlashStorage storage_{flash_, clock_};
};

}  // namespace rosflight::boards::varmint
