// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/pixracer_pro/pixracer_pro_board.hpp"

#include <algorithm>
#include <iterator>

namespace rosflight::boards::pixracer_pro {
namespace {

using stm32h7::Priority;

/// Pended by the edge's interrupt: the same event in the bus context.
constexpr unsigned kSampleIrq = stm32h7::irq::SPI5;
constexpr std::uint32_t kTick_us = 1000;

parts::Bmi088::Config imu_config() {
  parts::Bmi088::Config config;
  config.gyro_rate = parts::Bmi088::GyroRate::k1000Hz116;
  return config;
}

}  // namespace

// ---- the processor and the sensors

/// After a warm start only the IMU is waited for: without it there is nothing to fly with.
void BoardSystem::start_sensors() {
  const std::uint32_t masked = stm32h7::mask_bus();
  for (parts::Driver* const sensor : sensors_) sensor->start(how_, clock_.now());
  stm32h7::unmask_bus(masked);
  const hal::Time end = clock_.now() + kSensorWait;
  const std::size_t waited = how_ == parts::Start::kWarm ? 1 : kWaitedFor;
  const auto starting = [this, waited] {
    return std::any_of(
        sensors_.begin(), sensors_.begin() + static_cast<std::ptrdiff_t>(waited),
        [](const auto* each) { return each->state() == parts::PartState::kStarting; });
  };
  while (starting() && clock_.now() < end) stm32h7::wait_for_interrupt();
}

void BoardSystem::step(hal::Time now) {
  for (parts::Driver* const sensor : sensors_) sensor->step(now);
}

std::uint16_t BoardSystem::sensor_errors() const {
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < kSensors; ++k) {
    if (k < kWaitedFor || sensors_[k]->was_well()) sum += sensors_[k]->errors();
  }
  return static_cast<std::uint16_t>(std::min<std::uint32_t>(sum, 0xFFFF));
}

/// Of those that are waited for. One that runs and has not delivered yet has no message of its own.
const char* BoardSystem::sensor_message(std::size_t index, bool& ok) const {
  constexpr std::array<const char*, kWaitedFor> kStarted{"BMI088: started", "DPS310: started",
                                                         "IST8308: started"};
  if (index >= kWaitedFor) return nullptr;
  ok = sensors_[index]->state() != parts::PartState::kFailed;
  const char* const message = sensors_[index]->message();
  return message[0] != 0 ? message : kStarted[index];
}

void BoardSystem::start_watchdog() {
  stm32h7::Watchdog::start(static_cast<std::uint32_t>(kMaxPass.count()),
                           static_cast<std::uint32_t>(2 * hal::to_ms(kMaxPass)));
  watched_ = true;
}

void BoardSystem::reset(bool /*to_bootloader*/) {
  stm32h7::reset_processor();
}

// ---- board

PixracerPro::PixracerPro(DmaMemory& memory, parts::Start how)
    : imu_hardware_{kImuBus, kImuDevices, std::size(kImuDevices), memory.imu},
      imu_bus_{imu_hardware_, clock_},
      imu_{accel_, gyro_, imu_config()},
      baro_hardware_{kBaroBus, kBaroBusDevices, std::size(kBaroBusDevices), memory.baro},
      baro_bus_{baro_hardware_, clock_},
      external_bus_{external_hardware_, clock_, stm32h7::I2cBus::kLimit},
      gnss_uart_{kGnss,
                 {memory.gnss_in.data(), memory.gnss_in.size(), memory.gnss_out.data(),
                  memory.gnss_out.size()},
                 clock_},
      system_{clock_, {&imu_, &baro_, &mag_, &gnss_, &pitot_}, how},
      link_{kLink,
            {memory.link_in.data(), memory.link_in.size(), memory.link_out.data(),
             memory.link_out.size()}},
      receiver_uart_{kReceiver,
                     {memory.receiver_in.data(), memory.receiver_in.size(), nullptr, 0},
                     clock_,
                     receiver_.input},
      outputs_{kOutputs, std::size(kOutputs)},
      backup_{&stm32h7::memory_at<std::uint8_t>(stm32h7::kBackupMemory)} {}

void PixracerPro::open() {
  stm32h7::make_output(kSensorSupply, true);
  stm32h7::make_output(kLevelShifter, true);
  for (const Pin& pin : kUnusedSelects) stm32h7::make_output(pin, true);
  for (const Pin& pin : {kRedLed, kGreenLed, kBlueLed}) {
    stm32h7::make_output(pin, true, stm32h7::Drive::kOpenDrain);
  }
  imu_hardware_.open(imu_bus_);
  baro_hardware_.open(baro_bus_);
  external_hardware_.open(external_bus_);
  gnss_uart_.connect(gnss_);
  static_cast<void>(gnss_uart_.set_format(parts::UartFormat{}));
  stm32h7::make_input(kPulsePerSecond, stm32h7::Pull::kDown);
  stm32h7::watch_rising_edge(kPulsePerSecond);
  stm32h7::enable_interrupt(stm32h7::irq::EXTI15_10, Priority::kBus);
  static_cast<void>(receiver_uart_.open(parts::SbusInput::kFormat));
  stm32h7::make_input(kGyroReady, stm32h7::Pull::kDown);
  stm32h7::watch_rising_edge(kGyroReady);
  stm32h7::enable_interrupt(stm32h7::irq::EXTI3, Priority::kEdge);
  stm32h7::enable_interrupt(kSampleIrq, Priority::kBus);
  stm32h7::start_tick(kTick_us);
  static_cast<void>(
      storage_.identify());  // without it the storage has no bytes, which the core reports
}

hal::Board PixracerPro::roles() {
  return {clock_,   system_, link_, storage_, backup_, leds_,  outputs_, receiver_,
          battery_, imu_,    mag_,  baro_,    pitot_,  range_, gnss_};
}

void PixracerPro::on_gyro_ready() {
  edge_us_ = stm32h7::microseconds();
  stm32h7::clear_edge(kGyroReady);
  stm32h7::pend_interrupt(kSampleIrq);
}

void PixracerPro::on_gyro_sample() {
  const hal::Time now = clock_.now();
  const auto ago = static_cast<std::uint32_t>(now.count()) - edge_us_;
  imu_.data_ready(now - hal::Time{ago});
}

void PixracerPro::on_imu_bus() {
  imu_hardware_.on_interrupt();
  if (imu_bus_.idle()) wakes_ = true;
}

void PixracerPro::on_baro_bus() {
  baro_hardware_.on_interrupt();
  if (baro_bus_.idle()) wakes_ = true;
}

void PixracerPro::on_pulse_per_second() {
  const hal::Time now = clock_.now();
  stm32h7::clear_edge(kPulsePerSecond);
  gnss_.pulse(now);
}

void PixracerPro::on_tick() {
  stm32h7::clear_tick();
  for (parts::SharedBus* const bus : {&imu_bus_, &baro_bus_, &external_bus_}) bus->step();
  gnss_uart_.step();
  system_.step(clock_.now());
  if (++ticks_ % kTicksPerWake == 0) wakes_ = true;
}

void PixracerPro::idle() {
  const hal::Time begin = clock_.now();
  for (;;) {
    asm volatile("cpsid i" ::: "memory");
    const bool awake = wakes_ || link_.waiting();
    if (!awake) stm32h7::wait_for_interrupt();
    asm volatile("cpsie i" ::: "memory");
    if (awake) break;
  }
  wakes_ = false;
  system_.add_slept(clock_.now() - begin);
}

}  // namespace rosflight::boards::pixracer_pro
