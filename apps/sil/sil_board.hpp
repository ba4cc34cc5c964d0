// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "firmware/boards/linux/linux_board.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "sim/modules.hpp"

namespace rosflight::apps {

/// The firmware on the Linux board, as the board module of a simulation that keeps pace with the
/// steady clock. Passes of the main loop come from two sides: step() when a simulation step brings
/// samples, link_pass() as soon as bytes are there.
///
/// A reboot that the firmware asks for happens at the end of the pass: a new firmware object reads
/// its parameters from storage, and board time starts at zero.
class SilBoard final : public sim::BoardModule {
 public:
  /// Powers up. `board` must outlive this.
  explicit SilBoard(boards::LinuxBoard& board);

  /// The moment of the steady clock that the next step() stands for; not later than now.
  void set_tick(hal::Time steady) { tick_ = steady; }
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void link_pass() { pass(); }
  bool armed() const override { return autopilot_->firmware.state().armed(); }

  const core::Firmware& firmware() const { return autopilot_->firmware; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Autopilot {
    explicit Autopilot(const hal::Board& board) : firmware{board, codec} {}
    link::MavlinkCodec codec{{1, link::MavlinkCodec::kFcuComponent}};
    core::Firmware firmware;
  };

  void boot();
  void pass();

  boards::LinuxBoard& board_;
  std::unique_ptr<Autopilot> autopilot_;  ///< Of the present boot.
  hal::Time tick_;
  std::uint64_t restarts_{0};
};

}  // namespace rosflight::apps
