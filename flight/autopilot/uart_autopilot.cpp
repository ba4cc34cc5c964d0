// SPDX-License-Identifier: BSD-3-Clause
#include "flight/autopilot/uart_autopilot.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

namespace rosflight::flight {
namespace {

using boards::m7::EmulatorError;
using boards::m7::FromProcessor;
using boards::m7::ToProcessor;
using boards::m7::Trouble;

/// More than this many bytes behind, whole frames are dropped as by a full cable.
constexpr std::size_t kTransmitCapacity = 4096;
constexpr int kStepsPerCheck = 100;

std::uint32_t load(const std::uint32_t& counter) {
  return std::atomic_ref<const std::uint32_t>{counter}.load(std::memory_order_acquire);
}

}  // namespace

std::size_t UartTransport::read(std::uint8_t* data, std::size_t capacity) {
  const ssize_t count = ::recv(emulator_.uart(), data, capacity, MSG_DONTWAIT);
  if (count <= 0) return 0;
  show(data, static_cast<std::size_t>(count));
  return static_cast<std::size_t>(count);
}

bool UartTransport::write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) {
  send_rest();
  const bool taken = unsent_.size() + size <= kTransmitCapacity;
  if (taken) {
    unsent_.insert(unsent_.end(), data, data + size);
    send_rest();
  }
  if (tap_ != nullptr) tap_->on_frame(Direction::kToAutopilot, now_, data, size, taken);
  return taken;
}

void UartTransport::send_rest() {
  if (unsent_.empty()) return;
  const ssize_t count =
      ::send(emulator_.uart(), unsent_.data(), unsent_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count > 0) unsent_.erase(unsent_.begin(), unsent_.begin() + count);
}

void UartTransport::show(const std::uint8_t* data, std::size_t size) {
  if (tap_ == nullptr) return;
  for (std::size_t at = 0; at < size;) {
    const link::Codec::Decoded decoded = cutter_.decode(data + at, size - at);
    frame_.insert(frame_.end(), data + at, data + at + decoded.consumed);
    at += decoded.consumed;
    if (!decoded.complete) continue;
    tap_->on_frame(Direction::kToCompanion, now_, frame_.data(), frame_.size(), true);
    frame_.clear();
  }
}

UartAutopilot::UartAutopilot(const hal::Time& clock, const boards::m7::Emulator::Options& options)
    : emulator_{options}, transport_{emulator_, clock} {}

void UartAutopilot::start(sim::Time t) {
  emulator_.power_on();
  boot_ = t;
  // The world begins when the firmware has.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
  while (load(emulator_.from_processor().sequence) == 0) {
    emulator_.check();
    if (std::chrono::steady_clock::now() > end) {
      emulator_.power_off();
      throw EmulatorError("emulated board: its firmware does not start");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void UartAutopilot::break_down(sim::Time t, Breakdown kind) {
  if (kind == Breakdown::kPowerLoss) {
    start(t);
  } else {
    trouble_ = trouble_of(kind);
  }
}

const hal::OutputValues& UartAutopilot::step(sim::Time t, const sim::SensorSamples& samples,
                                             const hal::RcFrame* rc) {
  if (--until_check_ <= 0) {
    until_check_ = kStepsPerCheck;
    emulator_.check();
  }
  ToProcessor& block = emulator_.to_processor();
  std::atomic_ref<std::uint32_t> sequence{block.sequence};
  sequence.fetch_add(1);  // odd: being written
  block.trouble = std::exchange(trouble_, Trouble::kNone);
  block.time_us = t.count();
  fill_samples(block, samples, rc, sim::Time{0});
  sequence.fetch_add(1);
  take_answer();
  return answer_.outputs;
}

/// The newest answer that is whole; the one before if the board is writing all the time.
void UartAutopilot::take_answer() {
  constexpr int kTries = 100;
  const FromProcessor& shared = emulator_.from_processor();
  for (int k = 0; k < kTries; ++k) {
    const std::uint32_t before = load(shared.sequence);
    if ((before & 1U) != 0) continue;
    FromProcessor copy = shared;
    std::atomic_thread_fence(std::memory_order_acquire);
    if (load(shared.sequence) != before) continue;
    if (copy.boots > answer_.boots && answer_.boots != 0) ++figures_.resets;
    answer_ = copy;
    figures_.stack_bytes = std::max(figures_.stack_bytes, copy.stack_bytes);
    figures_.passes = copy.passes;
    figures_.uart_received = copy.uart_received;
    figures_.uart_sent = copy.uart_sent;
    figures_.uart_lost = copy.uart_overruns + copy.uart_frames_dropped;
    return;
  }
}

}  // namespace rosflight::flight
