// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/linux_autopilot.hpp"

#include <algorithm>

#include "flight/link_protocol.hpp"

namespace rosflight::flight {

LinuxAutopilot::LinuxAutopilot(boards::LinuxBoard& board, MakeCodec make_codec)
    : board_{board}, make_codec_{std::move(make_codec)}, tick_{boards::LinuxClock::steady()} {
  boot();
}

std::shared_ptr<link::Codec> LinuxAutopilot::mavlink(hal::Serial& /*port*/) {
  return make_board_codec("mavlink");
}

void LinuxAutopilot::boot() {
  board_.outputs.disable();
  board_.serial.clear();
  board_.system.restarted();
  board_.clock.boot();
  firmware_.boot(board_.roles(), make_codec_(board_.serial));
}

void LinuxAutopilot::pass() {
  board_.serial.receive();
  (*firmware_).run();
  board_.serial.transmit();
  if (!board_.system.reset_requested()) return;
  ++restarts_;
  boot();
}

const hal::OutputValues& LinuxAutopilot::step(sim::Time t, const sim::SensorSamples& samples,
                                              const hal::RcFrame* rc) {
  // Stamps keep the distances of simulated time; what was measured before the start is of time 0.
  const auto to_board_time = [this, t](hal::Time stamp) {
    return std::max(board_.clock.at(tick_ + (stamp - t)), hal::Time{0});
  };
  if (rc != nullptr) {
    hal::RcFrame frame = *rc;
    frame.stamp = to_board_time(frame.stamp);
    board_.receiver.put(frame);
  }
  deliver(samples, board_, to_board_time);
  pass();
  if (boards::aids_waiting(board_)) pass();
  return board_.outputs.values();
}

}  // namespace rosflight::flight
