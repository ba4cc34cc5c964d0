// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/adis16500_model.hpp"
#include "firmware/boards/parts/models/fram_model.hpp"
#include "firmware/boards/parts/models/iis2mdc_model.hpp"
#include "firmware/boards/parts/models/pitot_models.hpp"
#include "firmware/boards/stm32h7/emulator/common_hardware.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Varmint, by its revision: what of the board is modelled so far is listed in firmware/boards/varmint.
class VarmintModel final : public CommonHardware {
 public:
  enum class Revision { k10X, k11X };
  explicit VarmintModel(Revision revision);

 private:
  std::vector<const parts::models::Part*> parts() const override {
    return {&imu_, &baro_, &mag_, &pitot_, &servo_supply_};
  }
  void advance_parts() override;
  double imu_delay_us() const override { return imu_.delay_us(); }
  void set_broken(const Broken& broken) override;
  Breakable breakable(FaultyPart which) override;
  void connect_imu();
  /// Barometer and magnetometer on SPI2.
  void connect_shared_bus();
  /// The magnetometer on SPI2, the barometer on SPI3.
  void connect_own_buses();
  void check_mag_bus(std::uint64_t clock_Hz);
  void connect_i2c(bool with_servo_supply);
  /// The part runs on the clock at its pin.
  void look_at_sync_clock();
  parts::models::ImuTruth turned_imu_truth(hal::Time when) const;
  parts::models::MagTruth mag_truth() const;

  parts::models::Adis16500Model imu_{[this](hal::Time when) { return turned_imu_truth(when); }};
  PartOnSpi imu_on_bus_{chip_.processor, imu_, true};
  parts::models::Dps310Model baro_{[this](hal::Time) { return baro_truth_; }, true};
  PartOnSpi baro_on_bus_{chip_.processor, baro_, false};
  parts::models::Iis2mdcModel mag_{[this](hal::Time) { return mag_truth(); }};
  PartOnSpi mag_on_bus_{chip_.processor, mag_, false};
  parts::models::DlhrModel pitot_{[this](hal::Time) { return pitot_truth_; }};
  parts::models::Mcp4017Model servo_supply_;
};

}  // namespace rosflight::boards::stm32h7::emulator
