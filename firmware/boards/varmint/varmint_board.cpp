// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/varmint/varmint_board.hpp"

#include <iterator>

namespace rosflight::boards::varmint {
namespace {

/// The IMU needs 350 ms after its reset.
constexpr hal::Time kSensorWait = hal::milliseconds(500);
constexpr std::uint32_t kSyncPeriod_us = 500, kSyncHigh_us = 250;
/// Pended by the pitot sensor's edge: the same event in the bus context.
constexpr unsigned kPitotIrq = stm32h7::irq::SPI2;

/// Both sit turned about the vertical; the magnetometer upside down.
constexpr parts::Mounting kImuMounting{{0, 1, 2}, {-1.0f, -1.0f, 1.0f}};
constexpr parts::Mounting kMagMounting{{0, 1, 2}, {-1.0f, 1.0f, -1.0f}};

parts::Adis16500::Config imu_config() {
  parts::Adis16500::Config config;
  config.rate_hz = 1000;
  config.mounting = kImuMounting;
  return config;
}

}  // namespace

Varmint::Varmint(Memory& memory, parts::Start how)
    : FlightBoard{kPlan, memory, how},
      imu_hardware_{kImuBus, kImuDevices, std::size(kImuDevices), memory.imu},
      imu_bus_{imu_hardware_, clock_},
      imu_{imu_port_, imu_reset_, imu_config()},
      sensor_buses_{
          make_buses(memory, clock_, std::make_index_sequence<std::size(kSensorBuses)>{})},
      mag_{mag_port_, kMagMounting},
      i2c_bus_{i2c_hardware_, clock_, stm32h7::I2cBus::kLimit} {
  system_.set_sensors({{{&imu_, "ADIS16500: started"},
                        {&baro_, "DPS310: started"},
                        {&mag_, "IIS2MDC: started"},
                        {&pitot_, "DLHR: started"},
                        kHasServoSupply ? stm32h7::SystemSensor{&servo_supply_, "MCP4017: started"}
                                        : stm32h7::SystemSensor{},
                        {&gnss_, nullptr}}},
                      kSensorWait);
}

void Varmint::open() {
  stm32h7::start_square_wave(stm32h7::TIM12, kSyncPeriod_us, kSyncHigh_us);
  stm32h7::make_alternate(kSyncClock, kSyncClockFunction);
  stm32h7::make_output(kImuReset, true);
  for (const Pin& pin : kUnusedSelects) stm32h7::make_output(pin, true);
  imu_hardware_.open(imu_bus_);
  for (SensorBus& each : sensor_buses_) each.hardware.open(each.bus);
  i2c_hardware_.open(i2c_bus_);
  stm32h7::make_input(kPitotReady, stm32h7::Pull::kDown);
  stm32h7::watch_rising_edge(kPitotReady);
  stm32h7::enable_interrupt(kPitotIrq, stm32h7::Priority::kBus);
  flash_.open();
  open_common();
  storage_.mount();
}

void Varmint::on_sensor_bus(std::size_t index) {
  sensor_buses_[index].hardware.on_interrupt();
  wake_when_idle(sensor_buses_[index].bus);
}

void Varmint::on_edges() {
  if (stm32h7::edge_pending(kImuReady)) on_imu_ready();
  if (stm32h7::edge_pending(kPitotReady)) {
    stm32h7::clear_edge(kPitotReady);
    stm32h7::pend_interrupt(kPitotIrq);
  }
}

void Varmint::on_tick() {
  stm32h7::clear_tick();
  for (parts::SharedBus* const bus : {&imu_bus_, &i2c_bus_}) bus->step();
  for (SensorBus& each : sensor_buses_) each.bus.step();
  step_common();
}

}  // namespace rosflight::boards::varmint
