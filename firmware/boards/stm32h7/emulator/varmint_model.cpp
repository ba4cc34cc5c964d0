// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/varmint_model.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr PinName kImuSelect = pin('E', 4), kImuReset = pin('E', 12), kSyncClock = pin('B', 14);
constexpr PinName kBaroSelect = pin('E', 1), kMagSelect = pin('B', 12);
constexpr PinName kPitotReady = pin('E', 9);
constexpr unsigned kSpiFunction = 5, kI2cFunction = 4, kSyncFunction = 2;
constexpr std::uint64_t kAdis16500Max_Hz = 1'000'000, kBaroBusMax_Hz = 10'000'000;
constexpr Ticks kSyncPeriod = 500 * kTicksPerMicrosecond;

PinName red_led(VarmintModel::Revision revision) {
  return revision == VarmintModel::Revision::k10X ? pin('E', 7) : pin('B', 2);
}

}  // namespace

VarmintModel::VarmintModel(Revision revision)
    : CommonHardware{{50'000'000,
                      &Chip::spi4,
                      pin('B', 8),
                      pin('A', 3),
                      {&Chip::usart2, pin('D', 6), pin('D', 5), 7},
                      {&Chip::usart3, pin('D', 9), {}, 7},
                      {&Chip::usart1, pin('B', 7), pin('A', 9), 7},
                      {{&Chip::tim1, 0, pin('A', 8), 1},
                       {&Chip::tim1, 1, pin('E', 11), 1},
                       {&Chip::tim1, 2, pin('A', 10), 1},
                       {&Chip::tim1, 3, pin('E', 14), 1},
                       {&Chip::tim4, 2, pin('D', 14), 2},
                       {&Chip::tim4, 1, pin('D', 13), 2},
                       {&Chip::tim4, 0, pin('D', 12), 2},
                       {&Chip::tim4, 3, pin('D', 15), 2},
                       {&Chip::tim3, 0, pin('C', 6), 2},
                       {&Chip::tim3, 1, pin('B', 5), 2}},
                      {red_led(revision), pin('E', 8), pin('E', 15)},
                      false,
                      {16, 11, 11.215, 10.0, 0.0},
                      1}} {
  chip_.processor.add(imu_on_bus_);
  imu_.sync_clock = false;
  // The older board has older silicon, so that its erratum is heeded in a flight.
  if (revision == Revision::k10X) chip_.debug.set_revision(DebugUnit::Revision::kY);
  connect_imu();
  chip_.port(kMagSelect).on_output = [this](unsigned number, bool high) {
    if (number == kMagSelect.number) mag_on_bus_.select(!high);
  };
  if (revision == Revision::k10X) {
    connect_own_buses();
  } else {
    connect_shared_bus();
  }
  connect_i2c(revision != Revision::k10X);
}

void VarmintModel::connect_imu() {
  chip_.port(kImuSelect).on_output = [this](unsigned number, bool high) {
    if (number == kImuSelect.number) {
      if (!chip_.port(kImuSelect).is_output(number)) imu_.abandon();
      imu_on_bus_.select(!high);
    }
    if (number == kBaroSelect.number) baro_on_bus_.select(!high);
    if (number != kImuReset.number) return;
    imu_on_bus_.advance();
    imu_.reset_pin(high);
    imu_on_bus_.advance();
  };
  imu_.line = [this](bool high, hal::Time /*when*/) { data_ready(high); };
  chip_.spi4.exchange = [this](std::uint8_t out) -> std::uint8_t {
    return imu_on_bus_.selected() ? imu_on_bus_.exchange(out) : 0xFF;
  };
  chip_.spi4.on_start = [this](std::uint64_t clock_Hz) {
    expect_pins({pin('E', 2), pin('E', 13), pin('E', 6)}, kSpiFunction);
    if (clock_Hz > kAdis16500Max_Hz)
      chip_.processor.complain("SPI4: faster than a burst of an ADIS16500 allows");
  };
  chip_.tim12.on_change = [this] { look_at_sync_clock(); };
}

void VarmintModel::look_at_sync_clock() {
  const bool runs = chip_.tim12.pulse(0) > 0 && chip_.tim12.period() == kSyncPeriod;
  if (runs == imu_.sync_clock) return;
  imu_on_bus_.advance();
  imu_.sync_clock = runs;
  imu_on_bus_.advance();
}

void VarmintModel::connect_shared_bus() {
  chip_.spi2.exchange = [this](std::uint8_t out) -> std::uint8_t {
    if (baro_on_bus_.selected() && mag_on_bus_.selected()) {
      chip_.processor.complain("SPI2: barometer and magnetometer are both selected");
    }
    if (mag_on_bus_.selected()) return mag_on_bus_.exchange(out);
    return baro_on_bus_.selected() ? baro_on_bus_.exchange(out) : 0xFF;
  };
  chip_.spi2.on_start = [this](std::uint64_t clock_Hz) { check_mag_bus(clock_Hz); };
}

void VarmintModel::check_mag_bus(std::uint64_t clock_Hz) {
  expect_pins({pin('B', 13), pin('C', 2), pin('C', 3)}, kSpiFunction);
  if (!chip_.configuration.pads_of_port_c_connected())
    chip_.processor.complain("SPI2: the pads PC2_C and PC3_C are not connected");
  if (clock_Hz > kBaroBusMax_Hz) chip_.processor.complain("SPI2: faster than its parts allow");
}

void VarmintModel::connect_own_buses() {
  chip_.spi2.exchange = [this](std::uint8_t out) -> std::uint8_t {
    return mag_on_bus_.selected() ? mag_on_bus_.exchange(out) : 0xFF;
  };
  chip_.spi2.on_start = [this](std::uint64_t clock_Hz) { check_mag_bus(clock_Hz); };
  chip_.spi3.exchange = [this](std::uint8_t out) -> std::uint8_t {
    return baro_on_bus_.selected() ? baro_on_bus_.exchange(out) : 0xFF;
  };
  chip_.spi3.on_start = [this](std::uint64_t clock_Hz) {
    constexpr unsigned kClockAndInFunction = 6, kOutFunction = 7;
    expect_pins({pin('B', 3), pin('B', 4)}, kClockAndInFunction);
    expect_pins({pin('B', 2)}, kOutFunction);
    if (clock_Hz > kBaroBusMax_Hz) chip_.processor.complain("SPI3: faster than its part allows");
  };
}

void VarmintModel::connect_i2c(bool with_servo_supply) {
  chip_.i2c1.connect(pitot_);
  if (with_servo_supply) chip_.i2c1.connect(servo_supply_);
  chip_.i2c1.on_enable = [this] {
    expect_pins({pin('B', 6), pin('B', 9)}, kI2cFunction);
    for (const unsigned number : {6U, 9U}) chip_.port(pin('B', number)).expect_open_drain(number);
  };
  pitot_.line = [this](bool high, hal::Time /*when*/) {
    chip_.port(kPitotReady).drive(kPitotReady.number, high);
  };
}

/// As the part sits on the board: turned about the vertical.
parts::models::ImuTruth VarmintModel::turned_imu_truth(hal::Time when) const {
  parts::models::ImuTruth truth = imu_truth(when);
  for (std::size_t k = 0; k < 2; ++k) {
    truth.accel_m_s2[k] = -truth.accel_m_s2[k];
    truth.gyro_rad_s[k] = -truth.gyro_rad_s[k];
  }
  return truth;
}

/// Its x points back.
parts::models::MagTruth VarmintModel::mag_truth() const {
  parts::models::MagTruth truth = mag_truth_;
  truth.field_T[0] = -truth.field_T[0];
  return truth;
}

void VarmintModel::advance_parts() {
  if (imu_.sync_clock) chip_.port(kSyncClock).expect_alternate(kSyncClock.number, kSyncFunction);
  imu_on_bus_.advance();
  baro_on_bus_.advance();
  mag_on_bus_.advance();
  chip_.i2c1.advance();
}

void VarmintModel::set_broken(const Broken& broken) {
  baro_on_bus_.set_mute(broken.baro);
  mag_on_bus_.set_mute(broken.mag || broken.no_mag);
  chip_.i2c1.hold_data_low(broken.stuck_i2c);
  pitot_.mute = broken.pitot;
}

CommonHardware::Breakable VarmintModel::breakable(FaultyPart which) {
  constexpr std::uint8_t kBaroIdentity = 0x0D, kMagIdentity = 0x4F;
  constexpr std::uint16_t kAdis16500 = 0x4074, kAdis16505 = 0x4079;
  if (which == FaultyPart::kImu) {
    return {{&imu_}, &imu_on_bus_, [this](bool wrong) {
              imu_.product = wrong ? kAdis16505 : kAdis16500;
            }};
  }
  if (which == FaultyPart::kBaro)
    return {{&baro_}, &baro_on_bus_, identity_of(baro_.registers, kBaroIdentity)};
  return {{&mag_}, &mag_on_bus_, identity_of(mag_.registers, kMagIdentity)};
}

}  // namespace rosflight::boards::stm32h7::emulator
