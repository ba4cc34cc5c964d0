// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/bmi088_model.hpp"
#include "firmware/boards/stm32h7/emulator/emulated_board.hpp"
#include "firmware/boards/stm32h7/emulator/part_on_spi.hpp"

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
  void connect_imu();
  void connect_serial();
  void data_ready(bool high);
  void note_output_latency();

  Chip chip_{kCrystal_Hz};
  parts::models::ImuTruth imu_truth_;
  parts::models::Bmi088Model imu_{[this](hal::Time) { return imu_truth_; }};
  PartOnSpi accel_{chip_.processor, imu_.accel, false};
  PartOnSpi gyro_{chip_.processor, imu_.gyro, true};
  std::array<Output, 8> outputs_;
  std::vector<std::uint8_t> sent_;
  Ticks edge_{0};              ///< Of the newest data-ready edge.
  Ticks latency_{0};           ///< Longest from an edge to the write that followed.
  bool imu_is_silent_{false};  ///< Injected: no data-ready edge reaches the chip.
};

}  // namespace rosflight::boards::stm32h7::emulator
