// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/bmi088_model.hpp"
#include "firmware/boards/parts/models/dps310_model.hpp"
#include "firmware/boards/parts/models/fram_model.hpp"
#include "firmware/boards/parts/models/ist8308_model.hpp"
#include "firmware/boards/parts/models/pitot_models.hpp"
#include "firmware/boards/parts/models/ublox_model.hpp"
#include "firmware/boards/stm32h7/emulator/emulated_board.hpp"
#include "firmware/boards/stm32h7/emulator/part_on_spi.hpp"
#include "firmware/boards/stm32h7/emulator/part_on_uart.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Pixracer Pro: what of the board is modelled so far is listed in firmware/boards/pixracer_pro.
///
/// The wiring here is written down independently of the firmware's pin table, so that each checks the
/// other: a pin given to a wrong function is complained of.
class PixracerProModel final : public EmulatedBoard {
 public:
  PixracerProModel();

  Chip& chip() override { return chip_; }
  void power_on() override;
  void expose(const ToChip& world) override;
  void inject(HardwareFault fault) override;
  void report(FromChip& out) override;
  std::vector<std::string> complaints() const override;

 private:
  static constexpr std::uint64_t kCrystal_Hz = 24'000'000;
  struct Output {
    TimerModel* timer;
    std::size_t channel;
    PinName pin;
    unsigned function;
  };
  std::vector<parts::models::Part*> all_parts();
  /// Whether a sensor that delivered before has been without samples of the world for too long: then
  /// it is broken, and mute on its bus. One that never delivered is not connected.
  class Presence {
   public:
    static constexpr std::int64_t kTimeout_us = 300'000;
    bool lost(bool sample, std::int64_t now_us) {
      if (sample) newest_us_ = now_us;
      return connected() && now_us - newest_us_ > kTimeout_us;
    }
    bool connected() const { return newest_us_ >= 0; }

   private:
    std::int64_t newest_us_{-1};
  };
  void connect_imu();
  void connect_baro();
  void connect_external();
  parts::models::GnssTruth gnss_truth(hal::Time when) const;
  void connect_serial();
  void data_ready(bool high);
  void note_output_latency();

  Chip chip_{kCrystal_Hz};
  parts::models::ImuTruth imu_truth_;
  parts::models::Bmi088Model imu_{[this](hal::Time) { return imu_truth_; }};
  PartOnSpi accel_{chip_.processor, imu_.accel, false};
  PartOnSpi gyro_{chip_.processor, imu_.gyro, true};
  parts::models::BaroTruth baro_truth_;
  parts::models::Dps310Model baro_{[this](hal::Time) { return baro_truth_; }, false};
  PartOnSpi baro_on_bus_{chip_.processor, baro_, false};
  parts::models::FramModel fram_;
  PartOnSpi fram_on_bus_{chip_.processor, fram_, false};
  parts::models::MagTruth mag_truth_;
  parts::models::Ist8308Model mag_{[this](hal::Time) { return mag_truth_; }};
  parts::models::DiffPressureTruth pitot_truth_;
  parts::models::Ms4525doModel pitot_{[this](hal::Time) { return pitot_truth_; }};
  hal::GnssSample gnss_sample_{};
  parts::models::UbloxModel gnss_{[this](hal::Time when) { return gnss_truth(when); }};
  PartOnUart gnss_on_wire_{chip_.processor, chip_.uart4, gnss_};
  std::array<Output, 8> outputs_;
  Presence baro_presence_, mag_presence_, gnss_presence_, pitot_presence_;
  std::vector<std::uint8_t> sent_;
  Ticks edge_{0};              ///< Of the newest data-ready edge.
  Ticks latency_{0};           ///< Longest from an edge to the write that followed.
  bool imu_is_silent_{false};  ///< Injected: no data-ready edge reaches the chip.
};

}  // namespace rosflight::boards::stm32h7::emulator
