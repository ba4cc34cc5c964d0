// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

#include "firmware/boards/linux/linux_board.hpp"
#include "flight/autopilot/hosted_firmware.hpp"
#include "link/codec.hpp"
#include "sim/modules.hpp"

namespace rosflight::flight {

/// The firmware on the Linux board, in a simulation that keeps pace with the steady clock. Passes of
/// the main loop come from two sides: step() when a simulation step brings samples, link_pass() as
/// soon as bytes are there.
///
/// A reboot that the firmware asks for happens at the end of the pass: a new firmware object reads
/// its parameters from storage, and board time starts at zero.
class LinuxAutopilot final : public sim::AutopilotModule {
 public:
  /// The link of each boot, given the port it will write to.
  using MakeCodec = std::function<std::shared_ptr<link::Codec>(hal::Serial& port)>;
  static std::shared_ptr<link::Codec> mavlink(hal::Serial& port);

  /// Powers up. `board` must outlive this.
  explicit LinuxAutopilot(boards::LinuxBoard& board, MakeCodec make_codec = mavlink);

  /// The moment of the steady clock that the next step() stands for; not later than now.
  void set_tick(hal::Time steady) { tick_ = steady; }
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void link_pass() { pass(); }

  const core::Firmware& firmware() const { return *firmware_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  void boot();
  void pass();

  boards::LinuxBoard& board_;
  MakeCodec make_codec_;
  HostedFirmware firmware_;
  hal::Time tick_;
  std::uint64_t restarts_{0};
};

}  // namespace rosflight::flight
