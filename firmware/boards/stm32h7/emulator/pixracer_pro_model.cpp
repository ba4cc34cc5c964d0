// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/pixracer_pro_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/boards/stm32h7/emulator/sbus_frame.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr PinName pin(char port, unsigned number) {
  return {static_cast<unsigned>(port - 'A'), number};
}
constexpr PinName kAccelSelect = pin('F', 6), kGyroSelect = pin('F', 10), kGyroReady = pin('F', 3);
constexpr PinName kImuClock = pin('F', 7), kImuIn = pin('F', 8), kImuOut = pin('F', 9);
constexpr PinName kSensorSupply = pin('E', 3), kLevelShifter = pin('I', 3);
constexpr PinName kRedLed = pin('B', 11), kGreenLed = pin('B', 1), kBlueLed = pin('B', 3);
constexpr unsigned kSpi5Function = 5, kUsartFunction = 7;
constexpr std::uint64_t kBmi088Max_Hz = 10'000'000;
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
  connect_imu();
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

void PixracerProModel::power_on() {
  for (parts::models::SpiPart* part : {static_cast<parts::models::SpiPart*>(&imu_.accel),
                                       static_cast<parts::models::SpiPart*>(&imu_.gyro)}) {
    part->advance(part_time(chip_.processor.now()));
    part->set_power(false);
    part->set_power(true);
  }
  accel_.advance();
  gyro_.advance();
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
  std::vector<std::string> all = imu_.accel.complaints();
  all.insert(all.end(), imu_.gyro.complaints().begin(), imu_.gyro.complaints().end());
  return all;
}

}  // namespace rosflight::boards::stm32h7::emulator
