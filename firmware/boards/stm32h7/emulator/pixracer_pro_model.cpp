// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/pixracer_pro_model.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr PinName kAccelSelect = pin('F', 6), kGyroSelect = pin('F', 10);
constexpr PinName kSensorSupply = pin('E', 3), kLevelShifter = pin('I', 3);
constexpr PinName kBaroSelect = pin('D', 7), kFramSelect = pin('D', 10);
constexpr unsigned kSpiFunction = 5, kI2cFunction = 4;
constexpr std::uint64_t kBmi088Max_Hz = 10'000'000, kDps310Max_Hz = 10'000'000;
/// Its edges drift through all phases of the link's traffic within seconds.
constexpr double kImuClockError = 3e-4;

}  // namespace

PixracerProModel::PixracerProModel()
    : CommonHardware{{24'000'000,
                      &Chip::spi5,
                      pin('F', 3),
                      pin('D', 12),
                      {&Chip::usart2, pin('D', 6), pin('D', 5), 7},
                      {&Chip::usart6, pin('C', 7), {}, 7},
                      {&Chip::uart4, pin('A', 1), pin('A', 0), 8},
                      {{&Chip::tim1, 3, pin('E', 14), 1},
                       {&Chip::tim1, 2, pin('E', 13), 1},
                       {&Chip::tim1, 1, pin('E', 11), 1},
                       {&Chip::tim1, 0, pin('E', 9), 1},
                       {&Chip::tim4, 1, pin('D', 13), 2},
                       {&Chip::tim4, 2, pin('D', 14), 2},
                       {&Chip::tim8, 0, pin('I', 5), 3},
                       {&Chip::tim8, 1, pin('I', 6), 3}},
                      {pin('B', 11), pin('B', 3), pin('B', 1)},
                      true,
                      {14, 15, 12.62, 60.5, 0.0747},
                      2}} {
  imu_.clock_error = kImuClockError;
  chip_.processor.add(accel_);
  chip_.processor.add(gyro_);
  connect_imu();
  connect_baro();
  connect_external();
}

/// A square wave on the buzzer's pin.
void PixracerProModel::report(FromChip& out) {
  constexpr unsigned kFunction = 1;
  CommonHardware::report(out);
  out.buzzer_Hz = 0;
  if (chip_.tim2.pulse(0) == 0) return;
  expect_pins({pin('A', 15)}, kFunction);
  out.buzzer_Hz = static_cast<std::uint32_t>(kTicksPerSecond / chip_.tim2.period());
}

void PixracerProModel::connect_imu() {
  chip_.port(kAccelSelect).on_output = [this](unsigned number, bool high) {
    if (number == kAccelSelect.number) accel_.select(!high);
    if (number == kGyroSelect.number) gyro_.select(!high);
  };
  imu_.gyro.line = [this](bool high, hal::Time /*when*/) { data_ready(high); };
  chip_.spi5.exchange = [this](std::uint8_t out) -> std::uint8_t {
    if (accel_.selected() && gyro_.selected())
      chip_.processor.complain("SPI5: both dies are selected");
    if (accel_.selected()) return accel_.exchange(out);
    return gyro_.selected() ? gyro_.exchange(out) : 0xFF;
  };
  chip_.spi5.on_start = [this](std::uint64_t clock_Hz) {
    expect_pins({pin('F', 7), pin('F', 8), pin('F', 9)}, kSpiFunction);
    for (const PinName& each : {kSensorSupply, kLevelShifter}) {
      const PinPort& port = chip_.port(each);
      if (!port.is_output(each.number) || !port.level(each.number)) {
        chip_.processor.complain("SPI5: the supply of the sensors is off");
      }
    }
    if (clock_Hz > kBmi088Max_Hz) chip_.processor.complain("SPI5: faster than a BMI088 allows");
  };
}

void PixracerProModel::connect_baro() {
  chip_.port(kBaroSelect).on_output = [this](unsigned number, bool high) {
    if (number == kBaroSelect.number) baro_on_bus_.select(!high);
    if (number == kFramSelect.number) fram_on_bus_.select(!high);
  };
  chip_.spi2.exchange = [this](std::uint8_t out) -> std::uint8_t {
    if (baro_on_bus_.selected() && fram_on_bus_.selected()) {
      chip_.processor.complain("SPI2: barometer and FRAM are both selected");
    }
    if (fram_on_bus_.selected()) return fram_on_bus_.exchange(out);
    return baro_on_bus_.selected() ? baro_on_bus_.exchange(out) : 0xFF;
  };
  chip_.spi2.on_start = [this](std::uint64_t clock_Hz) {
    expect_pins({pin('B', 10), pin('B', 14), pin('B', 15)}, kSpiFunction);
    if (baro_on_bus_.selected() && clock_Hz > kDps310Max_Hz)
      chip_.processor.complain("SPI2: faster than a DPS310 allows");
  };
}

/// What hangs on the GPS connector beside the receiver: magnetometer and pitot sensor on I2C.
void PixracerProModel::connect_external() {
  chip_.i2c1.connect(mag_);
  chip_.i2c1.connect(pitot_);
  chip_.i2c1.on_enable = [this] {
    expect_pins({pin('B', 8), pin('B', 9)}, kI2cFunction);
    for (const unsigned number : {8U, 9U}) chip_.port(pin('B', number)).expect_open_drain(number);
  };
}

void PixracerProModel::advance_parts() {
  accel_.advance();
  gyro_.advance();
  baro_on_bus_.advance();
  chip_.i2c1.advance();
}

void PixracerProModel::set_broken(const Broken& broken) {
  baro_on_bus_.set_mute(broken.baro);
  chip_.i2c1.hold_data_low(broken.mag || broken.stuck_i2c);
  mag_.registers.faults.mute = broken.no_mag;
  pitot_.mute = broken.pitot || !pitot_presence_.connected();
}

CommonHardware::Breakable PixracerProModel::breakable(FaultyPart which) {
  constexpr std::uint8_t kGyroIdentity = 0x00, kBaroIdentity = 0x0D, kMagIdentity = 0x00;
  if (which == FaultyPart::kImu) {
    return {{&imu_.accel, &imu_.gyro}, &gyro_, identity_of(imu_.gyro.registers, kGyroIdentity)};
  }
  if (which == FaultyPart::kBaro)
    return {{&baro_}, &baro_on_bus_, identity_of(baro_.registers, kBaroIdentity)};
  return {{&mag_}, nullptr, identity_of(mag_.registers, kMagIdentity)};
}

}  // namespace rosflight::boards::stm32h7::emulator
