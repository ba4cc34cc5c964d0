// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/pixracer_pro_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.hpp"
#include "firmware/boards/stm32h7/emulator/sbus_frame.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr PinName pin(char port, unsigned number) {
  return {static_cast<unsigned>(port - 'A'), number};
}
constexpr PinName kAccelSelect = pin('F', 6), kGyroSelect = pin('F', 10), kGyroReady = pin('F', 3);
constexpr PinName kImuClock = pin('F', 7), kImuIn = pin('F', 8), kImuOut = pin('F', 9);
constexpr PinName kSensorSupply = pin('E', 3), kLevelShifter = pin('I', 3);
constexpr PinName kBaroSelect = pin('D', 7), kFramSelect = pin('D', 10), kBaroClock = pin('B', 10),
                  kBaroIn = pin('B', 14), kBaroOut = pin('B', 15);
constexpr PinName kPulsePerSecond = pin('D', 12);
constexpr PinName kRedLed = pin('B', 11), kGreenLed = pin('B', 1), kBlueLed = pin('B', 3);
constexpr unsigned kSpi5Function = 5, kSpi2Function = 5, kUsartFunction = 7, kI2cFunction = 4,
                   kUart4Function = 8;
constexpr std::uint64_t kBmi088Max_Hz = 10'000'000, kDps310Max_Hz = 10'000'000;
constexpr parts::UartFormat kSbus{100'000, true, 2, true};

}  // namespace

PixracerProModel::PixracerProModel()
    : outputs_{{{&chip_.tim1, 3, pin('E', 14), 1},
                {&chip_.tim1, 2, pin('E', 13), 1},
                {&chip_.tim1, 1, pin('E', 11), 1},
                {&chip_.tim1, 0, pin('E', 9), 1},
                {&chip_.tim4, 1, pin('D', 13), 2},
                {&chip_.tim4, 2, pin('D', 14), 2},
                {&chip_.tim8, 0, pin('I', 5), 3},
                {&chip_.tim8, 1, pin('I', 6), 3}}} {
  chip_.processor.add(accel_);
  chip_.processor.add(gyro_);
  chip_.processor.add(gnss_on_wire_);
  connect_imu();
  connect_baro();
  connect_external();
  connect_serial();
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
    for (const PinName& each : {kImuClock, kImuIn, kImuOut}) {
      chip_.port(each).expect_alternate(each.number, kSpi5Function);
    }
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
    for (const PinName& each : {kBaroClock, kBaroIn, kBaroOut}) {
      chip_.port(each).expect_alternate(each.number, kSpi2Function);
    }
    if (baro_on_bus_.selected() && clock_Hz > kDps310Max_Hz)
      chip_.processor.complain("SPI2: faster than a DPS310 allows");
  };
}

/// What hangs on the GPS connector: magnetometer and pitot sensor on I2C, receiver, pulse per second.
void PixracerProModel::connect_external() {
  chip_.i2c1.connect(mag_);
  chip_.i2c1.connect(pitot_);
  chip_.i2c1.on_enable = [this] {
    for (const PinName& each : {pin('B', 8), pin('B', 9)}) {
      chip_.port(each).expect_alternate(each.number, kI2cFunction);
      chip_.port(each).expect_open_drain(each.number);
    }
  };
  chip_.uart4.on_enable = [this] {
    for (const PinName& each : {pin('A', 0), pin('A', 1)}) {
      chip_.port(each).expect_alternate(each.number, kUart4Function);
    }
  };
  gnss_.pulse = [this](bool high, hal::Time /*when*/) {
    chip_.port(kPulsePerSecond).drive(kPulsePerSecond.number, high);
  };
}

/// The world's newest solution, moved on to another time with its velocity.
parts::models::GnssTruth PixracerProModel::gnss_truth(hal::Time when) const {
  const hal::GnssSample& s = gnss_sample_;
  const double dt_s = 1e-6 * static_cast<double>((when - s.stamp).count());
  constexpr double kMetresPerDegree = 111'319.49;  // of latitude, and of longitude at the equator
  const double north_m_s = static_cast<double>(s.velocity_ned_m_s[0]);
  const double east_m_s = static_cast<double>(s.velocity_ned_m_s[1]);
  parts::models::GnssTruth truth;
  truth.latitude_deg = s.latitude_deg + north_m_s * dt_s / kMetresPerDegree;
  truth.longitude_deg = s.longitude_deg + east_m_s * dt_s / kMetresPerDegree /
                                              std::cos(s.latitude_deg * base::kRadPerDeg);
  truth.height_msl_m =
      static_cast<double>(s.height_msl_m) - static_cast<double>(s.velocity_ned_m_s[2]) * dt_s;
  for (std::size_t k = 0; k < 3; ++k)
    truth.velocity_ned_m_s[k] = static_cast<double>(s.velocity_ned_m_s[k]);
  truth.fix = static_cast<int>(s.fix);
  truth.satellites = s.satellites;
  return truth;
}

void PixracerProModel::connect_serial() {
  chip_.usart2.on_byte = [this](std::uint8_t byte, std::uint32_t /*baud*/) {
    sent_.push_back(byte);
  };
  chip_.usart2.on_enable = [this] {
    chip_.port(pin('D', 5)).expect_alternate(5, kUsartFunction);
    chip_.port(pin('D', 6)).expect_alternate(6, kUsartFunction);
  };
  chip_.usart6.on_enable = [this] { chip_.port(pin('C', 7)).expect_alternate(7, kUsartFunction); };
}

void PixracerProModel::data_ready(bool high) {
  if (imu_is_silent_) return;
  if (high) {
    note_output_latency();
    edge_ = chip_.processor.now();
  }
  chip_.port(kGyroReady).drive(kGyroReady.number, high);
}

/// Of the edge before: an output was written between it and now.
void PixracerProModel::note_output_latency() {
  const Ticks written = chip_.tim1.written(0);
  if (edge_ != 0 && written > edge_) latency_ = std::max(latency_, written - edge_);
}

std::vector<parts::models::Part*> PixracerProModel::all_parts() {
  return {&imu_.accel, &imu_.gyro, &baro_, &fram_, &mag_, &pitot_, &gnss_};
}

void PixracerProModel::power_on() {
  for (parts::models::Part* const part : all_parts()) {
    part->advance(part_time(chip_.processor.now()));
    part->set_power(false);
    part->set_power(true);
  }
  accel_.advance();
  gyro_.advance();
  gnss_on_wire_.advance();
  sent_.clear();
  latency_ = edge_ = 0;
}

void PixracerProModel::expose(const ToChip& world) {
  accel_.advance();
  imu_is_silent_ = world.has_imu == 0;
  if (world.has_imu != 0) {
    std::copy(world.imu.accel_m_s2.begin(), world.imu.accel_m_s2.end(),
              imu_truth_.accel_m_s2.begin());
    std::copy(world.imu.gyro_rad_s.begin(), world.imu.gyro_rad_s.end(),
              imu_truth_.gyro_rad_s.begin());
    imu_truth_.temperature_K = static_cast<double>(world.imu.temperature_K);
  }
  baro_on_bus_.advance();
  chip_.i2c1.advance();
  baro_on_bus_.set_mute(baro_presence_.lost(world.has_baro != 0, world.time_us));
  chip_.i2c1.hold_data_low(mag_presence_.lost(world.has_mag != 0, world.time_us));
  gnss_on_wire_.set_mute(gnss_presence_.lost(world.has_gnss != 0, world.time_us));
  if (world.has_baro != 0) {
    baro_truth_ = {static_cast<double>(world.baro.pressure_Pa),
                   static_cast<double>(world.baro.temperature_K)};
  }
  const bool pitot_lost = pitot_presence_.lost(world.has_diff_pressure != 0, world.time_us);
  pitot_.mute = pitot_lost || !pitot_presence_.connected();
  if (world.has_diff_pressure != 0) {
    pitot_truth_ = {static_cast<double>(world.diff_pressure.pressure_Pa),
                    static_cast<double>(world.diff_pressure.temperature_K)};
  }
  if (world.has_mag != 0) {
    // The part's axes: its z points up.
    const hal::Vec3& field = world.mag.field_T;
    mag_truth_.field_T = {static_cast<double>(field[0]), static_cast<double>(field[1]),
                          -static_cast<double>(field[2])};
  }
  if (world.has_gnss != 0) {
    gnss_sample_ = world.gnss;
    constexpr std::int64_t kPerSecond = 1'000'000;
    gnss_.epoch =
        world.gnss.stamp - hal::Time{world.gnss.unix_s * kPerSecond + world.gnss.unix_ns / 1000};
  }
  if (world.has_rc != 0) {
    const SbusFrame frame = sbus_frame(world.rc);
    chip_.usart6.feed(frame.data(), frame.size(), kSbus);
  }
  if (world.link_count > 0) {
    parts::UartFormat format;
    format.baud = world.link_baud;
    chip_.usart2.feed(world.link.data(), world.link_count, format);
  }
}

void PixracerProModel::inject(HardwareFault fault) {
  if (fault == HardwareFault::kBusError) chip_.spi5.fail_next_write();
  if (fault == HardwareFault::kStuckInterrupt) chip_.interrupts.stick(kGyroReady.number);
}

void PixracerProModel::report(FromChip& out) {
  constexpr float kShortest_us = 1000.0F, kSpan_us = 1000.0F;
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    const Output& output = outputs_[k];
    const Ticks pulse = output.timer->pulse(output.channel);
    out.outputs[k] = 0.0F;
    if (pulse == 0) continue;
    chip_.port(output.pin).expect_alternate(output.pin.number, output.function);
    const float us = static_cast<float>(pulse) / static_cast<float>(kTicksPerMicrosecond);
    out.outputs[k] = std::max((us - kShortest_us) / kSpan_us, 0.0F);
  }
  const auto lit = [this](const PinName& led) {  // open drain: low is lit
    const PinPort& port = chip_.port(led);
    return static_cast<std::uint8_t>(port.is_output(led.number) && !port.level(led.number));
  };
  out.leds = {lit(kRedLed), lit(kBlueLed), lit(kGreenLed), 0};
  const std::size_t count = std::min(sent_.size(), out.link.size());
  std::copy_n(sent_.begin(), count, out.link.begin());
  out.link_count = static_cast<std::uint32_t>(count);
  sent_.erase(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(count));
  out.link_received = chip_.usart2.received();
  out.link_sent = chip_.usart2.sent();
  out.link_lost = chip_.usart2.overruns() + chip_.usart2.line_errors();
  out.clock_zero_us = chip_.tim5.counts()
                          ? static_cast<std::int64_t>(chip_.tim5.zero() / kTicksPerMicrosecond)
                          : -1;
  out.edge_to_output_us =
      static_cast<std::uint32_t>(std::exchange(latency_, 0) / kTicksPerMicrosecond);
}

std::vector<std::string> PixracerProModel::complaints() const {
  std::vector<std::string> all;
  for (const parts::models::Part* const part :
       {static_cast<const parts::models::Part*>(&imu_.accel),
        static_cast<const parts::models::Part*>(&imu_.gyro),
        static_cast<const parts::models::Part*>(&baro_),
        static_cast<const parts::models::Part*>(&fram_),
        static_cast<const parts::models::Part*>(&mag_),
        static_cast<const parts::models::Part*>(&pitot_),
        static_cast<const parts::models::Part*>(&gnss_)}) {
    all.insert(all.end(), part->complaints().begin(), part->complaints().end());
  }
  return all;
}

}  // namespace rosflight::boards::stm32h7::emulator
