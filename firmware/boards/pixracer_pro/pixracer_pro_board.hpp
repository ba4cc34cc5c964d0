// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/absent.hpp"
#include "firmware/boards/common/memories.hpp"
#include "firmware/boards/parts/bmi088.hpp"
#include "firmware/boards/parts/dps310.hpp"
#include "firmware/boards/parts/fram.hpp"
#include "firmware/boards/parts/ist8308.hpp"
#include "firmware/boards/parts/ms4525do.hpp"
#include "firmware/boards/parts/sbus.hpp"
#include "firmware/boards/parts/ublox.hpp"
#include "firmware/boards/pixracer_pro/pixracer_pro_pins.hpp"
#include "firmware/boards/stm32h7/backup_domain.hpp"
#include "firmware/boards/stm32h7/part_uart.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::pixracer_pro {

/// What the DMA touches; an object of section .dma.
struct DmaMemory {
  stm32h7::SpiBuffers imu;
  stm32h7::SpiBuffers baro;
  alignas(32) std::array<std::uint8_t, 4096> link_in;
  alignas(32) std::array<std::uint8_t, 512> link_out;
  alignas(32) std::array<std::uint8_t, 64> receiver_in;
  alignas(32) std::array<std::uint8_t, 512> gnss_in;
  alignas(32) std::array<std::uint8_t, 128> gnss_out;
};

class BoardLeds final : public hal::Leds {
 public:
  void set(hal::Led led, bool on) override {
    stm32h7::set_level(led == hal::Led::kOverride ? kRedLed : kBlueLed, !on);
  }
};

/// S.Bus alone so far.
class BoardReceiver final : public hal::Receiver {
 public:
  bool start(hal::ReceiverType type) override { return type == hal::ReceiverType::kSbus; }
  bool poll(hal::RcFrame& frame) override { return input.poll(frame); }
  parts::SbusInput input;
};

/// The processor and the sensors as a whole.
class BoardSystem final : public hal::System {
 public:
  /// Longest wait for the sensors at the start; those that need longer follow while it flies.
  static constexpr hal::Time kSensorWait = hal::milliseconds(200);
  /// A longer pass of the main loop counts as hanging; the chip resets by itself after twice the time.
  static constexpr hal::Time kMaxPass = hal::milliseconds(50);

  /// The sensors in the order of the start-up report. The first kWaitedFor are waited for. The others
  /// need not be connected, so their errors count from their first sample on: the GNSS receiver, which
  /// also takes seconds to find, and the pitot sensor.
  static constexpr std::size_t kSensors = 5, kWaitedFor = 3;
  using Sensors = std::array<parts::Driver*, kSensors>;

  BoardSystem(const hal::Clock& clock, const Sensors& sensors, parts::Start how)
      : clock_{clock}, sensors_{sensors}, how_{how} {}

  /// Waits until the sensors run or have failed, for kSensorWait at most.
  void start_sensors() override;
  std::uint16_t sensor_errors() const override;
  const char* sensor_message(std::size_t index, bool& ok) const override;
  void reset(bool to_bootloader) override;
  void feed_watchdog() override {
    if (watched_) stm32h7::Watchdog::feed();
  }
  /// From now on a pass of the main loop may take kMaxPass.
  void start_watchdog();
  /// Time not slept.
  hal::Time busy_time() const override { return clock_.now() - slept_; }
  bool shares_processor() const override { return false; }

  void add_slept(hal::Time time) { slept_ += time; }
  /// Bus context, once per tick.
  void step(hal::Time now);

 private:
  const hal::Clock& clock_;
  Sensors sensors_;
  parts::Start how_;
  hal::Time slept_{};
  bool watched_{false};
};

/// Everything on the board, connected. The image forwards interrupts to the public functions below.
///
/// Interrupts: data-ready edge (its time is noted, nothing else), then the bus context: SPI, UARTs,
/// tick. The main loop sleeps between them.
class PixracerPro {
 public:
  /// Clocks and memory system run already.
  PixracerPro(DmaMemory& memory, parts::Start how);

  /// Opens buses and inputs, starts the tick and the interrupts.
  void open();
  hal::Board roles();
  /// Sleeps until there is something for the main loop.
  void idle();
  void start_watchdog() { system_.start_watchdog(); }

  void on_gyro_ready();
  void on_gyro_sample();
  void on_imu_bus();
  void on_link() { link_.on_interrupt(), wakes_ = true; }
  void on_link_sent() { link_.on_sent(); }
  void on_baro_bus();
  void on_external_bus() { external_hardware_.on_interrupt(), wakes_ = true; }
  void on_gnss() { gnss_uart_.on_interrupt(), wakes_ = true; }
  void on_gnss_sent() { gnss_uart_.on_sent(); }
  void on_pulse_per_second();
  void on_receiver() { receiver_uart_.on_interrupt(), wakes_ = true; }
  void on_tick();

 private:
  /// The tick wakes the main loop this often even if nothing else does.
  static constexpr unsigned kTicksPerWake = 10;

  stm32h7::MicrosecondClock clock_;
  stm32h7::SpiBus imu_hardware_;
  parts::SharedBus imu_bus_;
  parts::SharedPort accel_{imu_bus_, kAccel, true};
  parts::SharedPort gyro_{imu_bus_, kGyro, true};
  parts::Bmi088 imu_;
  stm32h7::SpiBus baro_hardware_;
  parts::SharedBus baro_bus_;
  parts::SharedPort baro_port_{baro_bus_, kBaro};
  parts::Dps310 baro_{baro_port_, false};
  parts::SharedPort fram_port_{baro_bus_, kFram};
  parts::Fram storage_{fram_port_, clock_};
  stm32h7::I2cBus external_hardware_{kExternalBus};
  parts::SharedBus external_bus_;
  parts::SharedPort mag_port_{external_bus_, parts::Ist8308::kAddress};
  parts::Ist8308 mag_{mag_port_, parts::Mounting{}};
  parts::SharedPort pitot_port_{external_bus_, parts::Ms4525do::kAddress};
  parts::Ms4525do pitot_{pitot_port_};
  stm32h7::PartUart gnss_uart_;
  parts::Ublox gnss_{gnss_uart_, parts::Ublox::Config{}};
  BoardSystem system_;
  stm32h7::LinkUart link_;
  BoardReceiver receiver_;
  stm32h7::UartListener receiver_uart_;
  stm32h7::Pulses outputs_;
  BackupRam backup_;
  BoardLeds leds_;
  AbsentBattery battery_;
  Absent<hal::RangeSample> range_;
  volatile std::uint32_t edge_us_{0};
  unsigned ticks_{0};
  volatile bool wakes_{false};
};

}  // namespace rosflight::boards::pixracer_pro
