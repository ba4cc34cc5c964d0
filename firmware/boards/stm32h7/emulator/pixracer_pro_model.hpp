// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/bmi088_model.hpp"
#include "firmware/boards/parts/models/fram_model.hpp"
#include "firmware/boards/parts/models/ist8308_model.hpp"
#include "firmware/boards/parts/models/pitot_models.hpp"
#include "firmware/boards/stm32h7/emulator/common_hardware.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Pixracer Pro: what of the board is modelled so far is listed in firmware/boards/pixracer_pro.
class PixracerProModel final : public CommonHardware {
 public:
  PixracerProModel();
  void report(FromChip& out) override;

 private:
  std::vector<const parts::models::Part*> parts() const override {
    return {&imu_.accel, &imu_.gyro, &baro_, &fram_, &mag_, &pitot_};
  }
  void advance_parts() override;
  double imu_delay_us() const override { return imu_.gyro.delay_us(); }
  void set_broken(const Broken& broken) override;
  Breakable breakable(FaultyPart which) override;
  void connect_imu();
  void connect_baro();
  void connect_external();

  parts::models::Bmi088Model imu_{[this](hal::Time when) { return imu_truth(when); }};
  PartOnSpi accel_{chip_.processor, imu_.accel, false};
  PartOnSpi gyro_{chip_.processor, imu_.gyro, true};
  parts::models::Dps310Model baro_{[this](hal::Time) { return baro_truth_; }, false};
  PartOnSpi baro_on_bus_{chip_.processor, baro_, false};
  parts::models::FramModel fram_;
  PartOnSpi fram_on_bus_{chip_.processor, fram_, false};
  /// Its z points up.
  parts::models::Ist8308Model mag_{[this](hal::Time) {
    parts::models::MagTruth truth = mag_truth_;
    truth.field_T[2] = -truth.field_T[2];
    return truth;
  }};
  parts::models::Ms4525doModel pitot_{[this](hal::Time) { return pitot_truth_; }};
};

}  // namespace rosflight::boards::stm32h7::emulator
