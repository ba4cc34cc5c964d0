// SPDX-License-Identifier: BSD-3-Clause
#include "flight/autopilot/in_process_autopilot.hpp"

#include <utility>

#include "flight/link_protocol.hpp"

namespace rosflight::flight {

InProcessAutopilot::InProcessAutopilot(CableLink& link, std::string protocol)
    : InProcessAutopilot(link, [name = std::move(protocol)] { return make_board_codec(name); }) {}

InProcessAutopilot::InProcessAutopilot(CableLink& link, MakeCodec make_codec)
    : link_{link}, make_codec_{std::move(make_codec)} {}

void InProcessAutopilot::boot(sim::Time t) {
  boot_ = t;
  board_.clock.set(hal::Time{0});
  firmware_.boot(board_.roles(link_.port()), make_codec_());
}

void InProcessAutopilot::break_down(sim::Time t, Breakdown kind) {
  if (kind == Breakdown::kPowerLoss) {
    board_.backup.clear();
  } else {
    constexpr std::uint32_t kProgramCounter = 0x0800'1234U;  // any address in flash
    (*firmware_).record_fault({0, 0, 0, 0, 0, 0, kProgramCounter, 0});
  }
  board_.outputs.disable();
  boot(t);
}

bool InProcessAutopilot::set_impairment(sim::Time t, Impairment kind) {
  constexpr hal::Time kSlow = hal::milliseconds(3);
  board_.system.set_work(kind == Impairment::kSlowPasses ? kSlow : hal::Time{0});
  reversed_.reset();
  if (kind == Impairment::kReversedImuClock) reversed_ = t;
  return true;
}

const hal::OutputValues& InProcessAutopilot::step(sim::Time t, const sim::SensorSamples& samples,
                                                  const hal::RcFrame* rc) {
  core::Firmware& firmware = *firmware_;
  board_.clock.set(t - boot_);
  if (link_.tap() != nullptr) link_.tap()->on_inputs(t, samples, rc);
  if (rc != nullptr) board_.receiver.put(*rc);
  if (rc != nullptr || link_.waiting()) firmware.run();
  deliver(samples, board_, [this](hal::Time stamp) {
    return (reversed_ ? *reversed_ - (stamp - *reversed_) : stamp) - boot_;
  });
  firmware.run();
  if (boards::aids_waiting(board_)) firmware.run();
  if (board_.system.reset_requested()) {
    board_.system.acknowledge_reset();
    boot(t);
  }
  return board_.outputs.values();
}

FirmwareView InProcessAutopilot::view() const {
  const core::Firmware& f = *firmware_;
  const core::AttitudeEstimate& estimate = f.estimator().estimate();
  return {f.state().state(),           f.state().armed(),
          f.state().failsafe(),        f.state().errors(),
          f.command().primary_axes(),  f.command().combined().value,
          f.command().combined().type, estimate.q_WB,
          estimate.roll_rad,           estimate.pitch_rad};
}

InProcessAutopilot::Moment InProcessAutopilot::save() const {
  return {board_, firmware_.save(), boot_, reversed_};
}

void InProcessAutopilot::restore(const Moment& moment) {
  board_ = moment.board;
  firmware_.restore(moment.firmware);
  boot_ = moment.boot;
  reversed_ = moment.reversed;
}

void InProcessAutopilot::restore(const Moment& moment, sim::Time saved, sim::Time now) {
  restore(moment);
  boot_ += now - saved;
}

}  // namespace rosflight::flight
