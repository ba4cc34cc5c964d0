// SPDX-License-Identifier: BSD-3-Clause
#include "flight/autopilot/chip_autopilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "flight/autopilot/emulated_autopilot.hpp"
#include "flight/flight.hpp"
#include "flight/project_root.hpp"

namespace rosflight::flight {
namespace {

using boards::stm32h7::ChipOrder;
using boards::stm32h7::FromChip;
using boards::stm32h7::HardwareFault;
using boards::stm32h7::ToChip;

}  // namespace

boards::stm32h7::ChipProcess::Options emulated_chip(const std::string& board) {
  boards::stm32h7::ChipProcess::Options options;
  options.board = board;
  options.program = project_root() / "build/release/firmware/boards/stm32h7/emulator/h7_emulator";
  options.image =
      project_root() / "build/cortex-m7/firmware/boards" / board / ("firmware_" + board + ".elf");
  return options;
}

// ---- transport

std::size_t ChipTransport::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, from_chip_.size());
  std::copy_n(from_chip_.begin(), count, data);
  from_chip_.erase(from_chip_.begin(), from_chip_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

bool ChipTransport::write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) {
  const bool taken = to_chip_.size() + size <= kCapacity;
  if (taken && !cut()) to_chip_.insert(to_chip_.end(), data, data + size);
  if (LinkTap* const tap = link_.tap())
    tap->on_frame(Direction::kToAutopilot, link_.time(), data, size, taken);
  return taken;
}

std::size_t ChipTransport::take(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, to_chip_.size());
  std::copy_n(to_chip_.begin(), count, data);
  to_chip_.erase(to_chip_.begin(), to_chip_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

void ChipTransport::put(const std::uint8_t* data, std::size_t size) {
  if (link_.tap() != nullptr) show(data, size);
  if (!cut()) from_chip_.insert(from_chip_.end(), data, data + size);
}

void ChipTransport::show(const std::uint8_t* data, std::size_t size) {
  for (std::size_t at = 0; at < size;) {
    const link::Codec::Decoded decoded = cutter_.decode(data + at, size - at);
    frame_.insert(frame_.end(), data + at, data + at + decoded.consumed);
    at += decoded.consumed;
    if (!decoded.complete) continue;
    link_.tap()->on_frame(Direction::kToCompanion, link_.time(), frame_.data(), frame_.size(),
                          true);
    frame_.clear();
  }
}

// ---- autopilot

ChipAutopilot::ChipAutopilot(CableLink& link, const Process::Options& options, ChipCables cables)
    : link_{link}, cables_{cables}, process_{options}, transport_{link} {}

unsigned ChipAutopilot::substeps() const {
  return static_cast<unsigned>(Flight::kStep / kChipStep);
}

void ChipAutopilot::start(sim::Time t) {
  process_.start();
  ToChip& order = process_.to_chip();
  order.order = ChipOrder::kPowerOn;
  order.until_us = t.count();
  exchange(t);
}

void ChipAutopilot::break_down(sim::Time t, Breakdown kind) {
  if (kind == Breakdown::kPowerLoss) {
    ToChip& order = process_.to_chip();
    order.order = ChipOrder::kPowerOn;
    order.until_us = t.count();
    order_fault();
    exchange(t);
    return;
  }
  fault_ = kind == Breakdown::kCrash ? HardwareFault::kBusError : HardwareFault::kStuckInterrupt;
}

void ChipAutopilot::order_fault() {
  ToChip& order = process_.to_chip();
  order.fault = std::exchange(fault_, HardwareFault::kNone);
  order.faulty_part = faulty_part_;
  order.torn_word = torn_word_;
}

const hal::OutputValues& ChipAutopilot::step(sim::Time t, const sim::SensorSamples& samples,
                                             const hal::RcFrame* rc) {
  ToChip& order = process_.to_chip();
  order.order = ChipOrder::kStep;
  order_fault();
  order.until_us = t.count();
  fill_samples(order, samples, rc, sim::Time{0});
  const bool whole_step = t % Flight::kStep == sim::Time{0};
  if (whole_step && link_.tap() != nullptr) link_.tap()->on_inputs(t, samples, rc);
  order.link_baud = link_baud_;
  order.receiver_is_crsf = static_cast<std::uint8_t>(cables_.crsf);
  order.usb_plugged = static_cast<std::uint8_t>(cables_.usb && !link_.cable().to_board.cut());
  std::copy(sent_.begin(), sent_.end(), order.link.begin());
  order.link_count = static_cast<std::uint32_t>(sent_.size());
  sent_.resize(ToChip::kLinkCapacity);
  sent_.resize(transport_.take(sent_.data(), sent_.size()));
  exchange(t);
  return outputs_;
}

void ChipAutopilot::exchange(sim::Time t) {
  process_.to_chip().time_us = t.count();
  process_.exchange();
  ToChip& order = process_.to_chip();
  order.has_rc = order.has_imu = 0;
  order.link_count = 0;
  const FromChip& answer = process_.from_chip();
  transport_.put(answer.link.data(), answer.link_count);
  outputs_ = answer.outputs;
  if (answer.clock_zero_us >= 0) boot_ = sim::Time{answer.clock_zero_us};
  figures_.resets = answer.resets;
  figures_.instructions = answer.instructions;
  figures_.stack_bytes = std::max(figures_.stack_bytes, answer.stack_bytes);
  figures_.uart_received = answer.link_received;
  figures_.uart_sent = answer.link_sent;
  figures_.uart_lost = answer.link_lost;
  if (view().armed) note_timing(answer);
  note_load(answer);
}

void ChipAutopilot::note_timing(const FromChip& answer) {
  if (answer.edge_to_output_us > 0) {
    figures_.imu_to_output_us = std::max(figures_.imu_to_output_us, answer.edge_to_output_us);
    const double more = answer.edge_to_output_us - figures_.imu_to_output_mean_us;
    figures_.imu_to_output_mean_us += more / static_cast<double>(++timed_);
  }
  figures_.transfer_to_output_us =
      std::max(figures_.transfer_to_output_us, answer.transfer_to_output_us);
  if (answer.resets > 0) return;
  figures_.stamp_error_us = std::max(figures_.stamp_error_us, std::abs(answer.stamp_error_us));
}

/// A step in which the vehicle is armed at both ends counts as armed.
void ChipAutopilot::note_load(const FromChip& answer) {
  const bool armed = view().armed;
  if (armed && was_armed_) {
    const auto passed_us = static_cast<double>(answer.time_us - counted_.time_us);
    figures_.armed_us += passed_us;
    figures_.slept_us += passed_us - static_cast<double>(answer.busy_us - counted_.busy_us);
  }
  was_armed_ = armed;
  counted_ = {answer.time_us, answer.busy_us};
}

FirmwareView ChipAutopilot::view() const {
  return view_of(process_.from_chip().firmware);
}

}  // namespace rosflight::flight
