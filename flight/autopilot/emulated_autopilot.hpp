// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "firmware/boards/qemu_m7/host/emulator.hpp"
#include "flight/autopilot/autopilot.hpp"
#include "flight/autopilot/cable_link.hpp"

namespace rosflight::flight {

/// The image of the emulated Cortex-M7 in the build tree.
std::filesystem::path emulated_image(const std::string& link_protocol = "mavlink");

/// The firmware's image on an emulated Cortex-M7, in lock-step.
///
/// One exchange of the block per step. The image makes the same passes as InProcessAutopilot, with
/// the same samples, bytes and clock. The frames it sends are pushed into the cable when it
/// answers, in their order, at the time of the step. So both fly the same flight as far as they
/// compute the same. Every function may throw boards::m7::EmulatorError.
class EmulatedAutopilot final : public Autopilot {
 public:
  using Emulator = boards::m7::Emulator;

  /// @param link  must outlive this. @throws boards::m7::EmulatorError  no image or no emulator.
  EmulatedAutopilot(CableLink& link, const Emulator::Options& options);

  void start(sim::Time t) override;
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void break_down(sim::Time t, Breakdown kind) override;
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override;
  companion::Transport& link() override { return link_.companion_end(); }
  void set_link_tap(LinkTap* tap) override { link_.set_tap(tap); }
  std::optional<ProcessorFigures> figures() const override { return figures_; }

  Emulator& emulator() { return emulator_; }

 private:
  void boot(sim::Time t);
  void fill_link(sim::Time t);
  void take_answer();

  CableLink& link_;
  Emulator emulator_;
  boards::m7::Trouble trouble_{boards::m7::Trouble::kNone};  ///< Trouble of the next step.
  hal::OutputValues outputs_{};
  ProcessorFigures figures_;
  sim::Time boot_{};
};

/// Copies samples into the block of an emulated board, their stamps less `origin`.
template <class Block>
void fill_samples(Block& block, const sim::SensorSamples& samples, const hal::RcFrame* rc,
                  sim::Time origin) {
  const auto put = [origin](auto& to, std::uint8_t& has, bool is_new, const auto& sample) {
    has = is_new ? 1 : 0;
    if (!is_new) return;
    to = sample;
    to.stamp -= origin;
  };
  block.has_rc = rc != nullptr ? 1 : 0;
  if (rc != nullptr) block.rc = *rc;
  put(block.imu, block.has_imu, samples.has_imu, samples.imu);
  put(block.mag, block.has_mag, samples.has_mag, samples.mag);
  put(block.baro, block.has_baro, samples.has_baro, samples.baro);
  put(block.diff_pressure, block.has_diff_pressure, samples.has_diff_pressure,
      samples.diff_pressure);
  put(block.range, block.has_range, samples.has_range, samples.range);
  put(block.gnss, block.has_gnss, samples.has_gnss, samples.gnss);
  put(block.battery, block.has_battery, samples.has_battery, samples.battery);
}

FirmwareView view_of(const boards::FirmwareGlance& glance);
/// kCrash or kHang as the image's driver simulates it.
boards::m7::Trouble trouble_of(Autopilot::Breakdown kind);

}  // namespace rosflight::flight
