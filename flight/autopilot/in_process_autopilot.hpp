// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
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
  /// The board's end of the link, made again at each boot.
  using MakeCodec = std::function<std::shared_ptr<link::Codec>()>;

  /// @param link  must outlive this.
  /// @param protocol  "mavlink" or "lean". @throws config::Error in start() for another one.
  explicit InProcessAutopilot(CableLink& link, std::string protocol = "mavlink");
  /// @param make_codec  of one of the protocols, or quiet (quiet_codec.hpp).
  InProcessAutopilot(CableLink& link, MakeCodec make_codec);

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

  /// Board and firmware as they are now, to go on from here again, but for the state of the codec.
  struct Moment {
    boards::SimulatedBoard board;
    HostedFirmware::Moment firmware;
    sim::Time boot;
    std::optional<sim::Time> reversed;
  };
  Moment save() const;
  /// @param moment  of this object.
  void restore(const Moment& moment);
  /// The same, with its clock as it was then, in a world whose time has gone on from `saved` to `now`.
  void restore(const Moment& moment, sim::Time saved, sim::Time now);
  /// The firmware receives a message that crosses no link.
  void tell(const link::Message& message, sim::Time now) {
    (*firmware_).handle(message, now - boot_);
  }

  const hal::OutputValues& outputs() const { return board_.outputs.values(); }
  const core::Firmware& firmware() const { return *firmware_; }
  boards::SimulatedBoard& board() { return board_; }

 private:
  void boot(sim::Time t);

  CableLink& link_;
  MakeCodec make_codec_;
  boards::SimulatedBoard board_;
  HostedFirmware firmware_;
  sim::Time boot_{};
  std::optional<sim::Time> reversed_;  ///< Stamps go back since then.
};

}  // namespace rosflight::flight
