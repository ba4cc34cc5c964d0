// SPDX-License-Identifier: BSD-3-Clause
#include "apps/sil/sil_board.hpp"

#include <algorithm>

#include "apps/link_protocol.hpp"

namespace rosflight::apps {

SilBoard::SilBoard(boards::LinuxBoard& board, MakeCodec make_codec)
    : board_{board}, make_codec_{std::move(make_codec)}, tick_{boards::LinuxClock::steady()} {
  boot();
}

std::shared_ptr<link::Codec> SilBoard::mavlink(hal::Serial& /*port*/) {
  return make_board_codec("mavlink");
}

void SilBoard::boot() {
  board_.outputs.disable();
  board_.serial.clear();
  board_.system.restarted();
  board_.clock.boot();
  autopilot_.reset();
  autopilot_ = std::make_unique<Autopilot>(board_.roles(), make_codec_(board_.serial));
  autopilot_->firmware.start();
}

void SilBoard::pass() {
  board_.serial.receive();
  autopilot_->firmware.run();
  board_.serial.transmit();
  if (!board_.system.reset_requested()) return;
  ++restarts_;
  boot();
}

const hal::OutputValues& SilBoard::step(sim::Time t, const sim::SensorSamples& samples,
                                        const hal::RcFrame* rc) {
  // Stamps keep the distances of simulated time; what was measured before the start is of time 0.
  const auto to_board_time = [this, t](auto sample) {
    sample.stamp = std::max(board_.clock.at(tick_ + (sample.stamp - t)), hal::Time{0});
    return sample;
  };
  if (rc != nullptr) board_.receiver.put(to_board_time(*rc));
  if (samples.has_imu) board_.imu.put(to_board_time(samples.imu));
  if (samples.has_mag) board_.mag.put(to_board_time(samples.mag));
  if (samples.has_baro) board_.baro.put(to_board_time(samples.baro));
  if (samples.has_diff_pressure) board_.diff_pressure.put(to_board_time(samples.diff_pressure));
  if (samples.has_range) board_.range.put(to_board_time(samples.range));
  if (samples.has_gnss) board_.gnss.put(to_board_time(samples.gnss));
  if (samples.has_battery) board_.battery.put(to_board_time(samples.battery));
  pass();
  if (boards::aids_waiting(board_)) pass();
  return board_.outputs.values();
}

}  // namespace rosflight::apps
