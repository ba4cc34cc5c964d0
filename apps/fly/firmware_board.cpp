// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/firmware_board.hpp"

#include "apps/link_protocol.hpp"

namespace rosflight::apps {

FirmwareBoard::FirmwareBoard(BoardSerial& serial, std::string protocol)
    : serial_{serial}, protocol_{std::move(protocol)} {}

void FirmwareBoard::start(sim::Time t) {
  boot(t);
}

void FirmwareBoard::boot(sim::Time t) {
  boot_ = t;
  board_.clock.set(hal::Time{0});
  image_.reset();
  image_ = std::make_unique<Image>(board_.roles(serial_), make_board_codec(protocol_));
  image_->firmware.start();
}

void FirmwareBoard::restart(sim::Time t, bool in_flight_fault) {
  if (in_flight_fault) {
    image_->firmware.record_fault({0, 0, 0, 0, 0, 0, 0x0800'1234u, 0});
  } else {
    board_.backup.clear();
  }
  board_.outputs.disable();
  boot(t);
}

const hal::OutputValues& FirmwareBoard::step(sim::Time t, const sim::SensorSamples& samples,
                                             const hal::RcFrame* rc) {
  board_.clock.set(board_time(t));
  if (rc != nullptr) board_.receiver.put(*rc);
  if (rc != nullptr || serial_.waiting()) image_->firmware.run();
  const auto to_board_time = [this](auto sample) {
    sample.stamp = board_time(sample.stamp);
    return sample;
  };
  if (samples.has_imu) board_.imu.put(to_board_time(samples.imu));
  if (samples.has_mag) board_.mag.put(to_board_time(samples.mag));
  if (samples.has_baro) board_.baro.put(to_board_time(samples.baro));
  if (samples.has_diff_pressure) board_.diff_pressure.put(to_board_time(samples.diff_pressure));
  if (samples.has_range) board_.range.put(to_board_time(samples.range));
  if (samples.has_gnss) board_.gnss.put(to_board_time(samples.gnss));
  if (samples.has_battery) board_.battery.put(to_board_time(samples.battery));
  image_->firmware.run();
  if (boards::aids_waiting(board_)) image_->firmware.run();
  if (board_.system.reset_requested()) {
    board_.system.acknowledge_reset();
    boot(t);
  }
  return board_.outputs.values();
}

FirmwareView FirmwareBoard::view() const {
  const core::Firmware& f = image_->firmware;
  const core::AttitudeEstimate& estimate = f.estimator().estimate();
  return {f.state().state(),
          f.state().armed(),
          f.state().failsafe(),
          f.state().errors(),
          f.command().primary_entries(),
          f.command().combined().value,
          f.command().combined().type,
          estimate.q_NB,
          estimate.roll_rad,
          estimate.pitch_rad};
}

}  // namespace rosflight::apps
