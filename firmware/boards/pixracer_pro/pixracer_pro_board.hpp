// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/bmi088.hpp"
#include "firmware/boards/parts/buzzer.hpp"
#include "firmware/boards/parts/dps310.hpp"
#include "firmware/boards/parts/fram.hpp"
#include "firmware/boards/parts/ist8308.hpp"
#include "firmware/boards/parts/ms4525do.hpp"
#include "firmware/boards/pixracer_pro/pixracer_pro_pins.hpp"

namespace rosflight::boards::pixracer_pro {

class PixracerPro final : public stm32h7::FlightBoard {
 public:
  /// What the DMA touches; an object of section .dma.
  struct Memory : FlightBoard::Memory {
    stm32h7::SpiBuffers imu, baro;
  };

  /// Clocks and memory system run already.
  PixracerPro(Memory& memory, parts::Start how);

  /// All that the MPU must know of is known; the FRAM needs no care.
  static void map_memory(unsigned /*first*/) {}
  static void maintain(bool /*armed*/) {}
  static constexpr bool kHasBuzzer = true;
  /// Main loop, once per pass.
  void sound(const parts::Buzzer::Inputs& inputs, hal::Time now);
  /// Opens buses and inputs, starts the tick and the interrupts.
  void open();
  hal::Board roles() { return FlightBoard::roles(storage_, imu_, mag_, baro_, pitot_); }

  void on_imu_sample() { imu_.data_ready(edge_time()); }
  void on_imu_bus() {
    imu_hardware_.on_interrupt();
    wake_for(imu_.count() / kSamplesPerStep, imu_steps_);
  }
  void on_baro_bus() {
    baro_hardware_.on_interrupt();
    wake_for(baro_.count(), baro_samples_);
  }
  void on_external_bus() {
    external_hardware_.on_interrupt();
    wake_for(mag_.count() + pitot_.count(), external_samples_);
  }
  void on_tick();

 private:
  /// The main loop makes one step of so many samples of the gyro, and is woken for them together.
  static constexpr std::uint32_t kSamplesPerStep = 2;
  static constexpr float kSamplePeriod_s = 5e-4f;
  static_assert(kSamplesPerStep * kSamplePeriod_s >= hal::kShortestImuStep_s &&
                (kSamplesPerStep - 1) * kSamplePeriod_s < hal::kShortestImuStep_s);

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
  parts::Buzzer buzzer_;
  std::uint32_t imu_steps_{0}, baro_samples_{0}, external_samples_{0};
  std::uint32_t tone_us_{0};  ///< Period of the tone that sounds; 0: none.
};

}  // namespace rosflight::boards::pixracer_pro
