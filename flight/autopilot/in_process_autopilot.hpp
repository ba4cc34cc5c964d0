// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "flight/autopilot/autopilot.hpp"
#include "flight/autopilot/cable_link.hpp"
#include "flight/autopilot/hosted_firmware.hpp"

namespace rosflight::flight {

/// The firmware in this process, on the simulated board.
///
/// A main loop on hardware runs many times between two IMU samples. Here one pass runs with the
/// receiver frame and the link's bytes, if any arrived, and one with the sensors' samples; idle
/// passes are left out. A reboot that the firmware requests happens at the end of the step: its
/// clock starts at zero, storage and backup memory stay.
class InProcessAutopilot : public Autopilot {
 public:
  /// @param link  must outlive this.
  /// @param protocol  "mavlink" or "lean". @throws config::Error in start() for another one.
  explicit InProcessAutopilot(CableLink& link, std::string protocol = "mavlink");

  void start(sim::Time t) override { boot(t); }
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  /// A process cannot hang and be reset: kCrash and kHang leave a record and reboot at once.
  void break_down(sim::Time t, Breakdown kind) override;
  bool set_impairment(sim::Time t, Impairment kind) override;
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override;
  companion::Transport& link() override { return link_.companion_end(); }
  void set_link_tap(LinkTap* tap) override { link_.set_tap(tap); }

  const core::Firmware& firmware() const { return *firmware_; }
  boards::SimulatedBoard& board() { return board_; }

 private:
  void boot(sim::Time t);

  CableLink& link_;
  std::string protocol_;
  boards::SimulatedBoard board_;
  HostedFirmware firmware_;
  sim::Time boot_{};
  std::optional<sim::Time> reversed_;  ///< Stamps go back since then.
};

}  // namespace rosflight::flight
