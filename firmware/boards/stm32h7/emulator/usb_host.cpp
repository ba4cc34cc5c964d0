// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/usb_host.hpp"

#include <algorithm>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr Ticks kMillisecond = 1000 * kTicksPerMicrosecond;
constexpr Ticks kSettle = 100 * kMillisecond, kBusReset = 10 * kMillisecond;  // USB 2.0, 7.1.7
constexpr Ticks kSilence = 3 * kMillisecond, kTimeout = 500 * kMillisecond;
constexpr std::size_t kPacket = 64, kData = 2;
constexpr std::uint8_t kToHost = 0x80;
constexpr std::uint16_t kAddress = 5;
constexpr std::uint8_t kGetDescriptor = 6, kSetAddress = 5;

}  // namespace

const std::vector<UsbHost::Request>& UsbHost::script() {
  static const std::vector<Request> all{
      {kToHost, kGetDescriptor, 0x0100, 0, 64, {}},  // the device, before it has an address
      {0, kSetAddress, kAddress, 0, 0, {}},
      {kToHost, kGetDescriptor, 0x0100, 0, 18, {}},
      {kToHost, kGetDescriptor, 0x0200, 0, 9, {}},    // how long the configuration is
      {kToHost, kGetDescriptor, 0x0200, 0, 255, {}},  // all of it
      {kToHost, kGetDescriptor, 0x0300, 0, 255, {}},
      {kToHost, kGetDescriptor, 0x0302, 0x0409, 255, {}},
      {0, 9, 1, 0, 0, {}},                                       // set configuration
      {0x21, 0x20, 0, 0, 7, {0x00, 0x10, 0x0E, 0x00, 0, 0, 8}},  // line coding
      {0xA1, 0x21, 0, 0, 7, {}},
      {0x21, 0x22, 3, 0, 0, {}},  // the port is opened
  };
  return all;
}

void UsbHost::enter(Stage stage, Ticks delay) {
  stage_ = stage;
  since_ = core_.now();
  core_.set_due(*this, delay == kNever ? kNever : core_.now() + delay);
}

void UsbHost::plug(bool in) {
  if (in == (stage_ != Stage::kUnplugged)) return;
  to_device_.clear();
  if (in) return enter(Stage::kWaiting, kTransaction);
  enter(Stage::kUnplugged, device_.attached() ? kSilence : kNever);
}

void UsbHost::event(Ticks now) {
  if (stage_ == Stage::kUnplugged) return device_.suspend();
  if (!device_.attached()) {
    to_device_.clear();
    return enter(Stage::kWaiting, kMillisecond);
  }
  switch (stage_) {
    case Stage::kUnplugged:
      break;
    case Stage::kWaiting:
      return enter(Stage::kSettling, kSettle);
    case Stage::kSettling:
      device_.reset_bus();
      return enter(Stage::kReset, kBusReset);
    case Stage::kReset:
      device_.enumerated();
      next_ = 0;
      phase_ = Phase::kSetup;
      ++enumerations_;
      return enter(Stage::kControl, kMillisecond);
    case Stage::kControl:
      step_control();
      break;
    case Stage::kRunning:
      step_data();
      break;
  }
  core_.set_due(*this, now + kTransaction);
}

// ---- control transfers

void UsbHost::step_control() {
  const Request& request = script()[next_];
  if (phase_ == Phase::kSetup) {
    const auto low = [](std::uint16_t value) { return static_cast<std::uint8_t>(value & 0xFFU); };
    const auto high = [](std::uint16_t value) { return static_cast<std::uint8_t>(value >> 8U); };
    device_.send_setup({request.type, request.request, low(request.value), high(request.value),
                        low(request.index), high(request.index), low(request.length),
                        high(request.length)});
    answer_.clear();
    since_ = core_.now();
    phase_ = request.length > 0 ? Phase::kData : Phase::kStatus;
  } else if (phase_done()) {
    if (phase_ == Phase::kData) {
      phase_ = Phase::kStatus;
    } else {
      finish_request();
    }
  } else if (core_.now() - since_ > kTimeout) {
    core_.complain("USB host: no answer to request " + std::to_string(next_));
    enter(Stage::kUnplugged, kNever);
  }
}

/// One transaction of the phase. @returns whether it ended the phase.
bool UsbHost::phase_done() {
  const Request& request = script()[next_];
  const bool from_device = (request.type & kToHost) != 0;
  const bool data = phase_ == Phase::kData;
  UsbModel::Packet packet;
  UsbModel::Result result{};
  if (data != from_device) {
    if (data) packet = request.out;
    result = device_.send(0, packet);
  } else {
    result = device_.receive(0, packet);
  }
  if (result == UsbModel::Result::kStall) {
    core_.complain("USB host: request " + std::to_string(next_) + " was stalled");
    enter(Stage::kUnplugged, kNever);
  }
  if (result != UsbModel::Result::kDone) return false;
  if (!data || !from_device) {
    if (!data && !packet.empty()) core_.complain("USB host: a status packet with bytes");
    return true;
  }
  answer_.insert(answer_.end(), packet.begin(), packet.end());
  return packet.size() < kPacket || answer_.size() >= request.length;
}

void UsbHost::finish_request() {
  check_answer(script()[next_]);
  phase_ = Phase::kSetup;
  if (++next_ == script().size()) enter(Stage::kRunning, kTransaction);
}

void UsbHost::check_answer(const Request& request) {
  constexpr std::size_t kDeviceBytes = 18;
  if (request.request == kSetAddress && device_.address() != kAddress)
    core_.complain("USB host: the device has not taken its address");
  if (request.request != kGetDescriptor || request.type != kToHost) return;
  const auto said = [this](std::size_t at) { return at < answer_.size() ? answer_[at] : 0U; };
  if (said(1) != request.value >> 8U) core_.complain("USB host: a descriptor of another kind");
  if (request.value == 0x0100 && answer_.size() != kDeviceBytes)
    core_.complain("USB host: a device descriptor of wrong length");
  const bool whole = request.value == 0x0200 && request.length == 255;
  if (whole && answer_.size() != (said(2) | said(3) << 8U))
    core_.complain("USB host: a configuration of wrong length");
}

// ---- bulk transfers

void UsbHost::step_data() {
  UsbModel::Packet packet;
  if (device_.receive(kData, packet) == UsbModel::Result::kDone && on_data) on_data(packet);
  if (to_device_.empty()) return;
  const std::size_t count = std::min(to_device_.size(), kPacket);
  packet.assign(to_device_.begin(), to_device_.begin() + static_cast<std::ptrdiff_t>(count));
  if (device_.send(kData, packet) == UsbModel::Result::kDone) {
    to_device_.erase(to_device_.begin(), to_device_.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

}  // namespace rosflight::boards::stm32h7::emulator
