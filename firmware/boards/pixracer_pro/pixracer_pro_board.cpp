// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/pixracer_pro/pixracer_pro_board.hpp"

#include <iterator>

namespace rosflight::boards::pixracer_pro {
namespace {

constexpr hal::Time kSensorWait = hal::milliseconds(200);

parts::Bmi088::Config imu_config() {
  parts::Bmi088::Config config;
  config.gyro_rate = parts::Bmi088::GyroRate::k2000Hz230;
  return config;
}

}  // namespace

PixracerPro::PixracerPro(Memory& memory, parts::Start how)
    : FlightBoard{kPlan, memory, how},
      imu_hardware_{kImuBus, kImuDevices, std::size(kImuDevices), memory.imu},
      imu_bus_{imu_hardware_, clock_},
      imu_{accel_, gyro_, imu_config()},
      baro_hardware_{kBaroBus, kBaroBusDevices, std::size(kBaroBusDevices), memory.baro},
      baro_bus_{baro_hardware_, clock_},
      external_bus_{external_hardware_, clock_, stm32h7::I2cBus::kLimit} {
  // GNSS receiver, which also takes seconds to find, and pitot sensor need not be connected.
  system_.set_sensors({{{&imu_, "BMI088: started"},
                        {&baro_, "DPS310: started"},
                        {&mag_, "IST8308: started"},
                        {&gnss_, nullptr},
                        {&pitot_, nullptr}}},
                      kSensorWait);
}

void PixracerPro::open() {
  stm32h7::make_output(kSensorSupply, true);
  stm32h7::make_output(kLevelShifter, true);
  for (const Pin& pin : kUnusedSelects) stm32h7::make_output(pin, true);
  imu_hardware_.open(imu_bus_);
  baro_hardware_.open(baro_bus_);
  external_hardware_.open(external_bus_);
  stm32h7::start_square_wave(stm32h7::TIM2, 0, 0);
  stm32h7::make_alternate(kBuzzer, kBuzzerFunction);
  open_common();
  // Without it the storage has no bytes, which the core reports.
  static_cast<void>(storage_.identify());
}

void PixracerPro::sound(const parts::Buzzer::Inputs& inputs, hal::Time now) {
  const std::uint32_t tone_us = buzzer_.step(inputs, now);
  if (tone_us == tone_us_) return;
  tone_us_ = tone_us;
  stm32h7::start_square_wave(stm32h7::TIM2, tone_us, tone_us / 2);
}

void PixracerPro::on_tick() {
  stm32h7::clear_tick();
  for (parts::SharedBus* const bus : {&imu_bus_, &baro_bus_, &external_bus_}) bus->step();
  step_common();
}

}  // namespace rosflight::boards::pixracer_pro
