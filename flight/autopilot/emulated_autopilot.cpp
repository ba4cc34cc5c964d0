// SPDX-License-Identifier: BSD-3-Clause
#include "flight/autopilot/emulated_autopilot.hpp"

#include <algorithm>
#include <utility>

#include "flight/project_root.hpp"

namespace rosflight::flight {
namespace {

using boards::m7::Bell;
using boards::m7::EmulatorError;
using boards::m7::FromProcessor;
using boards::m7::Order;
using boards::m7::ToProcessor;
using boards::m7::Trouble;

/// Instructions with the emulator's `-icount shift=0`: 1 ns each, the board's counter runs at 25 MHz.
constexpr std::uint64_t kInstructionsPerTick = 40;

}  // namespace

std::filesystem::path emulated_image(const std::string& link_protocol) {
  const std::string name =
      link_protocol == "mavlink" ? "firmware_qemu_m7" : "firmware_qemu_m7_" + link_protocol;
  return project_root() / "build/cortex-m7/firmware/boards/qemu_m7" / (name + ".elf");
}

FirmwareView view_of(const boards::FirmwareGlance& glance) {
  FirmwareView view;
  view.state = static_cast<core::State>(glance.state);
  view.armed = glance.armed != 0;
  view.failsafe = glance.failsafe != 0;
  view.errors = glance.errors;
  view.primary_axes = glance.primary_axes;
  view.command = glance.command;
  std::transform(glance.command_type.begin(), glance.command_type.end(), view.command_type.begin(),
                 [](std::uint8_t type) { return static_cast<core::CommandType>(type); });
  if (glance.q_WB != decltype(glance.q_WB){})
    view.q_WB = {glance.q_WB[0], glance.q_WB[1], glance.q_WB[2], glance.q_WB[3]};
  view.roll_rad = glance.roll_rad;
  view.pitch_rad = glance.pitch_rad;
  return view;
}

Trouble trouble_of(Autopilot::Breakdown kind) {
  return kind == Autopilot::Breakdown::kHang ? Trouble::kHang : Trouble::kBusFault;
}

EmulatedAutopilot::EmulatedAutopilot(CableLink& link, const Emulator::Options& options)
    : link_{link}, emulator_{options} {}

void EmulatedAutopilot::start(sim::Time t) {
  emulator_.power_on();
  if (emulator_.wait_for_answer() != Bell::kBooted) {
    throw EmulatorError("emulated board: answered before it had started");
  }
  boot(t);
}

/// The board waits at its bell; its firmware starts with its clock at zero.
void EmulatedAutopilot::boot(sim::Time t) {
  boot_ = t;
  ToProcessor& block = emulator_.to_processor();
  block.order = Order::kStart;
  block.trouble = Trouble::kNone;
  block.time_us = 0;
  fill_samples(block, {}, nullptr, {});
  fill_link(t);
  block.link_count = 0;
  emulator_.ring();
  if (emulator_.wait_for_answer() != Bell::kDone) {
    throw EmulatorError("emulated board: the firmware does not start, it resets at once");
  }
  take_answer();
}

void EmulatedAutopilot::break_down(sim::Time t, Breakdown kind) {
  if (kind == Breakdown::kPowerLoss) {
    start(t);
  } else {
    trouble_ = trouble_of(kind);
  }
}

/// Room in the cable's queues and what waits in it, as the firmware would find them in this step.
void EmulatedAutopilot::fill_link(sim::Time t) {
  ToProcessor& block = emulator_.to_processor();
  sim::SerialLine& line = link_.cable().to_companion;
  line.advance(t);
  block.room = {static_cast<std::uint32_t>(line.writable(0)),
                static_cast<std::uint32_t>(line.writable(2)),
                static_cast<std::uint32_t>(line.writable(255))};
}

const hal::OutputValues& EmulatedAutopilot::step(sim::Time t, const sim::SensorSamples& samples,
                                                 const hal::RcFrame* rc) {
  ToProcessor& block = emulator_.to_processor();
  block.order = Order::kStep;
  block.trouble = std::exchange(trouble_, Trouble::kNone);
  block.time_us = (t - boot_).count();
  fill_samples(block, samples, rc, boot_);
  fill_link(t);
  block.link_count =
      static_cast<std::uint32_t>(link_.port().read(block.link.data(), block.link.size()));
  emulator_.ring();
  if (emulator_.wait_for_answer() == Bell::kBooted) {
    // It crashed in the middle of the step, or its watchdog bit. Its pins are still.
    ++figures_.resets;
    outputs_.fill(0.0F);
    boot(t);
    return outputs_;
  }
  const bool resets = emulator_.from_processor().reset_requested != 0;
  take_answer();
  if (resets) {
    if (emulator_.wait_for_answer() != Bell::kBooted) {
      throw EmulatorError("emulated board: did not reset when its firmware asked for it");
    }
    ++figures_.resets;
    boot(t);
  }
  return outputs_;
}

void EmulatedAutopilot::take_answer() {
  const FromProcessor& answer = emulator_.from_processor();
  const std::size_t count = std::min<std::size_t>(answer.link_count, answer.link.size());
  for (std::size_t at = 0; at + FromProcessor::kFrameHeader <= count;) {
    const std::uint8_t* const frame = answer.link.data() + at;
    const std::size_t size = static_cast<std::size_t>(frame[0]) | static_cast<std::size_t>(frame[1])
                                                                      << 8U;
    if (at + FromProcessor::kFrameHeader + size > count) break;
    const bool taken = link_.port().write(frame + FromProcessor::kFrameHeader, size, frame[2]);
    if (taken != (frame[3] != 0)) {
      throw EmulatorError("emulated board: cable and board disagree on the room for a frame");
    }
    at += FromProcessor::kFrameHeader + size;
  }
  outputs_ = answer.outputs;
  figures_.stack_bytes = std::max(figures_.stack_bytes, answer.stack_bytes);
  figures_.instructions += answer.ticks * kInstructionsPerTick;
  figures_.passes += answer.passes;
}

FirmwareView EmulatedAutopilot::view() const {
  return view_of(emulator_.from_processor().firmware);
}

}  // namespace rosflight::flight
